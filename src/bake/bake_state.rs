//! The records of one or more camera paths and their values, as a file keeps them between runs.

use super::candidates::{FrameProbe, candidates};
use super::fit_gradients::fit_gradients;
use super::gather::{GatherPass, RandomStream};
use super::placement::{Candidate, Placement, Spacing};
use crate::camera::CameraPath;
use crate::integrator::FinalGather;
use crate::irradiance_cache::{
    IrradianceCache, IrradianceRecords, PrimaryIrradiance, SecondaryIrradiance,
};
use crate::render::ErrorEstimate;
use crate::sampling::van_der_corput_order;
use crate::scene::Scene;
use glam::Vec3;
use postcard::ser_flavors::Size;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Called with the progress, from 0 to 1, and the current stage.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// The part of the work that is done when the records are placed, when the secondary ones are gathered, and when all
/// are: about what the shipped scenes take.
const PLACED: f64 = 0.07;
const SECONDARY_GATHERED: f64 = 0.2;
pub(super) const GATHERED: f64 = 0.9;

/// Calls `report` with the part of `all` that is done, for some of the times that it is called.
fn counter(all: usize, report: impl Fn(f64) + Sync) -> impl Fn() + Sync {
    let done = AtomicUsize::new(0);
    move || {
        let before = done.fetch_add(1, Ordering::Relaxed);
        if before.is_multiple_of(256) {
            report(before as f64 / all as f64);
        }
    }
}

/// Of records that the camera sees directly.
const PRIMARY: Spacing = Spacing {
    relative_radius: 0.3,
    max_distance: 0.7,
    max_angle: 20_f32.to_radians(),
    probe_rays: 32,
};

/// Of records that it sees in mirrors.
const MIRRORED: Spacing = Spacing {
    relative_radius: 0.5,
    ..PRIMARY
};

/// Of records that gathered rays hit.
const SECONDARY: Spacing = Spacing {
    relative_radius: 0.7,
    max_distance: 0.7,
    max_angle: 40_f32.to_radians(),
    probe_rays: 32,
};

/// The smallest radius of primary records, in pixels (as Tabellion and Lamorlette 2004 bound radii): seen directly,
/// and in mirrors, which mostly show objects smaller.
const MIN_PIXELS: [f32; 2] = [6.0, 12.0];

/// The smallest radius of secondary records, relative to the median distance between surfaces.
const MIN_SECONDARY_RADIUS: f32 = 0.4;

/// Paths of all primary records together: few records get more paths each, at little cost, which lowers the noise
/// on large flat surfaces.
const TOTAL_PRIMARY_PATHS: usize = 16_000_000;

/// Bounds of paths per primary record, where there is little noise.
const MIN_PATHS: usize = 160;
const MAX_PATHS: usize = 480;

/// Paths per secondary record, for each number of bounces left, where there is little noise.
const SECONDARY_PATHS: u32 = 32;

/// The relative noise of records, at refinement level 0, above which all get more paths.
const PRIMARY_NOISE: f32 = 0.04;
const SECONDARY_NOISE: f32 = 0.15;

/// How many generations of secondary records are placed, each where the last one sees surfaces.
const GENERATIONS: u32 = 8;

/// The radius of records at a refinement level, relative to level 0: each level halves their area.
fn radius_scale(refinement_level: u32) -> f32 {
    0.7_f32.powi(refinement_level as i32)
}

/// The noise of records at a refinement level, relative to level 0: each has twice as many paths.
fn noise_scale(refinement_level: u32) -> f32 {
    0.5_f32.powf(0.5 * refinement_level as f32)
}

/// The irradiance records of some camera paths, and what it takes to add those of further paths.
#[derive(Debug, Serialize, Deserialize)]
pub struct BakeState {
    refinement_level: u32,
    seed: u32,
    /// The names of the camera paths.
    camera_paths: Vec<String>,
    /// Cache errors measured since the last path was added.
    errors: Vec<CameraPathErrors>,
    /// By the number of bounces left, less 1.
    primary: Vec<PlacedRecords>,
    /// Its values are by the number of bounces left, less 1.
    secondary: PlacedRecords,
}

/// The cache errors in the frames of a camera path.
#[derive(Debug, Serialize, Deserialize)]
struct CameraPathErrors {
    /// The name of the camera path.
    camera_path: String,
    /// The radiance that is displayed as white: errors are relative to it.
    display_white: f32,
    /// By frame.
    errors: Vec<ErrorEstimate>,
}

/// Records and their values.
#[derive(Debug, Serialize, Deserialize)]
struct PlacedRecords {
    placement: Placement,
    /// E / π in W/(sr m²), by number of bounces left, for one or more, and by record.
    values: Vec<Vec<Vec3>>,
}

impl PlacedRecords {
    fn new(scene: &Scene, spacing: Spacing, seed: u32, bounces: u32) -> PlacedRecords {
        PlacedRecords {
            placement: Placement::new(scene, spacing, seed),
            values: vec![Vec::new(); bounces as usize],
        }
    }

