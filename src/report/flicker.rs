//! Flicker: the change of a surface point's radiance from a frame to the next, beyond that of the references, by
//! reprojection.

use super::baked_cache::BakedCache;
use super::inputs::Inputs;
use super::progress::Progress;
use super::technique::WITHOUT_PATHS;
use crate::film::Film;
use crate::input::{GlobalIllumination, Mode, Samples, Settings};
use crate::metrics::{Estimate, mean};
use crate::render::{Renderer, Reprojection, TILE};
use serde::Serialize;

/// Pairs of frames, spread over the path.
const PAIRS: u32 = 8;

/// About this many tiles of [`TILE`] x [`TILE`] pixels of each pair are compared.
const TILES: u32 = 40;

/// Seeds from here on are the references' alone, so that their noise is independent.
const SEED: u32 = 5 << 24;

/// Camera samples of each pixel; where indirect light is path-traced, with one path each.
pub(super) const PATHS: u32 = 32;

/// Camera samples of each half buffer of a reference.
const REFERENCE_PATHS: u32 = 512;

/// The flicker from a frame to the next.
#[derive(Clone, Debug, Serialize)]
pub struct FlickerRow {
    /// The first of the two frames.
    pub frame: u32,
    /// How the frames are rendered, in words.
    pub kind: &'static str,
    /// Root mean square of the change that neither motion nor interpolation explains, relative to the radiance.
    pub relative: f64,
    /// The mean of the squared change: noise may make its estimate negative.
    pub square: Estimate,
    /// The fraction of the pixels that see a point which the other frame sees, too.
    pub matched: f64,
}

/// Path-traced indirect light with a seed for each frame and with the same in all; the irradiance cache; and direct
/// light alone, whose flicker is left when indirect light has none.
pub(super) const KINDS: [&str; 4] = [
    "path-traced, new seed in each frame",
    "path-traced, locked seed",
    "irradiance cache",
    "direct light alone",
];

/// A frame and the next.
type TwoFrames = [Film; 2];

/// Measures pairs of frames of the sequence's own size.
pub(super) fn flicker(
    inputs: &Inputs,
    cache: &BakedCache,
    progress: &mut Progress,
) -> Vec<FlickerRow> {
    progress.begin("flicker");
    let renderer = |mode: Mode, gi: GlobalIllumination, samples: u32, seed: u32| {
        let settings = Settings {
            mode: Some(mode),
            gi: Some(gi),
            samples: Some(Samples::Spread(samples)),
            splits: Some(vec![1]),
            seed: Some(seed),
            // Which random numbers a frame takes is said when it is rendered.
            lock_seed: Some(false),
            target_error: None,
            ..inputs.given.clone()
        };
        cache.renderer(inputs, inputs.resolve(&settings))
    };
    let path_traced_of = |samples, seed| {
        renderer(
            Mode::Montecarlo,
            GlobalIllumination::PathTraced,
            samples,
            seed,
        )
    };
    let direct_of = |samples, seed| {
        renderer(
            Mode::Raytracing,
            GlobalIllumination::PathTraced,
            samples,
            seed,
        )
    };
    let path_traced = path_traced_of(PATHS, 0);
    let cached = renderer(Mode::Montecarlo, GlobalIllumination::Cached, PATHS, 0);
    let direct = direct_of(PATHS, 0);
    let references = path_traced_of(2 * REFERENCE_PATHS, SEED);
    let direct_references = [SEED, SEED + 1].map(|seed| direct_of(REFERENCE_PATHS, seed));
    let mut rows = Vec::new();
    for frame in pairs(inputs.path.timeline().frame_count()) {
        let pair = Pair::new(inputs, frame);
        let own = [frame, frame + 1];
        let mut add = |kind: &'static str, picture: TwoFrames, [a, b]: &[TwoFrames; 2]| {
            let [picture, a, b] = [&picture, a, b].map(TwoFrames::each_ref);
            let flicker =
                pair.reprojection
                    .flicker(picture, a, b, path_traced.settings().display_white);
            rows.push(FlickerRow {
                frame,
                kind,
                relative: flicker.relative,
                square: Estimate {
                    mean: flicker.square,
                    error: flicker.standard_error,
                },
                matched: flicker.matched,
            });
        };
        let [new, locked, cached_light, direct_light] = KINDS;
        let references = pair.halves(&references, own);
        add(new, pair.picture(&path_traced, own), &references);
        add(locked, pair.picture(&path_traced, [0, 0]), &references);
        add(cached_light, pair.picture(&cached, own), &references);

        // Ray tracing has no half buffers, so two seeds stand for them. The same indirect light is added to pictures
        // and references: it cancels, but flicker is then relative to all light.
        let direct_references = direct_references
            .each_ref()
            .map(|renderer| pair.picture(renderer, own));
        let rest = mixed(
            &mean_of(&references),
            &mean_of(&direct_references),
            [1.0, -1.0],
        );
        let with_rest = |films: TwoFrames| mixed(&films, &rest, [1.0, 1.0]);
        let picture = with_rest(pair.picture(&direct, own));
        add(direct_light, picture, &direct_references.map(with_rest));
        progress.step(work_of_pair());
    }
    rows
}

