use super::Listener;
use super::candidates::{Film, candidates};
use super::fit::fit;
use super::gather::{Gathering, Purpose};
use super::order::spread;
use super::placement::{Candidate, Density, Placement};
use crate::camera::CameraPath;
use crate::integrator::FinalGather;
use crate::irradiance_cache::{
    IrradianceCache, IrradianceRecords, PrimaryIrradiance, SecondaryIrradiance,
};
use crate::render::ErrorEstimate;
use crate::scene::Scene;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// What the camera sees itself.
const VISIBLE: Density = Density {
    radius: 0.3,
    spacing: 0.7,
    angle: 20_f32.to_radians(),
    probes: 32,
};

/// What it sees in mirrors.
const MIRRORED: Density = Density {
    radius: 0.5,
    ..VISIBLE
};

/// What gathered rays hit.
const SECONDARY: Density = Density {
    radius: 0.7,
    spacing: 0.7,
    angle: 40_f32.to_radians(),
    probes: 32,
};

/// No place that the camera sees is smaller than so many pixels; in mirrors, which mostly show things smaller.
const LEAST_PIXELS: [f32; 2] = [6.0, 12.0];

/// No secondary place is smaller than this share of the usual distance between surfaces.
const LEAST_SECONDARY: f32 = 0.4;

/// Paths from all places that the camera sees: noise is what is left on even walls, and few places take little
/// time.
const PATHS: usize = 16_000_000;

/// But from each no fewer and no more.
const LEAST_PATHS: usize = 160;
const MOST_PATHS: usize = 480;

/// Paths from each secondary place, for each number of bounces.
const SECONDARY_PATHS: u32 = 32;

/// How often what is seen from secondary places gets secondary places, too.
const ROUNDS: u32 = 8;

/// The sizes of finer places, of the usual ones: each half as large as the next coarser.
fn scale(fineness: u32) -> f32 {
    0.7_f32.powi(fineness as i32)
}

/// The light of what some camera paths see, and what it takes to add more.
#[derive(Debug, Serialize, Deserialize)]
pub struct BakeState {
    fineness: u32,
    seed: u32,
    /// The names of the paths.
    paths: Vec<String>,
    /// How far off the light is, as far as that was measured since the last path was added.
    errors: Vec<KnownErrors>,
    /// By the number of bounces left, less 1.
    visible: Vec<Layer>,
    /// Its light is by the number of bounces left, less 1.
    secondary: Layer,
}

/// How far off the light is in the frames of a path.
#[derive(Debug, Serialize, Deserialize)]
struct KnownErrors {
    /// The path's name.
    path: String,
    /// The light that is displayed as white: errors are relative to it.
    white: f32,
    /// Frame by frame.
    errors: Vec<ErrorEstimate>,
}

/// IrradianceRecords and their light.
#[derive(Debug, Serialize, Deserialize)]
struct Layer {
    placement: Placement,
    /// IrradianceRecord by place, for one or more numbers of bounces left.
    light: Vec<Vec<Vec3>>,
}

impl Layer {
    fn new(scene: &Scene, density: Density, seed: u32, levels: u32) -> Layer {
        Layer {
            placement: Placement::new(scene, density, seed),
            light: vec![Vec::new(); levels as usize],
        }
    }

    /// IrradianceRecords and light in the order of look-ups.
    fn settled(&self) -> (IrradianceRecords, Vec<Vec<Vec3>>) {
        let (places, order) = self.placement.places.settled();
        let in_order = |light: &Vec<Vec3>| order.iter().map(|&number| light[number]).collect();
        (places, self.light.iter().map(in_order).collect())
    }
}

impl BakeState {
    /// Nothing is finer.
    pub const FINEST: u32 = 3;

    /// Of no path yet, where `bounces` bounces are counted. The fineness is 0 to [`BakeState::FINEST`]: each
    /// has twice as many places as the last, and twice as many paths from each of them.
    pub fn new(scene: &Scene, bounces: u32, seed: u32, fineness: u32) -> BakeState {
        let finer = |density: Density| Density {
            radius: density.radius * scale(fineness),
            ..density
        };
        let visible = |left: u32| {
            let density = if left == bounces { VISIBLE } else { MIRRORED };
            Layer::new(scene, finer(density), seed, 1)
        };
        BakeState {
            fineness,
            seed,
            paths: Vec::new(),
            errors: Vec::new(),
            visible: (1..=bounces).map(visible).collect(),
            secondary: Layer::new(scene, finer(SECONDARY), seed, bounces.saturating_sub(1)),
        }
    }

    /// How fine it is.
    pub fn fineness(&self) -> u32 {
        self.fineness
    }

    /// The names of the paths whose light it holds, in the order in which they were added.
    pub fn paths(&self) -> &[String] {
        &self.paths
    }

    /// Whether it holds the light of the path of this name.
    pub fn covers(&self, name: &str) -> bool {
        self.paths.iter().any(|path| path == name)
    }

    /// How far off it is in the frames of a path, if that is known for this white.
    pub fn errors(&self, name: &str, white: f32) -> Option<&[ErrorEstimate]> {
        let of_path = |known: &&KnownErrors| known.path == name && known.white == white;
        let known = self.errors.iter().find(of_path)?;
        Some(&known.errors)
    }

