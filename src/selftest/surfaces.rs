//! Rays that leave surfaces: no self-intersection and no escape.

use super::fixtures::{DIRECT, first_hits, integrator, lamp, radiance_along, ray_in, white_scene};
use super::shapes::Polyhedron;
use crate::geometry::{Hit, Sphere, Transform};
use crate::material::{FeatureMask, Material};
use crate::math::{NO_PRIMITIVE, Ray, to_world};
use crate::sampling::{Random, cosine_hemisphere};
use crate::scene::{Scene, SceneBuilder, SurfacePoint};
use crate::simd::Kernel;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A ray that leaves a point in a random, cosine-distributed direction. Unlike those of the integrators it does not
/// exclude the primitive that it leaves.
fn random_ray_from(point: &SurfacePoint, random: &mut Random) -> Ray {
    let local = cosine_hemisphere(random.unit(), random.unit());
    let ray = point.spawn_ray(to_world(point.geometric_normal, local));
    Ray {
        exclude: NO_PRIMITIVE,
        ..ray
    }
}

/// Random rays that leave the points that `rays` hit.
fn random_rays_from_hits(scene: &Scene, rays: &[Ray], random: &mut Random) -> Vec<Ray> {
    let hits = first_hits(scene, rays);
    let found = rays
        .iter()
        .zip(hits)
        .filter_map(|(ray, hit)| Some((ray, hit?)));
    found
        .map(|(ray, hit)| {
            random_ray_from(&scene.surface::<FeatureMask<0>>(ray, &hit).point, random)
        })
        .collect()
}

/// The sum of `count` over 1000 parts, each with random numbers of its own.
fn in_parts(count: impl Fn(&mut Random) -> usize + Sync) -> usize {
    (0..1000)
        .into_par_iter()
        .map(|part| count(&mut Random::new(part)))
        .sum()
}

/// Rays of each part, so that all parts have a million.
const PART: usize = 1000;

/// Quads of two triangles with exact vertices, hit from all sides: a ray that leaves one triangle hits neither it nor
/// its neighbour. The quad 1e5 m away has a copy on the other side of the origin, which keeps its coordinates large.
/// The largest one is seen from 5 m, as the ground is.
pub(super) fn leaving_triangles(kernel: Kernel) -> f64 {
    let (right, up) = (DVec3::new(1.0, 0.25, 0.5), DVec3::new(-0.5, 0.75, 0.25));
    let mut again = 0;
    for (size, shift, distance) in [
        (1.0, 0.0, 5.0),
        (1.0, 1e5, 5.0),
        (128.0, 0.0, 1e4),
        (8192.0, 0.0, 1e5),
        (1_048_576.0, 0.0, 5.0),
    ] {
        let middle = DVec3::splat(shift);
        let quad = Polyhedron::quad(middle - 0.5 * size * (right + up), size * right, size * up);
        let copy = quad.moved(|p| -p);
        let meshes = if shift > 0.0 {
            vec![&quad, &copy]
        } else {
            vec![&quad]
        };
        let scene = white_scene(&meshes, kernel);
        again += in_parts(|random| {
            let rays = (0..PART).map(|_| {
                let (u, v) = (random.unit(), random.unit());
                let target = quad.vertices[0] + size * (f64::from(u) * right + f64::from(v) * up);
                let offset = random.point();
                let eye = target + distance * offset.normalize_or(DVec3::Y);
                ray_in(&scene, eye, target - eye)
            });
            let rays: Vec<Ray> = rays.collect();
            let spawned = random_rays_from_hits(&scene, &rays, random);
            let hits = first_hits(&scene, &spawned);
            let is_far = |hit: &Option<Hit>| hit.is_none_or(|hit| hit.t > 1e4 * size);
            // Rays at the rim may miss, but no more than one in twenty.
            let missed = PART - spawned.len();
            hits.iter().filter(|hit| !is_far(hit)).count()
                + if missed > PART / 20 { missed } else { 0 }
        });
    }
    again as f64
}

