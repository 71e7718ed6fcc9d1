//! Random hostile scenes: the tree, every kernel and packets find exactly what testing every primitive
//! finds.
#![allow(clippy::print_stdout, reason = "the seed of a failure is shown")]

use super::tests::{check_packets, sphere};
use super::*;
use crate::selftest::Random;

/// For as many seconds as FUZZ_SECONDS says. Run with `--ignored`.
#[test]
#[ignore = "runs for a given time"]
fn fuzz() {
    let seconds: u64 = std::env::var("FUZZ_SECONDS").map_or(10, |s| s.parse().expect("a number"));
    let start = std::time::Instant::now();
    let first = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |t| t.as_secs());
    let mut cases = 0;
    while start.elapsed().as_secs() < seconds {
        let seed = std::env::var("FUZZ_SEED")
            .map_or(first * 1_000_003 + cases, |s| s.parse().expect("a number"));
        // Shown if it fails: set the variable to this number to see it fail again.
        println!("FUZZ_SEED={seed}");
        check_scene(&mut Random(seed));
        cases += 1;
    }
    println!("{cases} scenes");
}

#[test]
fn a_few_hostile_scenes() {
    for seed in 0..300 {
        check_scene(&mut Random(seed * 7919));
    }
}

/// A scene of one kind of hostile shapes, at some scale and place, and rays that are aimed at what is
/// hardest: corners, edges, along axes, from on the shapes.
fn check_scene(random: &mut Random) {
    let pick = |random: &mut Random, count: usize| (random.unit() * count as f32) as usize;
    let scale = 10_f32.powi(pick(random, 13) as i32 - 6);
    let shift = random.vector(1.0) * scale * [0.0, 1.0, 1e3, 1e5][pick(random, 4)];
    let (triangle_count, sphere_count) = (pick(random, 200), pick(random, 3) * pick(random, 20));
    let kind = pick(random, 5);
    let snap = |v: Vec3, steps: f32| (v * steps).round() / steps;
    let triangles: Vec<[Vec3; 3]> = (0..triangle_count)
        .map(|i| {
            let at = random.vector(1.0);
            let (a, b) = (random.vector(0.3), random.vector(0.3));
            let corners = match kind {
                // Soup; on a grid, flat; needles; fans around few points; many at one place.
                0 => [at, at + a, at + b],
                1 => {
                    let mut corners = [at, at + a, at + b].map(|p| snap(p, 8.0));
                    for corner in &mut corners {
                        corner[i % 3] = snap(at, 2.0)[i % 3];
                    }
                    corners
                }
                2 => [at, at + a, at + a * 0.5 + b * 1e-7],
                3 => [
                    snap(at, 1.0),
                    snap(at, 1.0) + snap(a, 16.0),
                    snap(at, 1.0) + snap(b, 16.0),
                ],
                _ => [Vec3::ZERO, Vec3::X, Vec3::Y],
            };
            corners.map(|p| p * scale + shift)
        })
        .collect();
    let spheres: Vec<Sphere> = (0..sphere_count)
        .map(|_| {
            let radius = f64::from(scale * (0.001 + 0.3 * random.unit()));
            sphere(random.vector(1.0) * scale + shift, radius)
        })
        .collect();
    let rays: Vec<Ray> = (0..160)
        .map(|i| {
            let size = [0.5, 1.0, 3.0, 100.0][pick(random, 4)];
            let mut origin = random.vector(size);
            let mut direction = random.vector(1.0);
            if let Some(corners) = triangles.get(i) {
                let corner = (corners[i % 3] - shift) / scale;
                match pick(random, 4) {
                    0 => direction = corner - origin,
                    1 => origin = corner,
                    2 => direction = corner.lerp((corners[0] - shift) / scale, 0.5) - origin,
                    _ => {}
                }
            }
            match pick(random, 4) {
                0 => direction[i % 3] = [0.0, -0.0, 1e-38, 1e-45][pick(random, 4)],
                1 => {
                    direction[i % 3] = 0.0;
                    direction[(i + 1) % 3] = -0.0;
                }
                _ => {}
            }
            if direction == Vec3::ZERO {
                direction = Vec3::X;
            }
            Ray::new(origin * scale + shift, direction)
        })
        .collect();
    let mut traversal = Traversal::default();
    let mut brute = Bvh::new(&triangles, spheres.clone(), Kernel::PORTABLE);
    assert_eq!(brute.validate(), Ok(()));
    brute.nodes.clear();
    check_packets(&brute, &rays);
    let expected: Vec<Option<Hit>> = rays
        .iter()
        .map(|ray| brute.closest(ray, &mut traversal))
        .collect();
    for kernel in Kernel::available() {
        let bvh = Bvh::new(&triangles, spheres.clone(), kernel);
        check_packets(&bvh, &rays);
        for (ray, expected) in rays.iter().zip(&expected) {
            assert_eq!(bvh.closest(ray, &mut traversal), *expected, "{ray:?}");
        }
    }
}
