use super::light::PathLight;
use super::technique::WITHOUT_PATHS;
use super::{Inputs, Progress};
use crate::film::Film;
use crate::input::{GlobalIllumination, Mode, Settings};
use crate::metrics::{Estimate, mean};
use crate::render::{Renderer, Reprojection, TILE};
use serde::Serialize;

/// Pairs of frames, spread over the path.
const PAIRS: u32 = 8;

/// About so many squares of [`TILE`] x [`TILE`] pixels of each pair are looked at.
const TILES: u32 = 40;

/// Nothing else has these seeds.
const SEED: u32 = 5 << 24;

/// Camera samples of a pixel that flickers; in exact light, of one path each.
pub(super) const PATHS: u32 = 32;

/// Of each half of what tells how much.
const REFERENCE_PATHS: u32 = 512;

/// How much the noise of a frame and the next differs at the same points of the scene.
#[derive(Clone, Debug, Serialize)]
pub struct FlickerRow {
    /// The first of the two frames.
    pub frame: u32,
    /// How the frames are made, in words.
    pub kind: &'static str,
    /// Typical change, as a share of the light, that neither motion nor interpolation explains.
    pub relative: f64,
    /// The square of that, not rounded up to 0.
    pub square: Estimate,
    /// The share of the pixels that see what the other frame sees, too.
    pub matched: f64,
}

/// Exact light with numbers of each frame's own and with the same in all, light of the path, and no light but
/// what comes from lamps and mirrors: what flickers of that is left when nothing else does.
pub(super) const KINDS: [&str; 4] = [
    "exact, new seed in each frame",
    "exact, locked seed",
    "light of the path",
    "direct light alone",
];

/// A frame and the next.
type TwoFrames = [Film; 2];

/// Measures pairs of frames of the sequence's own size.
pub(super) fn flicker(
    inputs: &Inputs,
    light: &PathLight,
    progress: &mut Progress,
) -> Vec<FlickerRow> {
    progress.begin("flicker");
    let renderer = |mode: Mode, gi: GlobalIllumination, samples: u32, seed: u32| {
        let settings = Settings {
            mode: Some(mode),
            gi: Some(gi),
            samples: Some(samples),
            splits: Some(vec![1]),
            seed: Some(seed),
            // The numbers of all kinds are given with the frames.
            lock_seed: Some(false),
            target_error: None,
            ..inputs.given.clone()
        };
        light.renderer(inputs, inputs.resolve(&settings))
    };
    let exact_of = |samples, seed| {
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
    let exact = exact_of(PATHS, 0);
    let path = renderer(Mode::Montecarlo, GlobalIllumination::Cached, PATHS, 0);
    let direct = direct_of(PATHS, 0);
    let references = exact_of(2 * REFERENCE_PATHS, SEED);
    let direct_references = [SEED, SEED + 1].map(|seed| direct_of(REFERENCE_PATHS, seed));
    let mut rows = Vec::new();
    for frame in pairs(inputs.path.timeline().frame_count()) {
        let pair = Pair::new(inputs, frame);
        let own = [frame, frame + 1];
        let mut add = |kind: &'static str, picture: TwoFrames, [a, b]: &[TwoFrames; 2]| {
            let [picture, a, b] = [&picture, a, b].map(TwoFrames::each_ref);
            let flicker = pair
                .reprojection
                .flicker(picture, a, b, exact.settings().display_white);
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
        let [new, locked, looked_up, lamps] = KINDS;
        let references = pair.halves(&references, own);
        add(new, pair.picture(&exact, own), &references);
        add(locked, pair.picture(&exact, [0, 0]), &references);
        add(looked_up, pair.picture(&path, own), &references);

        // Without chance there are no halves. What direct light lacks is added to picture and references alike:
        // it cancels, but for being a part of the light that the flicker is a share of.
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
        add(lamps, picture, &direct_references.map(with_rest));
        progress.step(work_of_pair());
    }
    rows
}

/// What the pairs say of the kinds, in words; nothing if there are none.
pub(super) fn advice(rows: &[FlickerRow]) -> Vec<String> {
    if rows.is_empty() {
        return Vec::new();
    }
    let squares = |kind: &str| -> Vec<f64> {
        let rows = rows.iter().filter(|row| row.kind == kind);
        rows.map(|row| row.square.mean).collect()
    };
    let kinds = KINDS.map(squares);
    let [new, locked, path, direct] = &kinds;
    let typical = |squares: &Vec<f64>| 100.0 * mean(squares).max(0.0).sqrt();
    let [of_new, of_locked, of_path, of_direct] = kinds.each_ref().map(typical);
    // Pair by pair, as what one shows more of it shows of all kinds.
    let verdict = |flags: &str, squares: &[f64], others: &[f64]| {
        let more = squares.iter().zip(others).map(|(of, other)| of - other);
        let more: Vec<f64> = more.collect();
        let [low, high] = Estimate::of(&more).interval(more.len() as u32 - 1);
        if low > 0.0 {
            format!("`{flags}` flickers more")
        } else if high < 0.0 {
            format!("`{flags}` flickers less")
        } else {
            "no difference that is sure".to_owned()
        }
    };
    vec![
        format!(
            "Flicker with {PATHS} paths: {of_new:.1} % with a new seed in each frame, {of_locked:.1} % with a \
             locked one: {}.",
            verdict("--lock-seed", locked, new)
        ),
        format!(
            "Flicker with {PATHS} camera samples: {of_path:.1} % with light of the path, {of_direct:.1} % of \
             direct light alone: {}.",
            verdict("--gi cached", path, direct)
        ),
    ]
}

/// About how many paths it takes, for a forecast.
pub(super) fn work(frames: u32) -> f64 {
    pairs(frames).len() as f64 * work_of_pair()
}

fn work_of_pair() -> f64 {
    // Two frames of a pair; two kinds with paths and two without, and the two references of each of these.
    f64::from(2 * TILES * TILE * TILE * 2 * (PATHS + REFERENCE_PATHS)) * (1.0 + WITHOUT_PATHS)
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

    /// Both frames, which take the random numbers of the frames given.
    fn picture(&self, renderer: &Renderer, numbers: [u32; 2]) -> TwoFrames {
        mean_of(&self.halves(renderer, numbers))
    }

    /// Both halves of both frames.
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

/// Of two, frame by frame.
fn mean_of([a, b]: &[TwoFrames; 2]) -> TwoFrames {
    mixed(a, b, [0.5, 0.5])
}

/// Of two, so much of each, frame by frame.
fn mixed(of: &TwoFrames, other: &TwoFrames, shares: [f32; 2]) -> TwoFrames {
    [0, 1].map(|i| of[i].weighted_sum(shares[0], &other[i], shares[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_flickers_more_is_said_only_if_pairs_agree() {
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
        let [seeds, path] = &advice(&rows)[..] else {
            panic!("seeds and path");
        };
        assert!(
            seeds.contains(": 2.0 % with a new seed in each frame, 1.0 % with a locked one: `--lock-seed` flickers less."),
            "{seeds}"
        );
        assert!(
            path.contains(
                ": 0.0 % with light of the path, 0.0 % of direct light alone: no difference"
            ),
            "{path}"
        );
        assert!(advice(&[]).is_empty());
    }
}