/// From outside a ray must escape; from inside it hits the other side, at 2 r cos of its angle to the normal.
pub(super) fn leaving_spheres(kernel: Kernel) -> f64 {
    let mut again = 0;
    for radius in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for center in [0.0, 0.7 * radius, 1e3 * radius] {
            let sphere = Sphere::new(DVec3::splat(center), radius);
            // Two more, so that the scene's origin is not the sphere's centre.
            let other = |center: DVec3| Sphere::new(center, radius);
            let far = DVec3::splat(center + 4.0 * radius);
            let builder = SceneBuilder {
                materials: vec![Material::lambert(Vec3::ONE)],
                spheres: [sphere, other(-far), other(-far - 4.0 * radius)]
                    .map(|sphere| (sphere, 0))
                    .to_vec(),
                kernel,
                ..SceneBuilder::default()
            };
            let (scene, _) = builder.build();
            let mut random = Random::new(7);
            for distance in [0.5, 1.5, 3.0, 100.0] {
                let rays = (0..3000).map(|_| {
                    let eye = radius * distance * random.point().normalize_or(DVec3::X);
                    let target = radius * random.point();
                    ray_in(&scene, sphere.center + eye, target - eye)
                });
                let rays: Vec<Ray> = rays.collect();
                let hits = first_hits(&scene, &rays);
                // At least a third of the targets are in the sphere.
                let hits_of_sphere = hits.iter().flatten().filter(|hit| hit.primitive == 0);
                again += usize::from(hits_of_sphere.count() < 1000);
                for (ray, hit) in rays.iter().zip(hits) {
                    let Some(hit) = hit.filter(|hit| hit.primitive == 0) else {
                        continue;
                    };
                    let point = scene.surface::<FeatureMask<0>>(ray, &hit).point;
                    let spawned = random_ray_from(&point, &mut random);
                    let cos = f64::from(spawned.direction.dot(point.geometric_normal));
                    let is_inside = distance < 1.0;
                    let least = if is_inside { cos } else { 2.0 } * radius;
                    let is_right = match first_hits(&scene, &[spawned])[0] {
                        Some(next) => next.primitive != 0 || next.t >= least,
                        None => !is_inside,
                    };
                    again += usize::from(!is_right);
                }
            }
        }
    }
    again as f64
}

/// A box of 1 m, 1e5 m from the origin, axis-aligned or rotated; and one that has a copy on the other side of the
/// origin, so that an ulp is 8 mm: rays from the middle to points 1e-4 m from edges and corners, and on from
/// there by four bounces.
pub(super) fn closed_corner(kernel: Kernel) -> f64 {
    let cuboid = Polyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5));
    let mut escapes = 0;
    for (angle, shift, has_copy) in [(0.0, 1e5, false), (0.7, 1e5, false), (0.0, 1e5, true)] {
        let place = Transform::new(DVec3::ONE, DVec3::splat(angle), DVec3::splat(shift));
        let placed = cuboid.moved(|p| place.point(p));
        let copy = placed.moved(|p| -p);
        let meshes = if has_copy {
            vec![&placed, &copy]
        } else {
            vec![&placed]
        };
        let scene = white_scene(&meshes, kernel);
        escapes += in_parts(|random| {
            let rays = (0..PART / 4).map(|i| {
                let eye = place.point(0.2 * random.point());
                // On one face of the box, close to one or two others.
                let mut target = 0.5 * random.point();
                for axis in 0..1 + i % 2 {
                    target[axis] = (0.5_f64 - 1e-4).copysign(random.point().x);
                }
                target[2] = 0.5_f64.copysign(random.point().x);
                ray_in(&scene, eye, place.point(target) - eye)
            });
            let mut rays: Vec<Ray> = rays.collect();
            let ray_count = rays.len();
            for _bounce in 0..4 {
                rays = random_rays_from_hits(&scene, &rays, random);
            }
            ray_count - first_hits(&scene, &rays).iter().flatten().count()
        });
    }
    escapes as f64
}

/// A wall 1e-6 m thick, 1e3 m from the scene's middle, where an ulp is 6e-5 m: both sides have the same
/// coordinates. A lamp in front lights all points that are seen from the front, and none that are seen from behind.
pub(super) fn thin_wall(kernel: Kernel) -> f64 {
    let right = DVec3::new(0.0, 4.0, 0.0);
    let up = DVec3::new(0.0, 0.0, 4.0);
    let side = |x: f64| Polyhedron::quad(DVec3::new(x, -2.0, -2.0), right, up);
    let (front, back) = (side(1000.3), side(1000.3 - 1e-6));
    let copy = front.moved(|p| -p);
    let builder = SceneBuilder {
        materials: vec![Material::lambert(Vec3::ONE)],
        meshes: [&front, &back, &copy, &copy]
            .map(|mesh| mesh.mesh(0))
            .to_vec(),
        lights: vec![lamp(DVec3::new(1001.0, 0.0, 0.0), 1.0)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let mut random = Random::new(8);
    let mut wrong = 0;
    for i in 0..10_000 {
        let is_in_front = i % 2 == 0;
        let eye = DVec3::new(if is_in_front { 1002.0 } else { 998.0 }, 0.0, 0.0);
        let target = DVec3::new(1000.3, 1.9 * random.point().y, 1.9 * random.point().z);
        let light = radiance_along(&integrator(&scene, &DIRECT), eye, target - eye).x;
        wrong += usize::from((light > 0.0) != is_in_front);
    }
    wrong as f64
}
