//! Accumulates the samples of a frame's points, pass by pass.

use super::grid::Grid;
use super::observer::RenderObserver;
use super::sampler::{Sampler, Work};
use glam::Vec3;
use rayon::prelude::*;

/// The points of a tile that were sampled, and their means, half buffer by half buffer.
struct RefinedTile {
    points: Vec<(u32, u32)>,
    means: Vec<Vec3>,
    rays: u64,
    non_finite: u64,
}

/// The mean of the samples of each point of a frame so far.
pub(super) struct SampleAccumulator {
    /// The mean of each point, half buffer by half buffer.
    pub(super) values: Vec<Vec3>,
    /// How many passes each point has.
    pub(super) passes: Vec<u32>,
    pub(super) rays: u64,
    pub(super) non_finite: u64,
}

impl SampleAccumulator {
    pub(super) fn new(grid: Grid, sampler: &Sampler) -> SampleAccumulator {
        SampleAccumulator {
            values: vec![Vec3::ZERO; grid.len() * sampler.half_buffers],
            passes: vec![0; grid.len()],
            rays: 0,
            non_finite: 0,
        }
    }

    /// Samples each point until it has `wanted` passes, given by its index; tile by tile in parallel. Once the observer
    /// stops, further tiles are not sampled.
    pub(super) fn refine(
        &mut self,
        grid: Grid,
        sampler: &Sampler,
        wanted: impl Fn(usize) -> u32 + Sync,
        observer: &dyn RenderObserver,
    ) {
        let points = grid.points_per_tile_row();
        let values = self.values.par_chunks_mut(points * sampler.half_buffers);
        let rows = values.zip(self.passes.par_chunks_mut(points)).enumerate();
        // Means are added row by row of tiles, while they are in the processor's cache.
        let counts = rows.map(|(row, (values, passes))| {
            let tiles = grid.tiles_of_row(row).into_par_iter().map(|tile| {
                let of_point = |point| {
                    let index = grid.index(point);
                    (passes[index - row * points], wanted(index))
                };
                refined_tile(grid.tile_points(tile), sampler, of_point, observer)
            });
            let tiles: Vec<RefinedTile> = tiles.collect();
            for tile in &tiles {
                let means = tile.means.chunks_exact(sampler.half_buffers);
                for (&point, means) in tile.points.iter().zip(means) {
                    let now = wanted(grid.index(point));
                    let index = grid.index(point) - row * points;
                    let fraction = (now - passes[index]) as f32 / now as f32;
                    let values = &mut values[index * sampler.half_buffers..];
                    for (value, mean) in values.iter_mut().zip(means) {
                        *value += fraction * (mean - *value);
                    }
                    passes[index] = now;
                }
            }
            let rays: u64 = tiles.iter().map(|tile| tile.rays).sum();
            let non_finite: u64 = tiles.iter().map(|tile| tile.non_finite).sum();
            [rays, non_finite]
        });
        let [rays, non_finite] = counts.reduce(|| [0; 2], |[a, b], [c, d]| [a + c, b + d]);
        self.rays += rays;
        self.non_finite += non_finite;
    }
}

/// Samples those of the points that have fewer passes than they shall have; `passes` gives both. None once the
/// observer stops.
fn refined_tile(
    mut points: Vec<(u32, u32)>,
    sampler: &Sampler,
    passes: impl Fn((u32, u32)) -> (u32, u32),
    observer: &dyn RenderObserver,
) -> RefinedTile {
    let stopped = observer.is_stopped();
    points.retain(|&point| {
        let (before, now) = passes(point);
        now > before && !stopped
    });
    let mut work = Work::default();
    let means = sampler.means(&points, passes, &mut work);
    observer.tile_done(work.query_state.rays);
    RefinedTile {
        points,
        means,
        rays: work.query_state.rays,
        non_finite: work.non_finite,
    }
}
