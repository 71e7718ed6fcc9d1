//! Accumulates the samples of a frame's points, pass by pass.

use super::grid::Grid;
use super::observer::RenderObserver;
use super::sampler::{Moments, QuadrantSums, SampleRun, Sampler, Work};
use glam::Vec3;
use rayon::prelude::*;

/// The samples of each point of a frame so far.
pub(super) struct SampleAccumulator {
    /// The mean radiance of each point, half buffer by half buffer.
    pub(super) means: Vec<Vec3>,
    /// How many samples each point has, or each of its half buffers.
    pub(super) counts: Vec<u32>,
    /// The moments of the quadrants of each pixel, of both half buffers; empty unless samples are adaptive.
    pub(super) quadrants: Vec<[Moments; 4]>,
    pub(super) rays: u64,
    pub(super) non_finite: u64,
}

impl SampleAccumulator {
    pub(super) fn new(grid: Grid, sampler: &Sampler) -> SampleAccumulator {
        let quadrants = if sampler.is_adaptive { grid.len() } else { 0 };
        SampleAccumulator {
            means: vec![Vec3::ZERO; grid.len() * sampler.half_buffers],
            counts: vec![0; grid.len()],
            quadrants: vec![Default::default(); quadrants],
            rays: 0,
            non_finite: 0,
        }
    }

    /// Samples each half buffer of each point until it has as many samples as `wanted` gives for the point's index; tile
    /// by tile in parallel. Once the observer stops, further tiles are not sampled.
    pub(super) fn refine(
        &mut self,
        grid: Grid,
        sampler: &Sampler,
        wanted: impl Fn(usize) -> u32 + Send + Sync,
        observer: &dyn RenderObserver,
    ) {
        let halves = sampler.half_buffers;
        let wanted = &wanted;
        let per_row = grid.points_per_tile_row();
        let means = self.means.par_chunks_mut(per_row * halves);
        let points = means.zip(self.counts.par_chunks_mut(per_row));
        let quadrants = self.quadrants.chunks_mut(per_row);
        let mut quadrants: Vec<&mut [[Moments; 4]]> = quadrants.collect();
        quadrants.resize_with(points.len(), Default::default);
        let rows = points.zip(quadrants).enumerate();
        // Samples are added row by row of tiles, while they are in the processor's cache.
        let counts = rows.map(|(row, ((means, counts), quadrants))| {
            let tiles = grid.tiles_of_row(row).into_par_iter().map(|tile| {
                let is_stopped = observer.is_stopped();
                let points = grid.tile_points(tile);
                let mut runs = Vec::with_capacity(halves * points.len());
                for point in points {
                    let index = grid.index(point);
                    let (first, end) = (counts[index - row * per_row], wanted(index));
                    if end > first && !is_stopped {
                        runs.extend((0..halves).map(|half| SampleRun {
                            point,
                            sequence: sampler.sequence(half),
                            first,
                            end,
                        }));
                    }
                }
                let mut work = Work::default();
                let sums = sampler.sums(&runs, &mut work);
                observer.tile_done(work.query_state.rays);
                (runs, sums, work)
            });
            let tiles: Vec<(Vec<SampleRun>, Vec<QuadrantSums>, Work)> = tiles.collect();
            for (run, added) in tiles
                .iter()
                .flat_map(|(runs, added, _)| runs.iter().zip(added))
            {
                let point = grid.index(run.point) - row * per_row;
                let index = point * halves + run.sequence.half();
                let fraction = f64::from(run.end - run.first) / f64::from(run.end);
                let mean = means[index].as_dvec3().lerp(added.mean(), fraction);
                means[index] = mean.as_vec3();
                counts[point] = run.end;
                if let Some(quadrants) = quadrants.get_mut(point) {
                    for (quadrant, added) in quadrants.iter_mut().zip(added.moments()) {
                        quadrant.add(&added);
                    }
                }
            }
            let works = || tiles.iter().map(|(.., work)| work);
            let rays: u64 = works().map(|work| work.query_state.rays).sum();
            let non_finite: u64 = works().map(|work| work.non_finite).sum();
            [rays, non_finite]
        });
        let [rays, non_finite] = counts.reduce(|| [0; 2], |[a, b], [c, d]| [a + c, b + d]);
        self.rays += rays;
        self.non_finite += non_finite;
    }
}
