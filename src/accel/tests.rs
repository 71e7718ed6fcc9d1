//! Against brute force in double precision, one by one and together, for every kernel.

use super::brute_force::disagreement;
use super::bvh::Bvh;
use super::fuzz::check_packets;
use super::node::Child;
use super::query_state::QueryState;
use super::ray_packet::RayPacket;
use super::validate::BvhError;
use crate::geometry::Sphere;
use crate::math::{Aabb, Ray};
use crate::sampling::Random;
use crate::simd::Kernel;
use crate::simd::PACKET_WIDTH;
use glam::DVec3;
use glam::Vec3;

fn check(triangles: &[[Vec3; 3]], spheres: &[Sphere], rays: &[Ray]) {
    for kernel in Kernel::available() {
        let mut bvh = Bvh::new(triangles, spheres.to_vec(), kernel);
        assert_eq!(bvh.validate(), Ok(()));
        let mut query_state = QueryState::default();
        check_packets(&bvh, rays);
        bvh.exceeds_caches = true;
        check_packets(&bvh, rays);
        for ray in rays {
            let hit = bvh.closest(ray, &mut query_state);
            assert_eq!(disagreement(triangles, spheres, ray, hit), None);
            // A shadow ray sees exactly what the nearest-hit query sees.
            for share in [0.5, 1.0, 2.0] {
                let t_max = hit.map_or(1e30, |h| h.t as f32) * share;
                let shadow = Ray { t_max, ..*ray };
                let expected = hit.is_some_and(|h| h.t < f64::from(t_max));
                assert_eq!(bvh.occluded(&shadow, &mut query_state), expected, "{ray:?}");
            }
        }
    }
}

fn random_rays(random: &mut Random, count: usize, size: f32) -> Vec<Ray> {
    (0..count)
        .map(|_| Ray::new(random.vector(size), random.vector(1.0)))
        .collect()
}

#[test]
fn random_triangles_and_spheres() {
    let mut random = Random::new(1);
    for (triangle_count, sphere_count) in [(1, 0), (0, 1), (7, 2), (9, 0), (100, 20), (3000, 300)] {
        let triangles: Vec<_> = (0..triangle_count)
            .map(|_| random.triangle(10.0, 2.0))
            .collect();
        let spheres: Vec<_> = (0..sphere_count)
            .map(|_| {
                Sphere::new(
                    random.vector(10.0).as_dvec3(),
                    f64::from(random.unit()) + 0.01,
                )
            })
            .collect();
        let rays = random_rays(&mut random, 1000, 12.0);
        check(&triangles, &spheres, &rays);
    }
}

#[test]
fn nothing_is_hit_in_an_empty_scene() {
    check(&[], &[], &random_rays(&mut Random::new(2), 10, 1.0));
    assert_eq!(
        Bvh::new(&[], vec![], Kernel::default()).bounds(),
        Aabb::EMPTY
    );
}

#[test]
fn validation_finds_faults() {
    let mut random = Random::new(6);
    let triangles: Vec<_> = (0..200).map(|_| random.triangle(10.0, 1.0)).collect();
    let sound = || Bvh::new(&triangles, vec![], Kernel::default());
    assert_eq!(sound().validate(), Ok(()));

    let mut small = sound();
    small.nodes[0].planes[0][0] = small.nodes[0].planes[0][0].map(|x| x + 0.01);
    let fault = small.validate();
    assert!(
        matches!(fault, Err(BvhError::Outside { node: 0, .. })),
        "{fault:?}"
    );

    let mut lost = sound();
    for [lower, upper] in &mut lost.nodes[0].planes {
        (lower[1], upper[1]) = (f32::INFINITY, f32::NEG_INFINITY);
    }
    let fault = lost.validate();
    assert!(
        matches!(fault, Err(BvhError::Primitive { leaves: 0, .. })),
        "{fault:?}"
    );

    let mut dangling = sound();
    dangling.nodes[0].children[0] = Child::Triangles(1 << 20).pack();
    let expected = BvhError::Dangling { node: 0, lane: 0 };
    assert_eq!(dangling.validate(), Err(expected));

    let mut endless = sound();
    let last = endless.nodes.len() - 1;
    endless.nodes[last].children = [Child::Node(last as u32).pack(); 8];
    let fault = endless.validate();
    assert!(matches!(fault, Err(BvhError::TooDeep { .. })), "{fault:?}");
}

