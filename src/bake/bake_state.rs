//! The records of one or more camera paths and their values, as a file keeps them between runs.

use super::candidates::PathProbe;
use super::counter::counter;
use super::finest_view::FinestView;
use super::fit_gradients::RecordFit;
use super::gather::{GatherDemand, GatherSettings};
use super::gathered_light::{GatheredLight, PathCells, RecordKey};
use super::keeper::BakeKeeper;
use super::placement::{MAX_ABOVE, PlacedCell, Placement};
use crate::camera::CameraPath;
use crate::integrator::FinalGather;
use crate::irradiance_cache::{CellKey, IrradianceCache};
use crate::render::ErrorEstimate;
use crate::scene::Scene;
use postcard::ser_flavors::Size;
use serde::{Deserialize, Serialize};

/// Called with the progress, from 0 to 1, and the current stage.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// The part of the work that is done when the views of all frames are known, when the records are placed, and when their
/// light is gathered: about what the shipped scenes take.
const SEEN: f64 = 0.03;
const PLACED: f64 = 0.1;
pub(super) const GATHERED: f64 = 0.9;

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

/// What the frames of a camera path look up.
#[derive(Debug, Serialize, Deserialize)]
struct PathRecords {
    /// The name of the camera path.
    name: String,
    refinement_level: u32,
    settings: GatherSettings,
    /// In order.
    records: Vec<RecordKey>,
    /// Of each record.
    fits: Vec<RecordFit>,
    /// The radiance that is displayed as white: errors are relative to it.
    display_white: f32,
    /// The cache errors, by frame; none before they are measured.
    errors: Option<Vec<ErrorEstimate>>,
}

impl BakeState {
    /// The highest refinement level.
    pub const MAX_REFINEMENT: u32 = 2;

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

    /// The irradiance cache that the frames of a path use; none if it does not hold that path.
    pub fn irradiance_cache(&self, scene: &Scene, name: &str) -> Option<IrradianceCache> {
        let path = self.path(name)?;
        let light = self
            .lights
            .iter()
            .find(|light| light.settings() == path.settings)?;
        Some(light.irradiance_cache(scene, self.bounces, &path.records, &path.fits))
    }

    /// Adds the records of a path whose frames have `size` columns and rows, in place of those of another level. At each
    /// refinement level, from 0 to [`BakeState::MAX_REFINEMENT`], cells have half the side of the last. What was gathered
    /// before is not gathered again.
    #[expect(clippy::too_many_arguments, reason = "a path and how it is rendered")]
    pub fn add_camera_path<Keeper: BakeKeeper>(
        &mut self,
        scene: &Scene,
        path: &CameraPath,
        name: &str,
        size: (u32, u32),
        refinement_level: u32,
        listener: Listener,
        keeper: &mut Keeper,
    ) -> Result<(), Keeper::Error> {
        /// How often records are added where the first ones turn out to be too far apart.
        const ROUNDS: i32 = 4;
        /// In so many parts are records gathered, unless these have fewer than so many records.
        const CHUNKS: usize = 32;
        const LEAST: usize = 1 << 13;
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
        let mut records = records_of(&placements);
        let final_gather = FinalGather::new(scene);
        let is_seen_directly = |key: &RecordKey| u32::from(key.bounces_left) == self.bounces;
        let seen_directly = records.iter().filter(|(key, _)| is_seen_directly(key));
        let settings = GatherSettings::for_records(&GatherDemand {
            final_gather: &final_gather,
            scene,
            seen_directly: &seen_directly
                .map(|(key, placed)| (key.cell, *placed))
                .collect::<Vec<_>>(),
            pixels: frames as u64 * u64::from(size.0) * u64::from(size.1),
            paths: records.keys().map(|key| 1 << key.paths).sum(),
            bounces: self.bounces,
            seed: self.seed,
            refinement_level,
        });
        let light = self.light_of(settings);
        keeper.reserve(self.stored_bytes(light, &records, path))?;
        for round in 0..=ROUNDS {
            // Later rounds are mostly shorter.
            let [from, to] = [round, round + 1].map(|round| {
                let rest = 0.5_f64.powi(round);
                rest * PLACED + (1.0 - rest) * GATHERED
            });
            let report = |part| listener(from + (to - from) * part, "irradiance");
            let missing = self.lights[light].missing(&records);
            let on_record = counter(missing.len(), report);
            for missing in missing.chunks(missing.len().div_ceil(CHUNKS).max(LEAST)) {
                self.lights[light].gather(&final_gather, missing, self.seed, &on_record);
                keeper.checkpoint(self)?;
            }
            if round == ROUNDS {
                break;
            }
            for (bounces_left, placement) in (1..).zip(&mut placements) {
                let light = &self.lights[light];
                placement.refine(light.too_far_apart(scene, bounces_left, &records));
            }
            let refined = records_of(&placements);
            if refined.keys().eq(records.keys()) {
                break;
            }
            records = refined;
        }
        let records: Vec<RecordKey> = records.into_keys().collect();
        let fits = self.lights[light].fits(scene, self.bounces, &records);
        self.paths.retain(|path| path.name != name);
        self.paths.push(PathRecords {
            name: name.to_owned(),
            refinement_level,
            settings,
            records,
            fits,
            display_white: 0.0,
            errors: None,
        });
        Ok(())
    }

    /// The index of what is gathered with these settings.
    fn light_of(&mut self, settings: GatherSettings) -> usize {
        let known = self
            .lights
            .iter()
            .position(|light| light.settings() == settings);
        known.unwrap_or_else(|| {
            self.lights.push(GatheredLight::new(settings, self.bounces));
            self.lights.len() - 1
        })
    }

    /// Bytes of the state in a file when the records of a path are gathered and its errors are measured.
    fn stored_bytes(&self, light: usize, records: &PathCells, path: &CameraPath) -> u64 {
        let now = postcard::serialize_with_flavor(self, Size::default()).expect("plain data");
        let frames = path.timeline().frame_count() as usize;
        let errors = frames * size_of::<ErrorEstimate>();
        (now + self.lights[light].bytes_of_new(records) + errors) as u64
    }
}

/// The records of the cells of a path.
fn records_of(placements: &[Placement]) -> PathCells {
    let of_bounce = |(bounces_left, placement): (u8, &'_ Placement)| {
        let record = move |(&cell, placed): (&CellKey, &PlacedCell)| {
            let paths = placed.above.min(MAX_ABOVE);
            let key = RecordKey {
                bounces_left,
                paths,
                cell,
            };
            (key, placed.placed)
        };
        placement.cells.iter().map(record).collect::<Vec<_>>()
    };
    (1..).zip(placements).flat_map(of_bounce).collect()
}
