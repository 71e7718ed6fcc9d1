//! The records of one or more camera paths and their values, as a file keeps them between runs.

use super::candidates::PathProbe;
use super::finest_view::FinestView;
use super::fit_gradients::{Fits, GatheredValue};
use super::gather::{GatherPass, GatherSettings};
use super::placement::{MAX_ABOVE, MAX_ANGLE, PlacedCell, PlacedRecord, Placement};
use crate::camera::CameraPath;
use crate::integrator::FinalGather;
use crate::irradiance_cache::{
    CellKey, IrradianceCache, IrradianceRecord, IrradianceRecords, PrimaryIrradiance,
    SecondaryIrradiance,
};
use crate::render::ErrorEstimate;
use crate::scene::Scene;
use glam::Vec3;
use postcard::ser_flavors::Size;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// By how much values may be off a function through those around them, in the mean and relative to it; and in the smallest
/// cells.
const MISFIT: f64 = 0.03;
const STEP: f64 = 0.15;

/// Called with the progress, from 0 to 1, and the current stage.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// The part of the work that is done when the views of all frames are known, when the records are placed, and when their
/// light is gathered: about what the shipped scenes take.
const SEEN: f64 = 0.03;
const PLACED: f64 = 0.1;
pub(super) const GATHERED: f64 = 0.9;

/// Calls `report` with the part of `all` that is done, for some of the times that it is called.
fn counter(all: usize, report: impl Fn(f64) + Sync) -> impl Fn() + Sync {
    let done = AtomicUsize::new(0);
    let stride = all.div_ceil(256).max(1);
    move || {
        let before = done.fetch_add(1, Ordering::Relaxed);
        if before.is_multiple_of(stride) {
            report(before as f64 / all as f64);
        }
    }
}

/// The irradiance records of some camera paths, and what it takes to add those of further paths.
///
/// A path's frames look up its own records only, and each record is the same whichever path needed it first: so what is
/// there for other paths changes nothing.
#[derive(Debug, Serialize, Deserialize)]
pub struct BakeState {
    seed: u32,
    bounces: u32,
    lights: Vec<GatheredLight>,
    paths: Vec<PathRecords>,
}

/// What is gathered with the same settings.
#[derive(Debug, Serialize, Deserialize)]
struct GatheredLight {
    settings: GatherSettings,
    secondary: Arc<SecondaryIrradiance>,
    primary: BTreeMap<RecordKey, GatheredRecord>,
}

/// What a primary record is, beside the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
struct RecordKey {
    bounces_left: u8,
    /// The binary logarithm of the factor to the paths of the smallest.
    paths: u8,
    cell: CellKey,
}

/// A primary record and its value.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct GatheredRecord {
    placed: PlacedRecord,
    /// E / π in W/(sr m²), by each half of the paths.
    halves: [Vec3; 2],
}

/// What the frames of a camera path look up.
#[derive(Debug, Serialize, Deserialize)]
struct PathRecords {
    /// The name of the camera path.
    name: String,
    refinement_level: u32,
    settings: GatherSettings,
    records: Vec<RecordKey>,
    /// The radiance that is displayed as white: errors are relative to it.
    display_white: f32,
    /// The cache errors, by frame; none before they are measured.
    errors: Option<Vec<ErrorEstimate>>,
}

impl BakeState {
    /// The highest refinement level.
    pub const MAX_REFINEMENT: u32 = 3;

    /// The state without records, where `bounces` bounces are counted.
    pub fn new(bounces: u32, seed: u32) -> BakeState {
        BakeState {
            seed,
            bounces,
            lights: Vec::new(),
            paths: Vec::new(),
        }
    }

    /// The refinement level of the records of a path; none if it does not hold that path.
    pub fn refinement_level(&self, name: &str) -> Option<u32> {
        self.path(name).map(|path| path.refinement_level)
    }

    /// The names of the camera paths whose records it holds, in the order in which they were added.
    pub fn camera_paths(&self) -> impl Iterator<Item = &str> {
        self.paths.iter().map(|path| &*path.name)
    }

    fn path(&self, name: &str) -> Option<&PathRecords> {
        self.paths.iter().find(|path| path.name == name)
    }

    /// The cache error of each frame of a path, if it was measured for this display white.
    pub fn errors(&self, name: &str, display_white: f32) -> Option<&[ErrorEstimate]> {
        let path = self.path(name)?;
        let is_same = path.display_white == display_white;
        path.errors.as_deref().filter(|_| is_same)
    }

