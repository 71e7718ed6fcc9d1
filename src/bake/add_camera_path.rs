//! Adds a camera path to a [`BakeState`]: its records are placed, gathered, and refined where they stand too far apart.

use super::bake_state::{BakeState, PathRecords};
use super::candidates::PathProbe;
use super::counter::counter;
use super::finest_view::FinestView;
use super::gather::{GatherDemand, GatherSettings};
use super::gathered_light::{GatheredLight, PathCells, RecordKey};
use super::keeper::BakeKeeper;
use super::placement::{MAX_ABOVE, PlacedCell, Placement};
use crate::camera::CameraPath;
use crate::integrator::FinalGather;
use crate::irradiance_cache::CellKey;
use crate::render::ErrorEstimate;
use crate::scene::Scene;
use postcard::ser_flavors::Size;

/// Called with the progress, from 0 to 1, and the current stage.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// The part of the work that is done when the views of all frames are known, when the records are placed, and when their
/// light is gathered: about what the shipped scenes take.
const SEEN: f64 = 0.03;
const PLACED: f64 = 0.1;
pub(super) const GATHERED: f64 = 0.9;

impl BakeState {
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
        let replaced = self.path(name).map(|path| path.settings);
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
        // What the level before needed is of no use to others.
        if let Some(replaced) = replaced
            && self.paths.iter().all(|path| path.settings != replaced)
        {
            self.lights.retain(|light| light.settings() != replaced);
        }
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