    /// Remembers how far off it is.
    pub(super) fn learn(&mut self, name: &str, white: f32, errors: &[ErrorEstimate]) {
        self.errors.push(KnownErrors {
            path: name.to_owned(),
            white,
            errors: errors.to_vec(),
        });
    }

    fn bounces(&self) -> u32 {
        self.visible.len() as u32
    }

    /// What can be looked up.
    pub fn illumination(&self) -> IrradianceCache {
        let visible = |layer: &Layer| {
            let (places, light) = layer.settled();
            PrimaryIrradiance {
                light: fit(&places, &light[0]),
                places,
            }
        };
        let (places, levels) = self.secondary.settled();
        IrradianceCache {
            visible: self.visible.iter().map(visible).collect(),
            secondary: SecondaryIrradiance {
                nearest: self.secondary.placement.least_radius(),
                places,
                levels,
            },
        }
    }

    /// Adds the light of a path, whose frames have `size` columns and rows.
    pub fn extend(
        &mut self,
        scene: &Scene,
        path: &CameraPath,
        name: &str,
        size: (u32, u32),
        listener: Listener,
    ) {
        let hits = self.place_visible(scene, path, size, listener);
        listener(0.3, "secondary places");
        self.place_secondary(scene, hits);
        listener(0.35, "secondary light");
        let final_gather = FinalGather::new(scene);
        let known = self.light_secondary(&final_gather);
        self.light_visible(&final_gather, &known, listener);
        self.paths.push(name.to_owned());
        self.errors.clear();
    }

    /// Covers what all frames see. Returns what is seen from there.
    ///
    /// Frames come in an order that spreads them: the first ones cover most, and later ones fill in.
    fn place_visible(
        &mut self,
        scene: &Scene,
        path: &CameraPath,
        size: (u32, u32),
        listener: Listener,
    ) -> Vec<Candidate> {
        let mut hits = Vec::new();
        if self.visible.is_empty() {
            return hits;
        }
        let frames = path.timeline().frame_count();
        let bounces = self.bounces();
        let scale = scale(self.fineness);
        for (turn, frame) in (0..).zip(spread(frames)) {
            listener(0.3 * f64::from(turn) / f64::from(frames), "visible places");
            let film = Film {
                scene,
                camera: path.camera(frame),
                size,
                bounces,
                least_pixels: LEAST_PIXELS.map(|pixels| scale * pixels),
                seed: self.seed,
                turn,
            };
            for (layer, seen) in self.visible.iter_mut().zip(candidates(&film)) {
                hits.extend(layer.placement.cover(scene, &seen));
            }
        }
        hits
    }

    /// Covers what is seen from visible places, from there, and so on.
    fn place_secondary(&mut self, scene: &Scene, mut hits: Vec<Candidate>) {
        // Of one bounce nothing is looked up.
        if self.bounces() < 2 {
            return;
        }
        let visible = self.visible.iter().rev();
        let usual = visible
            .map(|layer| &layer.placement)
            .find_map(Placement::usual_distance);
        let scale = scale(self.fineness);
        let least_radius = scale * LEAST_SECONDARY * usual.unwrap_or(0.0);
        for _ in 0..ROUNDS {
            for hit in &mut hits {
                hit.least_radius = least_radius;
            }
            hits = self.secondary.placement.cover(scene, &hits);
        }
    }

    /// Gathers the light of secondary places that have none yet, for one bounce, for two, and so on, each
    /// from the last.
    fn light_secondary(&mut self, final_gather: &FinalGather) -> SecondaryIrradiance {
        let Layer { placement, light } = &mut self.secondary;
        let (places, order) = placement.places.settled();
        let mut known = SecondaryIrradiance {
            nearest: placement.least_radius(),
            places,
            levels: Vec::new(),
        };
        for (left, level) in (1..).zip(light) {
            let gathering = Gathering {
                final_gather,
                left,
                paths: SECONDARY_PATHS << self.fineness,
                purpose: Purpose::SecondaryIrradiance,
                seed: self.seed,
            };
            let new = &placement.points[level.len()..];
            level.extend(gathering.light(new, &known, &|| ()));
            let in_order = order.iter().map(|&number| level[number]);
            known.levels.push(in_order.collect());
        }
        known
    }

    /// Gathers the light of visible places that have none yet.
    fn light_visible(
        &mut self,
        final_gather: &FinalGather,
        known: &SecondaryIrradiance,
        listener: Listener,
    ) {
        let missing = |layer: &Layer| layer.placement.points.len() - layer.light[0].len();
        let all: usize = self.visible.iter().map(missing).sum();
        let done = AtomicUsize::new(0);
        let gathered = || {
            let before = done.fetch_add(1, Ordering::Relaxed);
            if before.is_multiple_of(256) {
                listener(0.5 + 0.47 * before as f64 / all as f64, "visible light");
            }
        };
        let bounces = self.bounces();
        let paths = (PATHS / all.max(1)).clamp(LEAST_PATHS, MOST_PATHS) as u32;
        for (left, layer) in (1..).zip(&mut self.visible) {
            // What mirrors show is but a part of the light.
            let paths = if left < bounces { paths / 2 } else { paths };
            let gathering = Gathering {
                final_gather,
                left,
                paths: paths << self.fineness,
                purpose: Purpose::PrimaryIrradiance,
                seed: self.seed,
            };
            let light = &mut layer.light[0];
            let new = &layer.placement.points[light.len()..];
            light.extend(gathering.light(new, known, &gathered));
        }
    }
}