    /// Records and values in the order of [`IrradianceRecords::compacted`].
    fn compacted(&self) -> (IrradianceRecords, Vec<Vec<Vec3>>) {
        let (records, order) = self.placement.records.compacted();
        let in_order = |values: &Vec<Vec3>| order.iter().map(|&index| values[index]).collect();
        (records, self.values.iter().map(in_order).collect())
    }
}

impl BakeState {
    /// The highest refinement level.
    pub const MAX_REFINEMENT: u32 = 3;

    /// The state without records, where `bounces` bounces are counted. Each refinement level, from 0 to
    /// [`BakeState::MAX_REFINEMENT`], has twice as many records as the last and twice as many paths per record.
    pub fn new(scene: &Scene, bounces: u32, seed: u32, refinement_level: u32) -> BakeState {
        let refined = |spacing: Spacing| Spacing {
            relative_radius: spacing.relative_radius * radius_scale(refinement_level),
            ..spacing
        };
        let primary = |bounces_left: u32| {
            let spacing = if bounces_left == bounces {
                PRIMARY
            } else {
                MIRRORED
            };
            PlacedRecords::new(scene, refined(spacing), seed, 1)
        };
        BakeState {
            refinement_level,
            seed,
            camera_paths: Vec::new(),
            errors: Vec::new(),
            primary: (1..=bounces).map(primary).collect(),
            secondary: PlacedRecords::new(
                scene,
                refined(SECONDARY),
                seed,
                bounces.saturating_sub(1),
            ),
        }
    }

    /// The refinement level.
    pub fn refinement_level(&self) -> u32 {
        self.refinement_level
    }

    /// The names of the camera paths whose records it holds, in the order in which they were added.
    pub fn camera_paths(&self) -> &[String] {
        &self.camera_paths
    }

    /// Whether it holds the records of the path of this name.
    pub fn has_camera_path(&self, name: &str) -> bool {
        self.camera_paths.iter().any(|known| known == name)
    }

    /// The cache error of each frame of a path, if it was measured for this display white.
    pub fn errors(&self, name: &str, display_white: f32) -> Option<&[ErrorEstimate]> {
        let of_path = |errors: &&CameraPathErrors| {
            errors.camera_path == name && errors.display_white == display_white
        };
        let errors = self.errors.iter().find(of_path)?;
        Some(&errors.errors)
    }

    /// Stores the cache error of each frame of a path.
    pub(super) fn set_errors(&mut self, name: &str, display_white: f32, errors: &[ErrorEstimate]) {
        self.errors.push(CameraPathErrors {
            camera_path: name.to_owned(),
            display_white,
            errors: errors.to_vec(),
        });
    }

    fn bounces(&self) -> u32 {
        self.primary.len() as u32
    }

    /// The irradiance cache that frames use.
    pub fn irradiance_cache(&self) -> IrradianceCache {
        let primary = |placed: &PlacedRecords| {
            let (records, values) = placed.compacted();
            PrimaryIrradiance {
                values: fit_gradients(&records, &values[0]),
                records,
            }
        };
        let (records, values) = self.secondary.compacted();
        IrradianceCache {
            primary: self.primary.iter().map(primary).collect(),
            secondary: SecondaryIrradiance {
                min_distance: self.secondary.placement.min_radius(),
                records,
                values,
            },
        }
    }

    /// Bytes of the state in a file when the light is gathered and the errors of `frames` frames are measured.
    fn stored_bytes(&self, frames: u32) -> u64 {
        let now = postcard::serialize_with_flavor(self, Size::default());
        let records = |placed: &PlacedRecords| placed.placement.points.len();
        let placed = self.primary.iter().chain([&self.secondary]);
        let values = placed.map(|placed| {
            let gathered = placed.values.iter().map(Vec::len);
            gathered
                .map(|gathered| records(placed) - gathered)
                .sum::<usize>()
        });
        let values = values.sum::<usize>() * size_of::<Vec3>();
        let errors = frames as usize * size_of::<ErrorEstimate>();
        // Lengths and names.
        const REST: usize = 4096;
        (now.expect("plain data") + values + errors + REST) as u64
    }

    /// Adds the records of a path whose frames have `size` columns and rows. `reserve` is as that of [`super::bake`].
    pub fn add_camera_path<E>(
        &mut self,
        scene: &Scene,
        path: &CameraPath,
        name: &str,
        size: (u32, u32),
        listener: Listener,
        reserve: &mut impl FnMut(u64) -> Result<(), E>,
    ) -> Result<(), E> {
        let hits = self.place_primary(scene, path, size, listener);
        listener(PLACED, "secondary records");
        self.place_secondary(scene, hits);
        reserve(self.stored_bytes(path.timeline().frame_count()))?;
        let final_gather = FinalGather::new(scene);
        let secondary = self.gather_secondary(&final_gather, listener);
        self.gather_primary(&final_gather, &secondary, listener);
        self.camera_paths.push(name.to_owned());
        self.errors.clear();
        Ok(())
    }

