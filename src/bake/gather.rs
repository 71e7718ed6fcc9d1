//! Gathers the values of records: a final gather at each of them.

use super::placement::PlacedRecord;
use crate::accel::QueryState;
use crate::integrator::{FinalGather, GatherPaths, GatherPoint};
use crate::irradiance_cache::{CellIrradiance, CellKey, CellSettings};
use crate::math::{Ray, to_world};
use crate::sampling::{SobolSequence, cosine_hemisphere};
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Points that are gathered for together.
const BATCH: usize = 16;

/// Records whose surroundings and noise decide the settings of all.
const PILOTS: usize = 512;

/// The least number of paths of a primary record.
const PATHS: u32 = 32;

/// The least number of paths of a secondary record.
const SECONDARY_PATHS: u32 = 64;

/// At most this many times as many paths leave a record.
const MOST: f32 = 8.0;
const MOST_SECONDARY: u32 = 4;

/// Bounds of the paths of all records together, where there is little noise, that few records share, one for each pixel of
/// all frames; and how many times as many they get at most.
const MIN_ALL_PATHS: u64 = 2_000_000;
const MAX_ALL_PATHS: u64 = 8_000_000;
const MOST_OF_FEW: u64 = 8;

/// The standard deviation of a value with the least number of paths, over the value, above which there are more: in rooms
/// that are lit through windows few paths find the light.
const NOISE: f32 = 0.15;

/// The side of secondary cells relative to the median distance between surfaces.
const RELATIVE_SECONDARY_SIDE: f32 = 0.12;

/// Sets the random numbers of primary records apart from those of secondary ones.
const STREAM: u32 = 1 << 8;

/// What decides the values of records, beside the scene and their cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct GatherSettings {
    pub(super) secondary: CellSettings,
    /// The paths of the primary records in the smallest cells.
    pub(super) paths: u32,
}

/// What asks for settings.
pub(super) struct GatherDemand<'a> {
    pub(super) final_gather: &'a FinalGather<'a>,
    pub(super) scene: &'a Scene,
    /// The records of a path that are seen directly.
    pub(super) seen_directly: &'a [(CellKey, PlacedRecord)],
    /// The paths of all its records, in those of the smallest.
    pub(super) paths: u64,
    /// The pixels of all frames.
    pub(super) pixels: u64,
    pub(super) bounces: u32,
    pub(super) seed: u32,
    pub(super) refinement_level: u32,
}

impl GatherSettings {
    /// The settings that the records of a path ask for. They come in powers of two, so that other paths in the same rooms
    /// mostly ask for the same.
    ///
    /// Noise decides for all records at once, as values whose own noise decided would be too low: those seem good that
    /// have missed what is bright and rare.
    pub(super) fn for_records(demand: &GatherDemand) -> GatherSettings {
        let GatherDemand {
            final_gather,
            scene,
            seen_directly,
            paths,
            pixels,
            bounces,
            seed,
            refinement_level,
        } = *demand;
        let stride = seen_directly.len().div_ceil(PILOTS).max(1);
        let pilots: Vec<_> = seen_directly.iter().step_by(stride).copied().collect();
        let side = RELATIVE_SECONDARY_SIDE * median_distance(scene, &pilots, seed);
        let level = CellKey::level_of_side(side) - refinement_level as i32 / 2;
        let mut settings = GatherSettings {
            secondary: CellSettings {
                level: level as i8,
                paths: SECONDARY_PATHS << refinement_level,
                seed,
            },
            paths: PATHS,
        };
        let secondary = CellIrradiance::new(settings.secondary, bounces.saturating_sub(1));
        let pass = GatherPass {
            final_gather,
            secondary: &secondary,
            bounces_left: bounces,
            seed,
        };
        let pairs = pass.halves(&pilots, PATHS, &|| ());
        let area = |(cell, _): &(CellKey, PlacedRecord)| cell.side().powi(2);
        let noise = mean_relative_variance(&pairs, pilots.iter().map(area)).sqrt();
        let factor = (noise / NOISE).powi(2).clamp(1.0, MOST) as u32;
        let factor = factor.next_power_of_two();
        let all_paths = pixels.clamp(MIN_ALL_PATHS, MAX_ALL_PATHS);
        let few = (all_paths / (u64::from(PATHS) * paths).max(1)).clamp(1, MOST_OF_FEW);
        settings.paths *= factor << few.ilog2();
        settings.secondary.paths *= factor.min(MOST_SECONDARY);
        settings
    }
}

