//! What scenes of a thousand to ten million triangles cost: `cargo bench --bench growth`.
//!
//! The scene is a bumpy ball inside a larger one, finer and finer; rays start between them in
//! random directions, so each meets something. Rates are of one thread, the best of three runs; the
//! tree is built on all threads.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints or fails"
)]

use flythrough::accel::{Bvh, QueryState};
use flythrough::math::Ray;
use flythrough::sampling::SobolSequence;
use flythrough::simd::Kernel;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::time::Instant;

fn main() {
    println!("| triangles | build, s | bytes each | ns per ray | per doubling, ns |");
    println!("|---|---|---|---|---|");
    let rays: Vec<Ray> = (0..200_000).map(ray).collect();
    let mut before: Option<(f64, f64)> = None;
    for exponent in 3..=7 {
        let triangles = scene(10_usize.pow(exponent));
        let start = Instant::now();
        let bvh = Bvh::new(&triangles, vec![], Kernel::default());
        let build = start.elapsed().as_secs_f64();
        let mut query_state = QueryState::default();
        let mut hits = vec![None; rays.len()];
        let seconds = (0..3).fold(f64::INFINITY, |least, _| {
            let start = Instant::now();
            bvh.closest_incoherent(&rays, &mut hits, &mut query_state);
            let seconds = start.elapsed().as_secs_f64();
            assert!(hits.iter().all(Option::is_some));
            least.min(seconds)
        });
        let (doublings, time) = (
            (triangles.len() as f64).log2(),
            1e9 * seconds / rays.len() as f64,
        );
        let growth = before.map_or(String::new(), |(d, t)| {
            format!("{:.1}", (time - t) / (doublings - d))
        });
        before = Some((doublings, time));
        println!(
            "| {} | {build:.3} | {:.0} | {time:.0} | {growth} |",
            triangles.len(),
            bvh.memory() as f64 / triangles.len() as f64,
        );
    }
}

/// Two closed surfaces of about `count` triangles in all.
fn scene(count: usize) -> Vec<[Vec3; 3]> {
    let rows = ((count / 4) as f32 / 2.0).sqrt() as usize;
    let mut triangles = Vec::with_capacity(count);
    for radius in [1.0, 3.0] {
        let point = |row: usize, column: usize| {
            let (theta, phi) = (
                PI * row as f32 / rows as f32,
                TAU * (column % (2 * rows)) as f32 / (2 * rows) as f32,
            );
            let (sin, cos) = theta.sin_cos();
            let bumps = 1.0 + 0.1 * (20.0 * theta).sin() * (20.0 * phi).sin() * sin;
            radius * bumps * Vec3::new(sin * phi.cos(), cos, sin * phi.sin())
        };
        for row in 0..rows {
            for column in 0..2 * rows {
                let (a, b) = (point(row, column), point(row, column + 1));
                let (c, d) = (point(row + 1, column), point(row + 1, column + 1));
                triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
    }
    triangles
}

/// From between the surfaces.
fn ray(index: u32) -> Ray {
    let sequence = SobolSequence::new(1, 0, 0, 0);
    let direction = |pair: u32| {
        let [u, v] = sequence.sample_2d(index, pair);
        let (z, phi) = (2.0 * u - 1.0, TAU * v);
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * phi.cos(), z, r * phi.sin())
    };
    Ray::new(1.8 * direction(0), direction(1))
}
