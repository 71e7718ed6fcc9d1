//! Works out the indirect light that a camera path needs, before its first frame.
//!
//! First the places are chosen, by geometry alone: what the frames see is covered with discs, smaller where
//! other surfaces are close; and so, more coarsely, is what can be seen from there. Then the light of each
//! place is gathered: of the coarse ones for one bounce, for two, and so on, each from the last; and with
//! these that of the fine ones. At last each place learns from its neighbours how light changes.
//!
//! All of it is a function of scene, path and settings: the same for any number of threads, and for whichever
//! frames are rendered with it.

mod candidates;
mod fit;
mod light;
mod order;
mod placement;

use crate::camera::CameraPath;
use crate::illumination::{Illumination, SecondaryLight, VisibleLight};
use crate::scene::Scene;
use candidates::{Film, candidates};
use light::{Gathering, Purpose};
use order::spread;
use placement::{Candidate, Density, Placement};
use std::sync::atomic::{AtomicUsize, Ordering};

/// What light is worked out for.
#[derive(Clone, Copy, Debug)]
pub struct BakeSettings {
    /// Columns of the frames.
    pub width: u32,
    /// Rows of the frames.
    pub height: u32,
    /// How many bounces are counted.
    pub bounces: u32,
    /// Chooses the random numbers.
    pub seed: u32,
}

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
const LEAST_PIXELS: [f32; 2] = [4.0, 10.0];

/// No secondary place is smaller than this share of the usual distance between surfaces.
const LEAST_SECONDARY: f32 = 0.4;

/// Paths from points of frames that no place is near.
pub const UNKNOWN_PATHS: u32 = 16;

/// Paths from each place that the camera sees.
const PATHS: u32 = 160;

/// Paths from each secondary place, for each number of bounces.
const SECONDARY_PATHS: u32 = 48;

/// How often what is seen from secondary places gets secondary places, too.
const ROUNDS: u32 = 8;

/// Is told how far the work is, of 1, and what is done now.
pub type Listener<'a> = &'a (dyn Fn(f64, &'static str) + Sync);

/// Works out the light for all frames of a path, on the threads of the current pool.
pub fn bake(
    scene: &Scene,
    path: &CameraPath,
    settings: &BakeSettings,
    listener: Listener,
) -> Illumination {
    let (visible, hits) = place_visible(scene, path, settings, listener);
    listener(0.3, "secondary places");
    let secondary = place_secondary(scene, settings, &visible, hits);
    listener(0.35, "secondary light");
    let mut known = SecondaryLight {
        nearest: secondary.least_radius(),
        places: secondary.places,
        levels: Vec::new(),
    };
    let gathering = |left, paths, purpose| Gathering {
        scene,
        left,
        paths,
        purpose,
        seed: settings.seed,
    };
    for left in 1..settings.bounces {
        let gathering = gathering(left, SECONDARY_PATHS, Purpose::SecondaryLight);
        let level = gathering.light(&secondary.points, &known, &|| ());
        known.levels.push(level);
    }
    let all: usize = visible.iter().map(|placement| placement.points.len()).sum();
    let done = AtomicUsize::new(0);
    let gathered = || {
        let before = done.fetch_add(1, Ordering::Relaxed);
        if before.is_multiple_of(256) {
            listener(0.5 + 0.5 * before as f64 / all as f64, "visible light");
        }
    };
    let light = |(left, placement): (u32, Placement)| {
        let gathering = gathering(left, PATHS, Purpose::VisibleLight);
        let light = gathering.light(&placement.points, &known, &gathered);
        let (places, order) = placement.places.settled(scene.bounds());
        let light: Vec<glam::Vec3> = order.iter().map(|n| light[*n as usize]).collect();
        VisibleLight {
            light: fit::fit(&places, &light),
            places,
        }
    };
    let visible = (1..).zip(visible).map(light).collect();
    Illumination {
        visible,
        secondary: known,
    }
}

/// Covers what all frames see, by the number of bounces left less 1. Also returns what is seen from there.
///
/// Frames come in an order that spreads them: the first ones cover most, and later ones fill in.
fn place_visible<'a>(
    scene: &'a Scene,
    path: &CameraPath,
    settings: &BakeSettings,
    listener: Listener,
) -> (Vec<Placement<'a>>, Vec<Candidate>) {
    let density = |left: u32| match left == settings.bounces {
        true => VISIBLE,
        false => MIRRORED,
    };
    let placement = |left| Placement::new(scene, density(left), settings.seed);
    let mut visible: Vec<Placement> = (1..=settings.bounces).map(placement).collect();
    let mut hits = Vec::new();
    if visible.is_empty() {
        return (visible, hits);
    }
    let frames = path.timeline().frame_count();
    for (turn, frame) in (0..).zip(spread(frames)) {
        listener(0.3 * f64::from(turn) / f64::from(frames), "visible places");
        let film = Film {
            scene,
            camera: path.camera(frame),
            settings,
            turn,
        };
        for (placement, seen) in visible.iter_mut().zip(candidates(&film)) {
            hits.extend(placement.cover(&seen));
        }
    }
    (visible, hits)
}

/// Covers what is seen from the visible places, and from there, and so on.
fn place_secondary<'a>(
    scene: &'a Scene,
    settings: &BakeSettings,
    visible: &[Placement],
    mut hits: Vec<Candidate>,
) -> Placement<'a> {
    let mut secondary = Placement::new(scene, SECONDARY, settings.seed);
    // Of one bounce nothing is looked up.
    if settings.bounces < 2 {
        return secondary;
    }
    let usual = visible.iter().rev().find_map(Placement::usual_distance);
    let least_radius = LEAST_SECONDARY * usual.unwrap_or(0.0);
    for _ in 0..ROUNDS {
        for hit in &mut hits {
            hit.least_radius = least_radius;
        }
        hits = secondary.cover(&hits);
    }
    secondary
}