    /// Stores the cache error of each frame of a path.
    pub(super) fn set_errors(&mut self, name: &str, display_white: f32, errors: &[ErrorEstimate]) {
        if let Some(path) = self.paths.iter_mut().find(|path| path.name == name) {
            path.display_white = display_white;
            path.errors = Some(errors.to_vec());
        }
    }

    fn light(&self, settings: GatherSettings) -> Option<&GatheredLight> {
        self.lights.iter().find(|light| light.settings == settings)
    }

    /// The irradiance cache that the frames of a path use; none if it does not hold that path.
    pub fn irradiance_cache(&self, scene: &Scene, name: &str) -> Option<IrradianceCache> {
        let path = self.path(name)?;
        let light = self.light(path.settings)?;
        let primary =
            |bounces_left: u8| light.primary_irradiance(scene, bounces_left, &path.records);
        Some(IrradianceCache {
            primary: (1..=self.bounces as u8).map(primary).collect(),
            secondary: light.secondary.clone(),
        })
    }

    /// Adds the records of a path whose frames have `size` columns and rows, in place of those of another level. At each
    /// refinement level, from 0 to [`BakeState::MAX_REFINEMENT`], cells have half the side of the last. `reserve` is as that
    /// of [`super::bake_with_room`].
    #[expect(clippy::too_many_arguments, reason = "a path and how it is rendered")]
    pub fn add_camera_path<E>(
        &mut self,
        scene: &Scene,
        path: &CameraPath,
        name: &str,
        size: (u32, u32),
        refinement_level: u32,
        listener: Listener,
        reserve: &mut impl FnMut(u64) -> Result<(), E>,
    ) -> Result<(), E> {
        /// How often records are added where the first ones turn out to be too far apart.
        const ROUNDS: u32 = 4;
        let probe = PathProbe {
            scene,
            path,
            size,
            bounces: self.bounces,
            seed: self.seed,
        };
        let frames = path.timeline().frame_count() as usize;
        let seen = counter(frames, |part| listener(SEEN * part, "views"));
        let views = match self.bounces {
            0 => Vec::new(),
            _ => FinestView::of(&probe, seen),
        };
        let placed = counter(frames, |part| {
            listener(SEEN + (PLACED - SEEN) * part, "primary records");
        });
        let mut placements = Placement::of_path(&probe, refinement_level, &views, placed);
        let final_gather = FinalGather::new(scene);
        let directly = placements.last().map(|placement| &placement.cells);
        let settings = GatherSettings::for_records(
            &final_gather,
            scene,
            &directly
                .into_iter()
                .flatten()
                .map(|(&cell, placed)| (cell, placed.placed))
                .collect::<Vec<_>>(),
            records_of(&placements)
                .iter()
                .map(|(key, _)| 1 << key.paths)
                .sum(),
            self.bounces,
            self.seed,
            refinement_level,
        );
        let light = self.light_of(settings);
        let mut progress = PLACED;
        for round in 0..=ROUNDS {
            let records = records_of(&placements);
            let missing = |(key, _): &&(RecordKey, PlacedRecord)| {
                !self.lights[light].primary.contains_key(key)
            };
            let mut new: Vec<_> = records.iter().filter(missing).copied().collect();
            if round == 0 {
                reserve(self.stored_bytes(records.len(), new.len(), path))?;
            }
            // Later rounds are mostly shorter.
            let from = progress;
            progress = 0.5 * (from + GATHERED);
            let on_record = counter(new.len(), |part| {
                listener(from + (progress - from) * part, "irradiance");
            });
            self.gather(&final_gather, light, &mut new, &on_record);
            let keys = records.iter().map(|(key, _)| *key).collect();
            if new.is_empty() || round == ROUNDS {
                self.paths.retain(|path| path.name != name);
                self.paths.push(PathRecords {
                    name: name.to_owned(),
                    refinement_level,
                    settings,
                    records: keys,
                    display_white: 0.0,
                    errors: None,
                });
                break;
            }
            for (bounces_left, placement) in (1..).zip(&mut placements) {
                placement.refine(self.lights[light].too_far_apart(scene, bounces_left, &keys));
            }
        }
        Ok(())
    }

    /// The index of what is gathered with these settings.
    fn light_of(&mut self, settings: GatherSettings) -> usize {
        let known = self
            .lights
            .iter()
            .position(|light| light.settings == settings);
        known.unwrap_or_else(|| {
            let bounces = self.bounces.saturating_sub(1);
            let secondary = SecondaryIrradiance::new(settings.secondary, bounces);
            self.lights.push(GatheredLight {
                settings,
                secondary: Arc::new(secondary),
                primary: BTreeMap::new(),
            });
            self.lights.len() - 1
        })
    }

