//! Primary and secondary records that are gathered with the same settings, whichever paths need them.

use super::fit_gradients::{Fits, GatheredValue, RecordFit};
use super::gather::{GatherPass, GatherSettings};
use super::placement::{MAX_ANGLE, PlacedRecord};
use crate::integrator::FinalGather;
use crate::irradiance_cache::{
    CellIrradiance, CellKey, CellSettings, IrradianceCache, IrradianceRecord, IrradianceRecords,
    PrimaryIrradiance,
};
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// By how much values may be off a function through those around them, in the mean and relative to it; and in the smallest
/// cells.
const MISFIT: f64 = 0.03;
const STEP: f64 = 0.15;

/// What a primary record is, beside the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct RecordKey {
    pub(super) bounces_left: u8,
    /// The binary logarithm of the factor to the paths of the smallest.
    pub(super) paths: u8,
    pub(super) cell: CellKey,
}

/// The records that a path needs.
pub(super) type PathCells = BTreeMap<RecordKey, PlacedRecord>;

/// A primary record and its value.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct GatheredRecord {
    placed: PlacedRecord,
    /// E / π in W/(sr m²), by each half of the paths.
    halves: [Vec3; 2],
}

/// What is gathered with the same settings.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct GatheredLight {
    settings: GatherSettings,
    secondary: Arc<CellIrradiance>,
    primary: BTreeMap<RecordKey, GatheredRecord>,
}

impl GatheredLight {
    /// Nothing yet, for up to `bounces` bounces.
    pub(super) fn new(settings: GatherSettings, bounces: u32) -> GatheredLight {
        let secondary = CellIrradiance::new(settings.secondary, bounces.saturating_sub(1));
        GatheredLight {
            settings,
            secondary: Arc::new(secondary),
            primary: BTreeMap::new(),
        }
    }

    /// The settings.
    pub(super) fn settings(&self) -> GatherSettings {
        self.settings
    }

    /// Those records that have no value, in order.
    pub(super) fn missing(&self, records: &PathCells) -> Vec<(RecordKey, PlacedRecord)> {
        let is_missing = |(key, _): &(&RecordKey, &PlacedRecord)| !self.primary.contains_key(key);
        let missing = records.iter().filter(is_missing);
        missing.map(|(key, placed)| (*key, *placed)).collect()
    }

    /// Gathers the values of records, which are in order.
    pub(super) fn gather(
        &mut self,
        final_gather: &FinalGather,
        records: &[(RecordKey, PlacedRecord)],
        seed: u32,
        on_record: &(dyn Fn() + Sync),
    ) {
        let alike =
            |a: &RecordKey, b: &RecordKey| (a.bounces_left, a.paths) == (b.bounces_left, b.paths);
        for group in records.chunk_by(|(a, _), (b, _)| alike(a, b)) {
            let (key, _) = group[0];
            let pass = GatherPass {
                final_gather,
                secondary: &self.secondary,
                bounces_left: key.bounces_left.into(),
                seed,
            };
            let in_cells: Vec<_> = group
                .iter()
                .map(|(key, placed)| (key.cell, *placed))
                .collect();
            let halves = pass.halves(&in_cells, self.settings.paths << key.paths, on_record);
            let gathered = group.iter().zip(halves);
            self.primary.extend(
                gathered.map(|(&(key, placed), halves)| (key, GatheredRecord { placed, halves })),
            );
        }
    }

    /// Bytes in a file of those records that are not there yet.
    pub(super) fn bytes_of_new(&self, records: &PathCells) -> usize {
        // About as many secondary records as there are in a room.
        const SECONDARY: usize = 1 << 22;
        let of_new =
            self.missing(records).len() * (size_of::<RecordKey>() + size_of::<GatheredRecord>());
        let of_path = size_of::<RecordKey>() + size_of::<RecordFit>();
        of_new + records.len() * of_path + SECONDARY
    }

    /// The functions that fit the values of the records of a path, and the halves of these, in the order of the records.
    pub(super) fn fits(&self, scene: &Scene, bounces: u32, keys: &[RecordKey]) -> Vec<RecordFit> {
        let fits = |bounces_left: u8| {
            let (records, values) = self.values(bounces_left, keys.iter());
            Fits::new(scene, &records, &values).gradients()
        };
        (1..=bounces as u8).flat_map(fits).collect()
    }

    /// What frames look up that need these records, which have these fits.
    pub(super) fn irradiance_cache(
        &self,
        scene: &Scene,
        bounces: u32,
        keys: &[RecordKey],
        fits: &[RecordFit],
    ) -> IrradianceCache {
        let primary = |bounces_left: u8| {
            let first = keys.partition_point(|key| key.bounces_left < bounces_left);
            let (records, _) = self.values(bounces_left, keys.iter());
            let fits = &fits[first..first + records.len()];
            let (records, order) = IrradianceRecords::new(scene.bounds(), MAX_ANGLE, records);
            PrimaryIrradiance {
                values: order.iter().map(|&index| fits[index][0]).collect(),
                half_difference: order.iter().map(|&index| fits[index][1]).collect(),
                records: Arc::new(records),
            }
        };
        IrradianceCache {
            primary: (1..=bounces as u8).map(primary).collect(),
            secondary: self.secondary.clone(),
            uncovered: Arc::new(CellIrradiance::new(
                CellSettings {
                    paths: 2 * self.settings.paths,
                    ..self.settings.secondary
                },
                bounces,
            )),
        }
    }

    /// The records with a certain number of bounces left that stand too far apart: those in the smallest cells only at steps.
    pub(super) fn too_far_apart(
        &self,
        scene: &Scene,
        bounces_left: u8,
        records: &PathCells,
    ) -> Vec<IrradianceRecord> {
        let of_bounce = records
            .keys()
            .filter(|key| key.bounces_left == bounces_left);
        let misfits: Vec<f64> = of_bounce
            .map(|key| if key.paths > 0 { MISFIT } else { STEP })
            .collect();
        let (records, values) = self.values(bounces_left, records.keys());
        let fits = Fits::new(scene, &records, &values);
        let numbers = (0..records.len()).into_par_iter();
        let found = numbers.filter(|&index| fits.is_coarse(index, misfits[index]));
        found.map(|index| records[index]).collect()
    }

    /// The records among `keys` with a certain number of bounces left, and their values.
    fn values<'k>(
        &self,
        bounces_left: u8,
        keys: impl Iterator<Item = &'k RecordKey>,
    ) -> (Vec<IrradianceRecord>, Vec<GatheredValue>) {
        let value = |key: &RecordKey| {
            let GatheredRecord {
                placed,
                halves: [a, b],
            } = self.primary[key];
            let value = GatheredValue {
                point: placed.point,
                mean_radiance: 0.5 * (a + b),
                half_difference: 0.5 * (a - b),
                paths: self.settings.paths << key.paths,
            };
            (placed.record, value)
        };
        let of_bounce = keys.filter(|key| key.bounces_left == bounces_left);
        of_bounce.map(value).unzip()
    }
}
