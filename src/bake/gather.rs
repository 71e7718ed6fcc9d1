//! Gathers the values of records: a final gather at each of them.

use crate::accel::QueryState;
use crate::integrator::{FinalGather, GatherPaths, GatherPoint};
use crate::irradiance_cache::SecondaryIrradiance;
use crate::sampling::SobolSequence;
use crate::scene::SurfacePoint;
use glam::Vec3;
use rayon::prelude::*;

/// Points that are gathered for together.
const BATCH: usize = 16;

/// At most this many times the paths of a round leave a point; at least two times.
const MAX_ROUNDS: u32 = 16;

/// What samples are for. Samples of different purposes are independent.
#[derive(Clone, Copy, Debug)]
pub(super) enum RandomStream {
    Probe,
    Secondary,
    Primary,
}

/// The samples of a point. They depend on its position and normal, not on when it was found.
pub(super) fn sequence_of(
    point: &SurfacePoint,
    seed: u32,
    stream: RandomStream,
    bounces_left: u32,
) -> SobolSequence {
    let [x, y, z] = point.position.to_array().map(f32::to_bits);
    let [nx, ny, nz] = point.shading_normal.to_array().map(f32::to_bits);
    let side = nx ^ ny.rotate_left(11) ^ nz.rotate_left(22);
    let stream = (stream as u32) << 8 | bounces_left;
    SobolSequence::new(seed ^ side, stream ^ x.rotate_left(16), y, z)
}

/// How the values of records are gathered.
pub(super) struct GatherPass<'a> {
    pub(super) final_gather: &'a FinalGather<'a>,
    /// How many bounces are left at the records, at least one.
    pub(super) bounces_left: u32,
    /// Paths per record and round.
    pub(super) paths: u32,
    /// Rounds go on until the standard error of a value, over the value, is at most this.
    pub(super) noise: f32,
    pub(super) stream: RandomStream,
    pub(super) seed: u32,
}

impl GatherPass<'_> {
    /// Mean incident radiance at each point, E / π in W/(sr m²). Paths end at the first hit that the secondary
    /// records cover. `on_point` is called once per finished point.
    pub(super) fn mean_radiance(
        &self,
        points: &[SurfacePoint],
        secondary: &SecondaryIrradiance,
        on_point: &(dyn Fn() + Sync),
    ) -> Vec<Vec3> {
        let of_batch = |points: &[SurfacePoint]| {
            let mut query_state = QueryState::default();
            let mut sums = vec![RoundSums::default(); points.len()];
            let mut noisy: Vec<usize> = (0..points.len()).collect();
            for round in 0..MAX_ROUNDS {
                let gather_point = |&number: &usize| GatherPoint {
                    point: points[number],
                    sequence: sequence_of(
                        &points[number],
                        self.seed,
                        self.stream,
                        self.bounces_left,
                    ),
                    index: round,
                };
                let gather_points: Vec<GatherPoint> = noisy.iter().map(gather_point).collect();
                let mean_radiance = self.final_gather.gather(
                    &gather_points,
                    GatherPaths {
                        bounces_left: self.bounces_left,
                        count: self.paths,
                        // What a camera sees gets that by shadow rays.
                        include_sky: matches!(self.stream, RandomStream::Secondary),
                    },
                    Some(secondary),
                    &mut query_state,
                );
                for (&number, radiance) in noisy.iter().zip(mean_radiance) {
                    sums[number].add(radiance);
                }
                noisy.retain(|&number| sums[number].relative_error() > self.noise);
                if noisy.is_empty() {
                    break;
                }
            }
            points.iter().for_each(|_| on_point());
            sums.into_iter().map(|sums| sums.mean())
        };
        points.par_chunks(BATCH).flat_map_iter(of_batch).collect()
    }
}

/// The sums of the values that rounds gave.
#[derive(Clone, Default)]
struct RoundSums {
    rounds: f32,
    sum: Vec3,
    /// Of the squares of the sum over the channels.
    squares: f32,
}

impl RoundSums {
    fn add(&mut self, value: Vec3) {
        self.rounds += 1.0;
        self.sum += value;
        self.squares += value.element_sum() * value.element_sum();
    }

    fn mean(&self) -> Vec3 {
        self.sum / self.rounds
    }

    /// The standard error of the mean over the mean; infinite of a single value, 0 of black.
    fn relative_error(&self) -> f32 {
        if self.rounds < 2.0 {
            return f32::INFINITY;
        }
        let mean = self.mean().element_sum();
        let variance = (self.squares / self.rounds - mean * mean).max(0.0) / (self.rounds - 1.0);
        if mean > 0.0 {
            variance.sqrt() / mean
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_know_their_noise() {
        let mut sums = RoundSums::default();
        sums.add(Vec3::splat(1.0));
        assert_eq!(sums.relative_error(), f32::INFINITY);
        sums.add(Vec3::splat(3.0));
        // Two values one off their mean of 2: the mean's deviation is 1.
        assert_eq!(sums.mean(), Vec3::splat(2.0));
        assert!((sums.relative_error() - 0.5).abs() < 1e-6);
        for value in [1.0, 3.0] {
            sums.add(Vec3::splat(value));
        }
        assert!((sums.relative_error() - 0.5 / 3.0_f32.sqrt()).abs() < 1e-6);
        let mut black = RoundSums::default();
        black.add(Vec3::ZERO);
        black.add(Vec3::ZERO);
        assert_eq!(black.relative_error(), 0.0);
    }
}
