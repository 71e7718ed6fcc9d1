use super::{Inputs, Progress};
use crate::film::Film;
use crate::input::{Mode, Settings};
use crate::metrics::{Estimate, mean};
use crate::render::{RenderSettings, Reprojection, TILE, render_pixels};
use serde::Serialize;

/// Pairs of frames, spread over the path.
const PAIRS: u32 = 8;

/// About so many squares of [`TILE`] x [`TILE`] pixels of each pair are looked at.
const TILES: u32 = 40;

/// Nothing else has these seeds.
const SEED: u32 = 5 << 24;

/// Paths of a pixel that flickers.
pub(super) const PATHS: u32 = 32;

/// Paths of each half of what tells how much.
const REFERENCE_PATHS: u32 = 512;

/// How much the noise of a frame and the next differs at the same points of the scene.
#[derive(Clone, Debug, Serialize)]
pub struct FlickerRow {
    /// The first of the two frames.
    pub frame: u32,
    /// Which random numbers frames have.
    pub seeds: &'static str,
    /// Typical change, as a share of the light, that neither motion nor interpolation explains.
    pub relative: f64,
    /// The square of that, not rounded up to 0.
    pub square: Estimate,
    /// The share of the pixels that see what the other frame sees, too.
    pub matched: f64,
}

/// Of frames with numbers of their own, and of frames that all have the same.
pub(super) const SEEDS: [&str; 2] = ["new seed in each frame", "locked seed"];

/// Measures pairs of frames of the sequence's own size.
pub(super) fn flicker(inputs: &Inputs, progress: &mut Progress) -> Vec<FlickerRow> {
    progress.begin("flicker");
    let mut rows = Vec::new();
    for frame in pairs(inputs.path.timeline().frame_count()) {
        let pair = Pair::new(inputs, frame);
        let settings = |samples: u32, seed: u32| {
            let settings = Settings {
                mode: Some(Mode::Montecarlo),
                samples: Some(samples),
                splits: Some(vec![1]),
                seed: Some(seed),
                // The numbers of both kinds are given with the frames.
                lock_seed: Some(false),
                target_error: None,
                ..inputs.given.clone()
            };
            settings.resolve()
        };
        let references = pair.halves(&settings(2 * REFERENCE_PATHS, SEED), [frame, frame + 1]);
        for (seeds, numbers) in SEEDS.into_iter().zip([[frame, frame + 1], [0, 0]]) {
            let of_picture = settings(PATHS, 0);
            let [a, b] = pair.halves(&of_picture, numbers);
            let picture = [0, 1].map(|i| a[i].mixed(0.5, &b[i], 0.5));
            let [a, b] = &references;
            let white = of_picture.white;
            let flicker =
                pair.reprojection
                    .flicker(picture.each_ref(), a.each_ref(), b.each_ref(), white);
            rows.push(FlickerRow {
                frame,
                seeds,
                relative: flicker.relative,
                square: Estimate {
                    mean: flicker.square,
                    error: flicker.standard_error,
                },
                matched: flicker.matched,
            });
        }
        progress.step(work_of_pair());
    }
    rows
}

/// What the pairs say of the seeds, in words; none if there are none.
pub(super) fn advice(rows: &[FlickerRow]) -> Option<String> {
    let of = |seeds: &str| -> Vec<&FlickerRow> {
        rows.iter().filter(|row| row.seeds == seeds).collect()
    };
    let [new, locked] = SEEDS.map(of);
    let typical = |rows: &[&FlickerRow]| {
        let squares: Vec<f64> = rows.iter().map(|row| row.square.mean).collect();
        mean(&squares).max(0.0).sqrt()
    };
    // Pair by pair, as both have the same references.
    let less = new
        .iter()
        .zip(&locked)
        .map(|(new, locked)| new.square.mean - locked.square.mean);
    let less = Estimate::of(&less.collect::<Vec<f64>>());
    let [low, high] = less.interval((new.len() as u32).saturating_sub(1));
    let advice = match new.len() {
        0 => return None,
        1 => "",
        _ if low > 0.0 => ": `--lock-seed` flickers less",
        _ if high < 0.0 => ": `--lock-seed` flickers more",
        _ => ": no difference that is sure",
    };
    let [new, locked] = [&new, &locked].map(|rows| 100.0 * typical(rows));
    Some(format!(
        "Flicker with {PATHS} paths: {new:.1} % with a new seed in each frame, {locked:.1} % with a locked one{advice}."
    ))
}

/// About how many paths it takes, for a forecast.
pub(super) fn work(frames: u32) -> f64 {
    pairs(frames).len() as f64 * work_of_pair()
}

fn work_of_pair() -> f64 {
    // Two frames of a pair; two kinds of seeds, and the two halves of the reference.
    f64::from(2 * TILES * TILE * TILE * 2 * (PATHS + REFERENCE_PATHS))
}

fn pairs(frames: u32) -> Vec<u32> {
    let count = PAIRS.min(frames - 1);
    let pair =
        |i: u32| (u64::from(2 * i + 1) * u64::from(frames - 1) / u64::from(2 * count)) as u32;
    (0..count).map(pair).collect()
}

/// Two frames, of which some pixels are worked out.
struct Pair<'a> {
    inputs: &'a Inputs<'a>,
    frame: u32,
    reprojection: Reprojection,
    /// The pixels of each.
    pixels: [Vec<(u32, u32)>; 2],
}

impl Pair<'_> {
    fn new<'a>(inputs: &'a Inputs<'a>, frame: u32) -> Pair<'a> {
        let (width, height) = inputs.full_size();
        let [from, to] = [frame, frame + 1].map(|frame| inputs.path.camera(frame));
        let mut reprojection = Reprojection::new(inputs.scene, &from, &to, width, height);
        reprojection.thin(TILES);
        let matches = reprojection.matches();
        let mut later: Vec<usize> = matches.iter().map(|of| of.pixel).collect();
        let taps = matches.iter().flat_map(|of| reprojection.taps(of));
        let mut earlier: Vec<usize> = taps.map(|(pixel, _)| pixel).collect();
        let place = |pixel: usize| ((pixel as u32) % width, (pixel as u32) / width);
        let pixels = [&mut earlier, &mut later].map(|pixels| {
            pixels.sort_unstable();
            pixels.dedup();
            pixels.iter().copied().map(place).collect()
        });
        Pair {
            inputs,
            frame,
            reprojection,
            pixels,
        }
    }

    /// Both halves of both frames, which take the random numbers of the frames given.
    fn halves(&self, settings: &RenderSettings, numbers: [u32; 2]) -> [[Film; 2]; 2] {
        let (width, height) = self.inputs.full_size();
        let both = [0, 1].map(|i| {
            let camera = self.inputs.path.camera(self.frame + i as u32);
            let scene = self.inputs.scene;
            let values = render_pixels(scene, &camera, settings, numbers[i], &self.pixels[i]);
            [0, 1].map(|half| {
                let mut film = Film::new(width, height);
                for ((x, y), value) in self.pixels[i].iter().zip(&values) {
                    film.pixels_mut()[(y * width + x) as usize] = value[half];
                }
                film
            })
        });
        let [[first_a, first_b], [second_a, second_b]] = both;
        [[first_a, second_a], [first_b, second_b]]
    }
}
