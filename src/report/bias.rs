//! Bias of techniques, by unbiased oracle estimates at pixels of a few frames.

use super::baked_cache::BakedCache;
use super::inputs::Inputs;
use super::measure::renderer;
use super::progress::Progress;
use super::technique::Technique;
use crate::input::{GlobalIllumination, Mode, Samples, Settings};
use crate::metrics::{BiasCheck, Estimate, HeldOutPixel};
use crate::render::Renderer;
use crate::sampling::Random;
use glam::Vec3;
use serde::Serialize;
use std::collections::BTreeSet;

/// Pixels of each frame.
const PIXELS: usize = 1000;

/// Paths of each of the two oracle estimates of a pixel.
pub(super) const ORACLE_PATHS: u32 = 512;

/// Seeds from here on are the oracle's alone, so that its noise is independent.
const SEED: u32 = 3 << 24;

/// The bias of a technique.
#[derive(Clone, Debug, Serialize)]
pub struct BiasRow {
    /// The curve of the technique.
    pub curve: &'static str,
    /// The flags that select it.
    pub flags: String,
    /// Columns and rows of the frames.
    pub size: (u32, u32),
    /// How many pixels were compared.
    pub pixels: usize,
    /// The part of its relMSE that averaging does not remove.
    pub squared_bias: Estimate,
    /// The mean error, relative to the mean of the oracle: above 0 if the technique is too bright.
    pub mean_bias: Estimate,
    /// Whether noise does not explain these.
    pub is_biased: bool,
}

/// Checks one technique of each curve.
///
/// Both pictures of a technique that uses the irradiance cache share it: the cache error is part of the squared bias.
pub(super) fn bias(
    inputs: &Inputs,
    cache: &BakedCache,
    techniques: &[Technique],
    progress: &mut Progress,
) -> Vec<BiasRow> {
    let full_size = HeldOut::new(inputs, inputs.full_size(), progress);
    let small = HeldOut::new(inputs, inputs.size, progress);
    let checked = techniques.iter().filter(|technique| technique.is_checked);
    let check = |technique: &Technique| match needs_frames(technique) {
        true => small.check(inputs, cache, technique, progress),
        false => full_size.check(inputs, cache, technique, progress),
    };
    checked.map(check).collect()
}

/// Adaptive sampling depends on all pixels of a frame: the frame is rendered whole, and small.
fn needs_frames(technique: &Technique) -> bool {
    technique.target().is_some()
}

/// The techniques that are biased, in one sentence; none if there are none.
pub(super) fn advice(rows: &[BiasRow]) -> Option<String> {
    let biased = rows.iter().filter(|row| row.is_biased);
    let names: Vec<&str> = biased.map(|row| row.curve).collect();
    (!names.is_empty()).then(|| {
        format!(
            "Biased, which their relMSE includes and more samples do not remove: {}.",
            names.join("; ")
        )
    })
}

/// About how many paths the check traces, for the progress.
pub(super) fn work(inputs: &Inputs, techniques: &[Technique]) -> f64 {
    let checked = techniques.iter().filter(|technique| technique.is_checked);
    let of_frame = checked.map(|technique| work_of_picture(inputs, technique));
    let oracles = 2.0 * f64::from(2 * ORACLE_PATHS) * PIXELS as f64;
    (2.0 * of_frame.sum::<f64>() + oracles) * inputs.frames.len() as f64
}

/// The paths of one picture of one frame.
fn work_of_picture(inputs: &Inputs, technique: &Technique) -> f64 {
    let (width, height) = inputs.size;
    technique.paths()
        * match needs_frames(technique) {
            true => f64::from(width * height),
            false => PIXELS as f64,
        }
}

/// Pixels of some frames, and two independent oracle estimates of each.
struct HeldOut {
    size: (u32, u32),
    frames: Vec<HeldOutFrame>,
}

struct HeldOutFrame {
    frame: u32,
    pixels: Vec<(u32, u32)>,
    /// Two independent estimates of each.
    oracle: Vec<[Vec3; 2]>,
}

impl HeldOut {
    /// Chooses random pixels of frames of a size, and estimates them.
    fn new(inputs: &Inputs, size: (u32, u32), progress: &mut Progress) -> HeldOut {
        progress.begin("oracle");
        let settings = Settings {
            mode: Some(Mode::Montecarlo),
            gi: Some(GlobalIllumination::PathTraced),
            size: Some(size),
            samples: Some(Samples::Spread(2 * ORACLE_PATHS)),
            splits: Some(vec![1]),
            seed: Some(SEED),
            target_error: None,
            ..inputs.given.clone()
        };
        let settings = inputs.resolve(&settings);
        let renderer = Renderer::new(inputs.scene, settings, None).expect("needs no cache");
        let mut random = Random::new(SEED.into());
        let frames = inputs.frames.iter().map(|&frame| {
            let pixel = |_| {
                let [x, y] = [size.0, size.1].map(|size| random.below(size as usize) as u32);
                (x, y)
            };
            // No pixel twice, where there are enough.
            let pixels: BTreeSet<(u32, u32)> = (0..PIXELS).map(pixel).collect();
            let pixels: Vec<(u32, u32)> = pixels.into_iter().collect();
            let camera = inputs.path.camera(frame);
            let oracle = renderer.render_pixels(&camera, frame, &pixels);
            progress.step(f64::from(2 * ORACLE_PATHS) * PIXELS as f64);
            HeldOutFrame {
                frame,
                pixels,
                oracle,
            }
        });
        HeldOut {
            size,
            frames: frames.collect(),
        }
    }

    /// Compares a technique with the oracle.
    fn check(
        &self,
        inputs: &Inputs,
        cache: &BakedCache,
        technique: &Technique,
        progress: &mut Progress,
    ) -> BiasRow {
        progress.begin(technique.curve);
        let mut held_out = Vec::new();
        let seeds = [0, 1].map(|seed| renderer(inputs, cache, technique, self.size, seed));
        for frame in &self.frames {
            let [first, second] = seeds
                .each_ref()
                .map(|renderer| frame.picture(inputs, technique, renderer));
            let both = first.into_iter().zip(second).zip(&frame.oracle);
            held_out.extend(both.map(|((c1, c2), oracle)| HeldOutPixel {
                technique: [c1, c2],
                oracle: *oracle,
            }));
            progress.step(2.0 * work_of_picture(inputs, technique));
        }
        let check = BiasCheck::of(&held_out, inputs.exposure());
        BiasRow {
            curve: technique.curve,
            flags: technique.flags(),
            size: self.size,
            pixels: check.pixels,
            squared_bias: check.squared_bias,
            mean_bias: check.mean_bias,
            is_biased: check.is_biased(),
        }
    }
}

impl HeldOutFrame {
    /// The pixels as a technique renders them.
    fn picture(&self, inputs: &Inputs, technique: &Technique, renderer: &Renderer) -> Vec<Vec3> {
        let camera = inputs.path.camera(self.frame);
        if needs_frames(technique) {
            let film = renderer.render_frame(&camera, self.frame).film;
            let pixel = |&(x, y): &(u32, u32)| film.pixels()[(y * film.width() + x) as usize];
            return self.pixels.iter().map(pixel).collect();
        }
        let halves = renderer.render_pixels(&camera, self.frame, &self.pixels);
        halves.into_iter().map(|[a, b]| 0.5 * (a + b)).collect()
    }
}
