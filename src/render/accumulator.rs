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
        let taken = &self.passes;
        let passes = |point| {
            let index = grid.index(point);
            (taken[index], wanted(index))
        };
        let refined: Vec<RefinedTile> = (0..grid.tiles())
            .into_par_iter()
            .map(|tile| {
                let mut points = grid.tile_points(tile);
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
            })
            .collect();
        for tile in refined {
            for (&point, means) in tile
                .points
                .iter()
                .zip(tile.means.chunks(sampler.half_buffers))
            {
                let index = grid.index(point);
                let (before, now) = (self.passes[index], wanted(index));
                let fraction = (now - before) as f32 / now as f32;
                let values = &mut self.values[index * sampler.half_buffers..];
                for (value, mean) in values.iter_mut().zip(means) {
                    *value += fraction * (mean - *value);
                }
                self.passes[index] = now;
            }
            self.rays += tile.rays;
            self.non_finite += tile.non_finite;
        }
    }
}
