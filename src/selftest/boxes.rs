//! Hits of the BVH against brute force in double precision.

use crate::accel::{Bvh, QueryState, disagreement};
use crate::geometry::Sphere;
use crate::math::Ray;
use crate::sampling::Random;
use crate::simd::Kernel;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// The number of rays whose hit [`disagreement`] refutes by a test of every shape; one more if the BVH is invalid.
fn wrong_hits(triangles: &[[Vec3; 3]], spheres: &[Sphere], rays: &[Ray], kernel: Kernel) -> f64 {
    let bvh = Bvh::new(triangles, spheres.to_vec(), kernel);
    let wrong = rays.par_chunks(1000).map(|rays| {
        let mut hits = vec![None; rays.len()];
        bvh.closest_incoherent(rays, &mut hits, &mut QueryState::default());
        let differs =
            |(ray, hit): &(&Ray, Option<_>)| disagreement(triangles, spheres, ray, *hit).is_some();
        rays.iter().zip(hits).filter(differs).count()
    });
    (wrong.sum::<usize>() + usize::from(bvh.validate().is_err())) as f64
}

fn random_triangles(random: &mut Random, count: usize, spread: f32, size: f32) -> Vec<[Vec3; 3]> {
    (0..count).map(|_| random.triangle(spread, size)).collect()
}

fn random_rays(random: &mut Random, count: usize, size: f32) -> Vec<Ray> {
    let mut ray = || Ray::new(random.vector(size), random.vector(1.0));
    (0..count).map(|_| ray()).collect()
}

fn random_spheres(random: &mut Random, count: usize, spread: f32) -> Vec<Sphere> {
    let mut sphere = || {
        Sphere::new(
            random.vector(spread).as_dvec3(),
            f64::from(random.unit()) + 0.01,
        )
    };
    (0..count).map(|_| sphere()).collect()
}

/// [`wrong_hits`] of scenes with these counts of triangles, of up to 3 m, and spheres, spread over `spread`, by rays
/// from within `size`.
fn wrong_in_random_scenes(
    mut random: Random,
    counts: &[(usize, usize)],
    spread: f32,
    (ray_count, size): (usize, f32),
    kernel: Kernel,
) -> f64 {
    let scenes = counts.iter().map(|&(triangle_count, sphere_count)| {
        let triangles = random_triangles(&mut random, triangle_count, spread, 3.0);
        let spheres = random_spheres(&mut random, sphere_count, spread);
        let rays = random_rays(&mut random, ray_count, size);
        wrong_hits(&triangles, &spheres, &rays, kernel)
    });
    scenes.sum()
}

/// Two scenes of random triangles and spheres, a million rays each.
pub(super) fn brute_force(kernel: Kernel) -> f64 {
    let counts = [(100, 10), (40, 40)];
    wrong_in_random_scenes(Random::new(1), &counts, 10.0, (1_000_000, 12.0), kernel)
}

/// Three walls of 8 x 8 squares, whose bounding boxes have no thickness, and rays along the axes: from random points,
/// and from faces of boxes and edges and vertices of triangles.
pub(super) fn along_axes(kernel: Kernel) -> f64 {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for i in 0..64 {
            let at = |x: usize, y: usize| {
                let mut point = [0.0; 3];
                point[(axis + 1) % 3] = (i % 8 + x) as f32;
                point[(axis + 2) % 3] = (i / 8 + y) as f32;
                Vec3::from_array(point)
            };
            triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
            triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
        }
    }
    let mut random = Random::new(3);
    let mut rays = Vec::new();
    for axis in 0..3 {
        for small in [0.0, -0.0, 1e-38, -1e-38, 1e-45, -1e-45] {
            for sign in [1.0, -1.0] {
                let mut direction = Vec3::splat(small);
                direction[axis] = sign;
                for _ in 0..100 {
                    let origin = (random.vector(4.0) + 4.0).max(Vec3::splat(0.1));
                    let on_vertex = origin.round();
                    let on_face = Vec3::new(on_vertex.x, origin.y, origin.z);
                    let starts = [origin, on_vertex, on_face, on_vertex + 0.5 * Vec3::Y];
                    rays.extend(starts.map(|start| Ray::new(start, direction)));
                }
            }
        }
    }
    wrong_hits(&triangles, &[], &rays, kernel)
}

/// Scenes of no shape, or of so few that the BVH has hardly a node.
pub(super) fn small_scenes(kernel: Kernel) -> f64 {
    let counts = [
        (0, 0),
        (1, 0),
        (0, 1),
        (2, 0),
        (2, 2),
        (9, 0),
        (17, 1),
        (0, 3),
    ];
    wrong_in_random_scenes(Random::new(2), &counts, 3.0, (20_000, 5.0), kernel)
}

/// Triangles that no plane separates, and triangles of very different sizes.
pub(super) fn deep_trees(kernel: Kernel) -> f64 {
    let mut random = Random::new(4);
    let around_one_point: Vec<_> = (0..100_000)
        .map(|i| {
            let (a, b) = (random.vector(1.0), random.vector(1.0));
            let size = 1.0 + i as f32 * 1e-4;
            [a * size, b * size, -(a + b) * size]
        })
        .collect();
    let mut mixed = vec![[
        Vec3::new(-1e6, 0.0, -1e6),
        Vec3::new(1e6, 0.0, -1e6),
        Vec3::new(0.0, 0.0, 1e6),
    ]];
    mixed.extend(random_triangles(&mut random, 20_000, 1.0, 0.01));
    let rays = random_rays(&mut random, 300, 2.0);
    wrong_hits(&around_one_point, &[], &rays, kernel) + wrong_hits(&mixed, &[], &rays, kernel)
}

/// Ten thousand triangles of a millimetre on a ground of 1e6 m: error bounds grow with the coordinates of what a ray
/// hits, not with those of the ground.
pub(super) fn on_huge_ground(kernel: Kernel) -> f64 {
    let mut random = Random::new(5);
    let mut triangles = random_triangles(&mut random, 10_000, 0.1, 0.001);
    triangles.push([
        Vec3::new(-1e6, -0.1, -1e6),
        Vec3::new(1e6, -0.1, -1e6),
        Vec3::new(0.0, -0.1, 1e6),
    ]);
    let globe = Sphere::new(DVec3::new(0.0, -1e6 - 0.2, 0.0), 1e6);
    let rays = random_rays(&mut random, 10_000, 0.2);
    wrong_hits(&triangles, &[globe], &rays, kernel)
}