    /// Gathers the values of new primary records.
    fn gather(
        &mut self,
        final_gather: &FinalGather,
        light: usize,
        records: &mut [(RecordKey, PlacedRecord)],
        on_record: &(dyn Fn() + Sync),
    ) {
        let seed = self.seed;
        let light = &mut self.lights[light];
        // Those of as many paths together.
        records.sort_by_key(|(key, _)| *key);
        for group in records
            .chunk_by(|(a, _), (b, _)| (a.bounces_left, a.paths) == (b.bounces_left, b.paths))
        {
            let (key, _) = group[0];
            let pass = GatherPass {
                final_gather,
                secondary: &light.secondary,
                bounces_left: key.bounces_left.into(),
                seed,
            };
            let points: Vec<_> = group
                .iter()
                .map(|(key, placed)| (key.cell, *placed))
                .collect();
            let paths = light.settings.paths << key.paths;
            let gathered = pass.halves(&points, paths, on_record);
            let gathered = group.iter().zip(gathered);
            light
                .primary
                .extend(gathered.map(|((key, placed), halves)| {
                    let record = GatheredRecord {
                        placed: *placed,
                        halves,
                    };
                    (*key, record)
                }));
        }
    }

    /// Bytes of the state in a file when a path's new records are gathered and its errors are measured.
    fn stored_bytes(&self, records: usize, new: usize, camera_path: &CameraPath) -> u64 {
        let now = postcard::serialize_with_flavor(self, Size::default()).expect("plain data");
        let records = records * size_of::<RecordKey>();
        let values = new * (size_of::<RecordKey>() + size_of::<GatheredRecord>());
        let errors = camera_path.timeline().frame_count() as usize * size_of::<ErrorEstimate>();
        // Lengths, and about as many secondary records as there are in a room.
        const REST: usize = 1 << 22;
        (now + records + values + errors + REST) as u64
    }
}

/// The records of the cells of a path, by the number of bounces left less 1.
fn records_of(placements: &[Placement]) -> Vec<(RecordKey, PlacedRecord)> {
    let of_bounce = |(bounces_left, placement): (u8, &'_ Placement)| {
        let record = move |(&cell, placed): (&CellKey, &PlacedCell)| {
            let key = RecordKey {
                bounces_left,
                paths: placed.above.min(MAX_ABOVE),
                cell,
            };
            (key, placed.placed)
        };
        placement.cells.iter().map(record).collect::<Vec<_>>()
    };
    (1..).zip(placements).flat_map(of_bounce).collect()
}

impl GatheredLight {
    /// The records among `keys` with a certain number of bounces left, and their values.
    fn values(
        &self,
        bounces_left: u8,
        keys: &[RecordKey],
    ) -> (Vec<IrradianceRecord>, Vec<GatheredValue>) {
        let of_bounce = keys.iter().filter(|key| key.bounces_left == bounces_left);
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
        of_bounce.map(value).unzip()
    }

    /// What frames interpolate.
    fn primary_irradiance(
        &self,
        scene: &Scene,
        bounces_left: u8,
        keys: &[RecordKey],
    ) -> PrimaryIrradiance {
        let (records, values) = self.values(bounces_left, keys);
        let gradients = Fits::new(scene, &records, &values).gradients();
        let (records, order) = IrradianceRecords::new(scene.bounds(), MAX_ANGLE, records);
        PrimaryIrradiance {
            values: order.iter().map(|&index| gradients[index][0]).collect(),
            half_difference: order.iter().map(|&index| gradients[index][1]).collect(),
            records: Arc::new(records),
        }
    }

    /// The records that stand too far apart: those in the smallest cells only at steps.
    fn too_far_apart(
        &self,
        scene: &Scene,
        bounces_left: u8,
        keys: &[RecordKey],
    ) -> impl Iterator<Item = IrradianceRecord> + use<> {
        let (records, values) = self.values(bounces_left, keys);
        let of_bounce: Vec<&RecordKey> = keys
            .iter()
            .filter(|key| key.bounces_left == bounces_left)
            .collect();
        let fits = Fits::new(scene, &records, &values);
        let numbers = (0..records.len()).into_par_iter();
        let misfit = |index: usize| {
            if of_bounce[index].paths > 0 {
                MISFIT
            } else {
                STEP
            }
        };
        let found = numbers.filter(|&index| fits.is_coarse(index, misfit(index)));
        let found: Vec<IrradianceRecord> = found.map(|index| records[index]).collect();
        found.into_iter()
    }
}