    /// Covers what all frames see. Returns candidates for secondary records.
    ///
    /// Frames come in van der Corput order: the first ones, far apart, place most records, and later ones fill
    /// gaps.
    fn place_primary(
        &mut self,
        scene: &Scene,
        path: &CameraPath,
        size: (u32, u32),
        listener: Listener,
    ) -> Vec<Candidate> {
        let mut hits = Vec::new();
        if self.primary.is_empty() {
            return hits;
        }
        let frames = path.timeline().frame_count();
        let bounces = self.bounces();
        let scale = radius_scale(self.refinement_level);
        for (pass, frame) in (0..).zip(van_der_corput_order(frames)) {
            let progress = PLACED * f64::from(pass) / f64::from(frames);
            listener(progress, "primary records");
            let probe = FrameProbe {
                scene,
                camera: path.camera(frame),
                size,
                bounces,
                min_pixels: MIN_PIXELS.map(|pixels| scale * pixels),
                seed: self.seed,
                pass,
            };
            for (placed, seen) in self.primary.iter_mut().zip(candidates(&probe)) {
                hits.extend(placed.placement.place_until_covered(scene, &seen));
            }
        }
        hits
    }

    /// Covers what is seen from primary records, then what is seen from there, and so on.
    fn place_secondary(&mut self, scene: &Scene, mut hits: Vec<Candidate>) {
        // A single bounce needs no secondary records.
        if self.bounces() < 2 {
            return;
        }
        let primary = self.primary.iter().rev();
        let median = primary
            .map(|placed| &placed.placement)
            .find_map(Placement::median_distance);
        let scale = radius_scale(self.refinement_level);
        let min_radius = scale * MIN_SECONDARY_RADIUS * median.unwrap_or(0.0);
        for _ in 0..GENERATIONS {
            for hit in &mut hits {
                hit.min_radius = min_radius;
            }
            hits = self.secondary.placement.place_until_covered(scene, &hits);
        }
    }

    /// Gathers the values of secondary records that have none yet, for one bounce left, for two, and so on, each
    /// from the last.
    fn gather_secondary(
        &mut self,
        final_gather: &FinalGather,
        listener: Listener,
    ) -> SecondaryIrradiance {
        let PlacedRecords { placement, values } = &mut self.secondary;
        let missing = values
            .iter()
            .map(|values| placement.points.len() - values.len());
        let on_point = counter(missing.sum(), |part| {
            let progress = PLACED + (SECONDARY_GATHERED - PLACED) * part;
            listener(progress, "secondary irradiance");
        });
        let (records, order) = placement.records.compacted();
        let mut secondary = SecondaryIrradiance {
            min_distance: placement.min_radius(),
            records,
            values: Vec::new(),
        };
        for (bounces_left, values_of_bounce) in (1..).zip(values) {
            let gather_pass = GatherPass {
                final_gather,
                bounces_left,
                paths: SECONDARY_PATHS << self.refinement_level,
                noise: SECONDARY_NOISE * noise_scale(self.refinement_level),
                stream: RandomStream::Secondary,
                seed: self.seed,
            };
            let new = &placement.points[values_of_bounce.len()..];
            values_of_bounce.extend(gather_pass.mean_radiance(new, &secondary, &on_point));
            let in_order = order.iter().map(|&index| values_of_bounce[index]);
            secondary.values.push(in_order.collect());
        }
        secondary
    }

    /// Gathers the values of primary records that have none yet.
    fn gather_primary(
        &mut self,
        final_gather: &FinalGather,
        secondary: &SecondaryIrradiance,
        listener: Listener,
    ) {
        let missing =
            |placed: &PlacedRecords| placed.placement.points.len() - placed.values[0].len();
        let all: usize = self.primary.iter().map(missing).sum();
        let on_point = counter(all, |part| {
            let progress = SECONDARY_GATHERED + (GATHERED - SECONDARY_GATHERED) * part;
            listener(progress, "primary irradiance");
        });
        let bounces = self.bounces();
        let paths = (TOTAL_PRIMARY_PATHS / all.max(1)).clamp(MIN_PATHS, MAX_PATHS) as u32;
        for (bounces_left, placed) in (1..).zip(&mut self.primary) {
            // What is seen in mirrors contributes less to a pixel.
            let paths = if bounces_left < bounces {
                paths / 2
            } else {
                paths
            };
            let gather_pass = GatherPass {
                final_gather,
                bounces_left,
                paths: paths << self.refinement_level,
                noise: PRIMARY_NOISE * noise_scale(self.refinement_level),
                stream: RandomStream::Primary,
                seed: self.seed,
            };
            let values = &mut placed.values[0];
            let new = &placed.placement.points[values.len()..];
            values.extend(gather_pass.mean_radiance(new, secondary, &on_point));
        }
    }
}
