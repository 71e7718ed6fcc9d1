use super::measure::settings;
use super::technique::Technique;
use super::{Inputs, Progress};
use crate::input::{Mode, Settings};
use crate::metrics::{BiasCheck, HeldOutPixel};
use crate::render::{RenderSettings, render_pixels};
use crate::sampling::Random;
use glam::Vec3;
use serde::Serialize;
use std::collections::BTreeSet;

/// Pixels of each frame.
const PIXELS: usize = 1000;

/// Nothing else has these seeds.
const SEED: u32 = 3 << 24;

/// Whether a technique is right in the mean, by pixels of full-size frames that were held out.
#[derive(Clone, Debug, Serialize)]
pub struct BiasRow {
    /// The technique.
    pub curve: &'static str,
    /// What to write to get it.
    pub flags: String,
    /// What stays of its relMSE however many pictures are averaged, and the standard error of that.
    pub squared_bias: [f64; 2],
    /// How much too bright it is, as a share of the light, and the standard error of that.
    pub mean_bias: [f64; 2],
    /// Whether chance does not explain these.
    pub is_biased: bool,
    /// How many pixels were looked at.
    pub pixels: usize,
}

/// Pixels of some frames and what is right there, twice.
pub(super) struct HeldOut {
    frames: Vec<HeldOutFrame>,
}

struct HeldOutFrame {
    frame: u32,
    pixels: Vec<(u32, u32)>,
    /// Two independent estimates of each.
    oracle: Vec<[Vec3; 2]>,
}

impl HeldOut {
    /// Works out pixels, chosen by chance, of frames of the sequence's own size.
    pub(super) fn new(inputs: &Inputs, progress: &mut Progress) -> HeldOut {
        let (width, height) = inputs.full_size();
        let oracle = Settings {
            mode: Some(Mode::Montecarlo),
            samples: Some(ORACLE_SAMPLES),
            splits: Some(vec![1]),
            seed: Some(SEED),
            target_error: None,
            ..inputs.given.clone()
        };
        let oracle = oracle.resolve();
        let mut random = Random::new(SEED.into());
        let frames = inputs.frames.iter().map(|&frame| {
            let pixel = |_| {
                let [x, y] = [width, height].map(|size| random.below(size as usize) as u32);
                (x, y)
            };
            // No pixel twice, where there are enough.
            let pixels: BTreeSet<(u32, u32)> = (0..PIXELS).map(pixel).collect();
            let pixels: Vec<(u32, u32)> = pixels.into_iter().collect();
            let oracle = render(inputs, &oracle, frame, &pixels);
            progress.step(f64::from(ORACLE_SAMPLES) * pixels.len() as f64, "oracle");
            HeldOutFrame {
                frame,
                pixels,
                oracle,
            }
        });
        HeldOut {
            frames: frames.collect(),
        }
    }

    /// Holds a technique against them.
    pub(super) fn check(
        &self,
        inputs: &Inputs,
        technique: &Technique,
        progress: &mut Progress,
    ) -> BiasRow {
        let mut held_out = Vec::new();
        for HeldOutFrame {
            frame,
            pixels,
            oracle,
        } in &self.frames
        {
            let pictures = [0, 1].map(|seed| {
                let settings = settings(inputs, technique, inputs.full_size(), seed);
                let halves = render(inputs, &settings, *frame, pixels);
                halves.into_iter().map(|[a, b]| 0.5 * (a + b))
            });
            let [first, second] = pictures;
            let both = first.zip(second).zip(oracle);
            held_out.extend(both.map(|((c1, c2), oracle)| HeldOutPixel {
                technique: [c1, c2],
                oracle: *oracle,
            }));
            progress.step(
                2.0 * technique.paths() * pixels.len() as f64,
                technique.curve,
            );
        }
        let check = BiasCheck::of(&held_out, inputs.exposure());
        BiasRow {
            curve: technique.curve,
            flags: technique.flags(),
            squared_bias: [check.squared_bias.mean, check.squared_bias.error],
            mean_bias: [check.mean_bias.mean, check.mean_bias.error],
            is_biased: check.is_biased(),
            pixels: check.pixels,
        }
    }
}

/// Of each pixel of the oracle, in two halves.
const ORACLE_SAMPLES: u32 = 1024;

fn render(
    inputs: &Inputs,
    settings: &RenderSettings,
    frame: u32,
    pixels: &[(u32, u32)],
) -> Vec<[Vec3; 2]> {
    let camera = inputs.path.camera(frame);
    render_pixels(inputs.scene, &camera, settings, frame, pixels)
}

/// About how many paths the check takes, for a forecast.
pub(super) fn work(frames: usize, techniques: &[Technique]) -> f64 {
    let checked = techniques.iter().filter(|technique| technique.is_checked);
    let paths: f64 = checked.map(|technique| 2.0 * technique.paths()).sum();
    (paths + f64::from(ORACLE_SAMPLES)) * (frames * PIXELS) as f64
}