/// Their hits mean nothing, but traversal must end.
#[test]
fn traversal_of_nan_rays_ends() {
    let mut random = Random::new(7);
    let triangles: Vec<_> = (0..300).map(|_| random.triangle(1.0, 0.3)).collect();
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    let numbers = [0.0, 1.0, 1e-45, 3e38, nan, infinity];
    let spheres = vec![Sphere::new(DVec3::ONE, 1.0); 9];
    for kernel in Kernel::available() {
        for (triangles, spheres) in [(&triangles[..], vec![]), (&[], spheres.clone())] {
            let bvh = Bvh::new(triangles, spheres, kernel);
            let mut query_state = QueryState::default();
            for i in 0..216 {
                let direction = Vec3::new(numbers[i % 6], numbers[i / 6 % 6], numbers[i / 36]);
                for origin in [Vec3::ZERO, Vec3::splat(nan), Vec3::splat(infinity)] {
                    let ray = Ray::new(origin, direction);
                    let hit = bvh.closest(&ray, &mut query_state);
                    assert!(hit.is_none_or(|hit| hit.t > 0.0));
                    bvh.occluded(&ray, &mut query_state);
                    bvh.closest_coherent(
                        &[ray; PACKET_WIDTH],
                        &mut [None; PACKET_WIDTH],
                        &mut query_state,
                    );
                }
            }
        }
    }
}

/// All queries of sixteen rays find what each finds among all triangles.
fn check_all_queries(triangles: &[[Vec3; 3]], rays: &[Ray; PACKET_WIDTH]) {
    for kernel in Kernel::available() {
        let mut query_state = QueryState::default();
        let bvh = Bvh::new(triangles, vec![], kernel);
        let mut brute = Bvh::new(triangles, vec![], Kernel::PORTABLE);
        brute.nodes.clear();
        let expected = rays.map(|ray| brute.closest(&ray, &mut query_state));
        let (mut coherent, mut incoherent) = ([None; PACKET_WIDTH], [None; PACKET_WIDTH]);
        bvh.closest_coherent(rays, &mut coherent, &mut query_state);
        bvh.closest_incoherent(rays, &mut incoherent, &mut query_state);
        let single = rays.map(|ray| bvh.closest(&ray, &mut query_state));
        assert_eq!([coherent, incoherent, single], [expected; 3], "{kernel}");

        let packet = RayPacket::new(rays);
        let coherent = bvh.occluded_coherent(&packet, &mut query_state);
        let incoherent = bvh.occluded_incoherent([&packet].into_iter(), &mut query_state);
        for (lane, ray) in rays.iter().enumerate() {
            let expected = brute.occluded(ray, &mut query_state);
            let found = [coherent, incoherent[0]].map(|mask| mask >> lane & 1 != 0);
            assert_eq!(found, [expected; 2], "{ray:?} {kernel}");
        }
    }
}

/// Triangles across the x axis, around (x, y, 0) for each x.
fn row(y: f32, size: f32, x: impl Fn(f32) -> f32) -> Vec<[Vec3; 3]> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
    let at = |x: f32| corners.map(|[v, w]| Vec3::new(x, y + size * v, size * w));
    (0..30).map(|i| at(x(i as f32))).collect()
}

/// Where products overflow, nothing is culled.
#[test]
fn rays_at_the_ends_of_the_range_of_floats() {
    let along = |y: f32, size: f32| Ray::new(Vec3::new(0.0, y, 0.0), Vec3::X * size);
    // The origin's part of a slab is infinite.
    check_all_queries(
        &row(4e20, 1e16, |i| 1e15 * (i + 1.0)),
        &[along(4e20, 1.0); 16],
    );
    check_all_queries(&row(1e3, 1.0, |i| i + 1.0), &[along(1e3, 1e-18); 16]);
    // The reciprocal is.
    let steep = Ray::new(Vec3::new(1e-4, 0.0, 0.0), Vec3::new(-2e-40, 1e-37, 0.0));
    check_all_queries(&row(0.0, 1.0, |i| -1e-9 * i), &[steep; 16]);
    let far = Ray::new(Vec3::new(1.5, 0.0, 0.0), Vec3::new(1e-38, 0.0, 0.0));
    check_all_queries(&row(0.0, 1.0, |i| 3.5 + 0.01 * i), &[far; 16]);
}

/// A ray without a number for its end does not hide what the others meet.
#[test]
fn ends_that_are_no_number_concern_one_ray() {
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    for t_max in [f32::NAN, -1.0, -0.0, 0.0] {
        for lane in 0..PACKET_WIDTH {
            let mut rays = [ray; PACKET_WIDTH];
            rays[lane].t_max = t_max;
            check_all_queries(&row(0.0, 1.0, |i| i + 1.0), &rays);
        }
    }
}

#[test]
fn directions_with_nan_find_a_packet() {
    let triangles = &row(0.0, 1.0, |i| i + 1.0)[..3];
    let bvh = Bvh::new(triangles, vec![], Kernel::default());
    let directions = [[1.0, 0.0, 0.0], [3.0, f32::NAN, 2.0], [f32::NAN, 1.0, 2.0]];
    let rays = directions.map(|d| Ray::new(Vec3::ZERO, Vec3::from_array(d)));
    let mut hits = [None; 3];
    bvh.closest_incoherent(&rays, &mut hits, &mut QueryState::default());
    assert!(hits[0].is_some());
}
