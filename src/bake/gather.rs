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

/// Points whose noise says how many paths all get.
const PILOTS: usize = 1024;

/// At most this many times the least number of paths leave a point.
const MOST: f32 = 8.0;

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
    /// The least number of paths per record, at least 2. There are more if the noise needs it: in rooms that are lit through
    /// windows few paths find the light.
    pub(super) paths: u32,
    /// The standard deviation of a value, over the value, that is allowed, in the mean over the records.
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
        let paths = self.paths_for_noise(points, secondary);
        let of_batch = |points: &[SurfacePoint]| {
            let mean_radiance = self.gather(points, secondary, paths, 0);
            points.iter().for_each(|_| on_point());
            mean_radiance
        };
        points.par_chunks(BATCH).flat_map_iter(of_batch).collect()
    }

    /// How many paths leave each of the points: as many as bring the noise down, by that of some points spread over all.
    /// It is one number for all, as values whose own noise decided would be too low: those seem good that have missed what
    /// is bright and rare.
    fn paths_for_noise(&self, points: &[SurfacePoint], secondary: &SecondaryIrradiance) -> u32 {
        let stride = points.len().div_ceil(PILOTS).max(1);
        let pilots: Vec<SurfacePoint> = points.iter().step_by(stride).copied().collect();
        let half = self.paths / 2;
        let halves = |points: &[SurfacePoint]| {
            let [a, b] = [0, 1].map(|index| self.gather(points, secondary, half, index));
            a.into_iter().zip(b).map(|(a, b)| [a, b])
        };
        let pairs: Vec<[Vec3; 2]> = pilots.par_chunks(BATCH).flat_map_iter(halves).collect();
        let noise = mean_relative_variance(&pairs).sqrt();
        let factor = (noise / self.noise).powi(2).clamp(1.0, MOST);
        (self.paths as f32 * factor) as u32
    }

    /// The mean radiance of some of the paths of each point: `paths` from `index` times as many on.
    fn gather(
        &self,
        points: &[SurfacePoint],
        secondary: &SecondaryIrradiance,
        paths: u32,
        index: u32,
    ) -> Vec<Vec3> {
        let gather_point = |point: &SurfacePoint| GatherPoint {
            point: *point,
            sequence: sequence_of(point, self.seed, self.stream, self.bounces_left),
            index,
        };
        let points: Vec<GatherPoint> = points.iter().map(gather_point).collect();
        let gather_paths = GatherPaths {
            bounces_left: self.bounces_left,
            count: paths,
            // What a camera sees gets that by shadow rays.
            include_sky: matches!(self.stream, RandomStream::Secondary),
        };
        let mut query_state = QueryState::default();
        self.final_gather
            .gather(&points, gather_paths, Some(secondary), &mut query_state)
    }
}

/// The variance of the mean of two independent values over its square, in the mean over such pairs. Pairs of black are left
/// out; 0 if there are no others.
fn mean_relative_variance(pairs: &[[Vec3; 2]]) -> f32 {
    let relative = |[a, b]: &[Vec3; 2]| {
        let (a, b) = (a.element_sum(), b.element_sum());
        (a + b > 0.0).then(|| ((a - b) / (a + b)).powi(2))
    };
    let relative: Vec<f32> = pairs.iter().filter_map(relative).collect();
    relative.iter().sum::<f32>() / relative.len().max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    /// Uniform values from 0 to 2 have a variance of 1/3, and the mean of two halves with n values each one of 1/(6 n).
    #[test]
    fn the_noise_of_values_is_known_from_halves() {
        let mut random = Random::new(2);
        let mut half = |count: u32| {
            let mean = (0..count).map(|_| 2.0 * random.unit()).sum::<f32>() / count as f32;
            Vec3::splat(mean)
        };
        for count in [16, 64] {
            let pairs: Vec<[Vec3; 2]> = (0..20_000).map(|_| [half(count), half(count)]).collect();
            let expected = 1.0 / (3.0 * 2.0 * count as f32);
            let variance = mean_relative_variance(&pairs);
            assert!(
                (variance / expected - 1.0).abs() < 0.06,
                "{variance} {expected}"
            );
        }
        let black = [[Vec3::ZERO; 2], [Vec3::ONE, Vec3::ONE]];
        assert_eq!(mean_relative_variance(&black), 0.0);
        assert_eq!(mean_relative_variance(&[]), 0.0);
    }
}
