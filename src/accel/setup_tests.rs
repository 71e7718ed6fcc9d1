//! The setup of rays, and the margin of what it derives.

use super::bvh::Bvh;
use super::hit_filter::DISTANCE_PADDING;
use super::query_state::QueryState;
use super::ray_packet::RayPacket;
use super::ray_setup::{RaySetup, major_axis};
use super::watertight::ShearedRays;
use crate::math::Ray;
use crate::sampling::Random;
use crate::simd::{Floats, Kernel, PACKET_WIDTH, Scalar, Simd, WithSimd};
use glam::Vec3;

struct SetUp<'a>(&'a [Ray; PACKET_WIDTH]);

impl WithSimd for SetUp<'_> {
    type Output = RaySetup<PACKET_WIDTH>;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Self::Output {
        RayPacket::of::<S>(self.0).setup::<S>(7.0)
    }
}

/// All numbers of a ray, as bits.
fn bits<const N: usize>(setup: &RaySetup<N>, lane: usize) -> Vec<u32> {
    let threes = [
        setup.inverse,
        setup.near_offset,
        setup.far_offset,
        setup.origin,
    ];
    let [sx, sy] = setup.slopes;
    let others = [
        sx,
        sy,
        setup.inv_dz,
        setup.depth_error,
        setup.origin_magnitude,
    ];
    let numbers = threes
        .as_flattened()
        .iter()
        .chain(&others)
        .map(|n| n[lane].to_bits());
    let down = setup.down.map(|mask| mask >> lane & 1);
    let axes = setup.axes(lane).map(|axis| axis as u32);
    numbers.chain(down).chain(axes).collect()
}

#[test]
fn sixteen_rays_are_set_up_as_each_alone_on_every_kernel() {
    let mut random = Random::new(4);
    let special = [0.0, -0.0, 1e-30, -1e-45, 1.0, -1.0];
    for round in 0..500 {
        let rays: [Ray; PACKET_WIDTH] = std::array::from_fn(|i| {
            let mut ray = Ray::new(random.vector(10.0), random.vector(1.0));
            if i % 2 == 0 {
                ray.direction[i % 3] = special[(round + i) % 6];
                ray.direction[(i + 1) % 3] = special[round / 6 % 6];
            }
            ray
        });
        for kernel in Kernel::available() {
            let setup = kernel.run(SetUp(&rays));
            for (lane, ray) in rays.iter().enumerate() {
                let scalars = |v: Vec3| v.to_array().map(Scalar::splat);
                let (origin, direction) = (scalars(ray.origin), scalars(ray.direction));
                let alone = RaySetup::<1>::new(origin, direction, 7.0);
                assert_eq!(bits(&setup, lane), bits(&alone, 0), "{ray:?} {kernel}");
                assert_eq!(setup.axes(lane)[2], major_axis(ray.direction));
            }
        }
    }
}

/// Whether a triangle passes for a query whose best hit is at `t`, with a share of the error bound of depths.
fn passes(ray: &Ray, triangle: [Vec3; 3], t: f64, share: f32) -> bool {
    let scalars = |v: Vec3| v.to_array().map(Scalar::splat);
    let magnitude = triangle
        .map(|v| v.abs().max_element())
        .into_iter()
        .fold(0.0, f32::max);
    let setup = RaySetup::<1>::new(scalars(ray.origin), scalars(ray.direction), magnitude);
    let [kx, ky, kz] = setup.axes(0);
    let permuted = triangle.map(|v| scalars(Vec3::new(v[kx], v[ky], v[kz])));
    let [error] = setup.depth_error.map(|error| share * error);
    let mut rays = ShearedRays::<Scalar>::load(&setup);
    rays.behind = Scalar::splat(-error);
    let limit = t as f32 * DISTANCE_PADDING + error;
    rays.intersect(&permuted, Scalar::splat(limit)) != 0
}

/// The margin of the test of depths: hits are never culled, and those of steep triangles that rays pass by a hair
/// need most of what is derived.
#[test]
fn depths_are_culled_only_beyond_their_error_bound() {
    let mut random = Random::new(3);
    let mut query_state = QueryState::default();
    let (mut hits, mut largest_share) = (0, 0.0_f32);
    for _ in 0..200_000 {
        let size = 10_f32.powf(4.0 * random.unit());
        let origin = random.vector(size);
        let direction = random.vector(1.0);
        let ray = Ray::new(origin, direction);
        // Along the ray, off it by some units in the last place.
        let mut vertex = || {
            let along = ray.at((2.0 * random.unit()).into()).as_vec3();
            along + random.vector(4.0 * f32::EPSILON * size)
        };
        let triangle = [vertex(), vertex(), vertex()];
        let bvh = Bvh::new(&[triangle], vec![], Kernel::PORTABLE);
        let Some(hit) = bvh.closest(&ray, &mut query_state) else {
            continue;
        };
        hits += 1;
        assert!(passes(&ray, triangle, hit.t, 1.0), "{ray:?} {triangle:?}");
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..10 {
            let share = 0.5 * (low + high);
            if passes(&ray, triangle, hit.t, share) {
                high = share;
            } else {
                low = share;
            }
        }
        largest_share = largest_share.max(low);
    }
    assert!(hits > 10_000);
    // Derived: 9.5 of 16.
    assert!((0.4..0.6).contains(&largest_share), "{largest_share}");
}