/// The median distance that paths go from some records, by area; the scene's size if there is nothing around them.
fn median_distance(scene: &Scene, records: &[(CellKey, PlacedRecord)], seed: u32) -> f32 {
    let ray = |(cell, placed): &(CellKey, PlacedRecord)| -> Ray {
        let [u, v] = sequence_of(cell, seed, 0).sample_2d(0, 0);
        let direction = to_world(placed.point.geometric_normal, cosine_hemisphere(u, v));
        placed.point.spawn_ray(direction)
    };
    let rays: Vec<Ray> = records.iter().map(ray).collect();
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(&rays, &mut hits, &mut QueryState::default());
    let area = |cell: &CellKey| f64::from(cell.side()).powi(2);
    let hits = records.iter().zip(&hits);
    let mut distances: Vec<(f64, f64)> = hits
        .filter_map(|((cell, _), hit)| Some((hit.as_ref()?.t, area(cell))))
        .collect();
    distances.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut rest = 0.5 * distances.iter().map(|(_, area)| area).sum::<f64>();
    let median = distances.iter().find(|(_, area)| {
        rest -= area;
        rest <= 0.0
    });
    let size = || scene.bounds().extent().max_element().max(1.0);
    median.map_or_else(size, |(distance, _)| *distance as f32)
}

/// The samples of a record. They depend on its cell, not on when it was found.
fn sequence_of(cell: &CellKey, seed: u32, bounces_left: u32) -> SobolSequence {
    let [level_and_facing, x, y, z] = cell.words();
    SobolSequence::new(seed ^ level_and_facing, x, y, z).stream(STREAM | bounces_left)
}

/// How the values of records are gathered.
pub(super) struct GatherPass<'a> {
    pub(super) final_gather: &'a FinalGather<'a>,
    pub(super) secondary: &'a CellIrradiance,
    /// How many bounces are left at the records, at least one.
    pub(super) bounces_left: u32,
    pub(super) seed: u32,
}

impl GatherPass<'_> {
    /// Mean incident radiance at each record, E / π in W/(sr m²), by each half of some paths. `on_record` is called once per
    /// finished record.
    pub(super) fn halves(
        &self,
        records: &[(CellKey, PlacedRecord)],
        paths: u32,
        on_record: &(dyn Fn() + Sync),
    ) -> Vec<[Vec3; 2]> {
        let of_batch = |records: &[(CellKey, PlacedRecord)]| {
            let point = |index: u32| {
                records.iter().map(move |(cell, placed)| GatherPoint {
                    point: placed.point,
                    sequence: sequence_of(cell, self.seed, self.bounces_left),
                    index,
                })
            };
            let points: Vec<GatherPoint> = point(0).chain(point(1)).collect();
            let gather_paths = GatherPaths {
                bounces_left: self.bounces_left,
                count: paths / 2,
                // What a camera sees gets that by shadow rays.
                include_sky: false,
            };
            let query_state = &mut QueryState::default();
            let gathered =
                self.final_gather
                    .gather(&points, gather_paths, self.secondary, query_state);
            records.iter().for_each(|_| on_record());
            let (first, second) = gathered.split_at(records.len());
            let pairs = first.iter().zip(second).map(|(a, b)| [*a, *b]);
            pairs.collect::<Vec<_>>()
        };
        records.par_chunks(BATCH).flat_map_iter(of_batch).collect()
    }
}

/// The variance of the mean of two independent values over its square, in the weighted mean over such pairs. Pairs of black
/// are left out; 0 if there are no others.
fn mean_relative_variance(pairs: &[[Vec3; 2]], weights: impl Iterator<Item = f32>) -> f32 {
    let (mut sum, mut all) = (0.0, 0.0);
    for ([a, b], weight) in pairs.iter().zip(weights) {
        let (a, b) = (a.element_sum(), b.element_sum());
        if a + b > 0.0 {
            sum += weight * ((a - b) / (a + b)).powi(2);
            all += weight;
        }
    }
    if all > 0.0 { sum / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;
    use std::iter;

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
            let variance = mean_relative_variance(&pairs, iter::repeat(0.5));
            assert!(
                (variance / expected - 1.0).abs() < 0.06,
                "{variance} {expected}"
            );
        }
        let black = [[Vec3::ZERO; 2], [Vec3::ONE, Vec3::ONE]];
        assert_eq!(mean_relative_variance(&black, iter::repeat(1.0)), 0.0);
        assert_eq!(mean_relative_variance(&[], iter::repeat(1.0)), 0.0);
    }
}