/// The flicker of each kind in words, and which differences are significant; nothing without pairs.
pub(super) fn advice(rows: &[FlickerRow]) -> Vec<String> {
    if rows.is_empty() {
        return Vec::new();
    }
    let squares = |kind: &str| -> Vec<f64> {
        let rows = rows.iter().filter(|row| row.kind == kind);
        rows.map(|row| row.square.mean).collect()
    };
    let kinds = KINDS.map(squares);
    let [new, locked, cached, direct] = &kinds;
    let typical = |squares: &Vec<f64>| 100.0 * mean(squares).max(0.0).sqrt();
    let [of_new, of_locked, of_cached, of_direct] = kinds.each_ref().map(typical);
    // Pair by pair: where one kind flickers more, all kinds do.
    let verdict = |flags: &str, squares: &[f64], others: &[f64]| {
        let more = squares.iter().zip(others).map(|(of, other)| of - other);
        let more: Vec<f64> = more.collect();
        let [low, high] = Estimate::of(&more).interval(more.len() as u32 - 1);
        if low > 0.0 {
            format!("`{flags}` flickers more")
        } else if high < 0.0 {
            format!("`{flags}` flickers less")
        } else {
            "no significant difference".to_owned()
        }
    };
    vec![
        format!(
            "Flicker with {PATHS} paths: {of_new:.1} % with a new seed in each frame, {of_locked:.1} % with a \
             locked one: {}.",
            verdict("--lock-seed", locked, new)
        ),
        format!(
            "Flicker with {PATHS} camera samples: {of_cached:.1} % with the irradiance cache, {of_direct:.1} % of \
             direct light alone: {}.",
            verdict("--gi cached", cached, direct)
        ),
    ]
}

/// About how many paths all pairs trace, for the progress.
pub(super) fn work(frames: u32) -> f64 {
    pairs(frames).len() as f64 * work_of_pair()
}

fn work_of_pair() -> f64 {
    // Two frames of a pair; two kinds that trace paths and two that do not, and references of both.
    f64::from(2 * TILES * TILE * TILE * 2 * (PATHS + REFERENCE_PATHS)) * (1.0 + WITHOUT_PATHS)
}

fn pairs(frames: u32) -> Vec<u32> {
    let count = PAIRS.min(frames - 1);
    let pair =
        |i: u32| (u64::from(2 * i + 1) * u64::from(frames - 1) / u64::from(2 * count)) as u32;
    (0..count).map(pair).collect()
}

/// Two consecutive frames, of which some pixels are rendered.
struct Pair<'a> {
    inputs: &'a Inputs<'a>,
    frame: u32,
    reprojection: Reprojection,
    /// The pixels of each frame.
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
        let position = |pixel: usize| ((pixel as u32) % width, (pixel as u32) / width);
        let pixels = [&mut earlier, &mut later].map(|pixels| {
            pixels.sort_unstable();
            pixels.dedup();
            pixels.iter().copied().map(position).collect()
        });
        Pair {
            inputs,
            frame,
            reprojection,
            pixels,
        }
    }

    /// Both frames, with the random numbers of the frames given.
    fn picture(&self, renderer: &Renderer, numbers: [u32; 2]) -> TwoFrames {
        mean_of(&self.halves(renderer, numbers))
    }

    /// The half buffers A and B, each of both frames.
    fn halves(&self, renderer: &Renderer, numbers: [u32; 2]) -> [TwoFrames; 2] {
        let (width, height) = self.inputs.full_size();
        let both = [0, 1].map(|i| {
            let camera = self.inputs.path.camera(self.frame + i as u32);
            let values = renderer.render_pixels(&camera, numbers[i], &self.pixels[i]);
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

/// The mean of two pictures, frame by frame.
fn mean_of([a, b]: &[TwoFrames; 2]) -> TwoFrames {
    mixed(a, b, [0.5, 0.5])
}

/// A weighted sum of two pictures, frame by frame.
fn mixed(of: &TwoFrames, other: &TwoFrames, weights: [f32; 2]) -> TwoFrames {
    [0, 1].map(|i| of[i].weighted_sum(weights[0], &other[i], weights[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_told_only_if_pairs_agree() {
        // The squares of each kind in three pairs.
        let squares = [
            [4e-4, 5e-4, 3e-4],
            [1e-4, 2e-4, 0.0],
            [1e-6, -1e-6, 0.0],
            [0.0, 0.0, 0.0],
        ];
        let row = |kind: &'static str, frame: u32, square: f64| FlickerRow {
            frame,
            kind,
            relative: square.max(0.0).sqrt(),
            square: Estimate {
                mean: square,
                error: 0.0,
            },
            matched: 1.0,
        };
        let of_kind = |(kind, squares): (&'static str, [f64; 3])| {
            (0..).zip(squares).map(move |(i, s)| row(kind, i, s))
        };
        let kinds = KINDS.into_iter().zip(squares);
        let rows: Vec<FlickerRow> = kinds.flat_map(of_kind).collect();
        let [seeds, cache] = &advice(&rows)[..] else {
            panic!("seeds and cache");
        };
        assert!(
            seeds.contains(": 2.0 % with a new seed in each frame, 1.0 % with a locked one: `--lock-seed` flickers less."),
            "{seeds}"
        );
        assert!(
            cache.contains(
                ": 0.0 % with the irradiance cache, 0.0 % of direct light alone: no significant"
            ),
            "{cache}"
        );
        assert!(advice(&[]).is_empty());
    }
}
