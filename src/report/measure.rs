//! Time and error of a technique against the references.

use super::baked_cache::BakedCache;
use super::inputs::{Inputs, pixels};
use super::progress::Progress;
use super::seconds::Seconds;
use super::technique::Technique;
use crate::film::Film;
use crate::input::Settings;
use crate::metrics::{Estimate, ImageError, Reference, mean};
use crate::render::Renderer;
use serde::Serialize;

/// Cost and error of a technique: means over frames and seeds.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// The curve that it belongs to.
    pub curve: &'static str,
    /// The flags that select it.
    pub flags: String,
    /// Whether it renders indirect diffuse light, as the references do.
    pub has_indirect: bool,
    /// Columns and rows.
    pub size: (u32, u32),
    /// Seconds per frame.
    pub seconds: f64,
    /// CPU seconds per frame, of all threads together.
    pub cpu_seconds: f64,
    /// A frame's part of the seconds that baking the irradiance cache takes; 0 where it is not used.
    pub bake_seconds: f64,
    /// Seconds per frame of the sequence's own size: in proportion to the pixels, with the part of the cache.
    pub full_size_seconds: f64,
    /// Rays per frame.
    pub rays: f64,
    /// Rays per second.
    pub rays_per_second: f64,
    /// The root of the mean square error, in units of display white.
    pub rmse: f64,
    /// relMSE, as [`ImageError::rel_mse`] defines it.
    pub rel_mse: f64,
    /// The least and the largest relMSE of a seed.
    pub spread: [f64; 2],
    /// relMSE as the frames estimate it, without a reference: of direct light alone, that of direct light alone.
    pub own_estimate: f64,
    /// The 95th percentile of the relative errors.
    pub p95_relative_error: f64,
    /// The mean error relative to the mean of the reference: above 0 if the frames are too bright.
    pub mean_bias: f64,
    /// The 95 % confidence interval of that, with the noise of seeds and references.
    pub mean_bias_interval: [f64; 2],
    /// Mean FLIP of the displayed pictures.
    pub flip: f64,
}

impl Measurement {
    /// The error that the frames claim over the one that is measured; none where that is in the noise of the references.
    pub(super) fn claimed(&self) -> Option<f64> {
        (self.spread[0] > 0.0).then(|| self.own_estimate / self.rel_mse)
    }
}

/// The cost and the error of one rendering.
struct Run {
    seconds: Seconds,
    rays: u64,
    estimated: f64,
    error: ImageError,
}

/// Measures a technique on frames against their references; gives its first picture, too.
pub(super) fn measure(
    inputs: &Inputs,
    cache: &BakedCache,
    technique: &Technique,
    references: &[(u32, Reference)],
    progress: &mut Progress,
) -> (Measurement, Film) {
    progress.begin(technique.curve);
    let size = inputs.size;
    let mut picture = None;
    let mut runs = Vec::new();
    let mut by_seed = Vec::new();
    let mut bias_by_seed = Vec::new();
    for seed in 0..inputs.seeds {
        let (mut errors, mut biases) = (Vec::new(), Vec::new());
        let renderer = renderer(inputs, cache, technique, size, seed);
        for (frame, reference) in references {
            let camera = inputs.path.camera(*frame);
            let (rendering, seconds) = Seconds::of(|| renderer.render_frame(&camera, *frame));
            let error = ImageError::of(&rendering.film, reference, inputs.exposure());
            errors.push(error.rel_mse);
            biases.push(error.mean_bias);
            runs.push(Run {
                seconds,
                rays: rendering.rays,
                estimated: rendering.error.whole.rel_mse,
                error,
            });
            picture.get_or_insert(rendering.film);
            progress.step(technique.paths() * pixels(size));
        }
        by_seed.push(mean(&errors));
        bias_by_seed.push(mean(&biases));
    }
    let picture = picture.expect("a frame and a seed");
    let over = |of: &dyn Fn(&Run) -> f64| mean(&runs.iter().map(of).collect::<Vec<f64>>());
    let seconds = over(&|run| run.seconds.wall);
    let rays = over(&|run| run.rays as f64);
    let mut mean_bias = Estimate::of(&bias_by_seed);
    let variances = references.iter().map(|(_, r)| r.error_of_mean().powi(2));
    let of_references = variances.sum::<f64>().sqrt() / references.len() as f64;
    mean_bias.error = mean_bias.error.hypot(of_references);
    let bake_seconds = match technique.uses_cache() {
        true => cache.bake.seconds_per_frame(),
        false => 0.0,
    };
    let measurement = Measurement {
        curve: technique.curve,
        flags: technique.flags(),
        has_indirect: technique.has_indirect(),
        size,
        seconds,
        cpu_seconds: over(&|run| run.seconds.cpu),
        bake_seconds,
        full_size_seconds: seconds * pixels(inputs.full_size()) / pixels(size) + bake_seconds,
        rays,
        rays_per_second: rays / seconds,
        rmse: over(&|run| run.error.mse).max(0.0).sqrt(),
        rel_mse: mean(&by_seed),
        spread: [
            by_seed.iter().copied().fold(f64::INFINITY, f64::min),
            by_seed.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ],
        own_estimate: over(&|run| run.estimated),
        p95_relative_error: over(&|run| run.error.p95_relative_error),
        mean_bias: mean_bias.mean,
        mean_bias_interval: mean_bias.interval(inputs.seeds - 1),
        flip: over(&|run| run.error.flip),
    };
    (measurement, picture)
}

/// A renderer of a technique's frames.
pub(super) fn renderer<'a>(
    inputs: &Inputs<'a>,
    cache: &'a BakedCache,
    technique: &Technique,
    size: (u32, u32),
    seed: u32,
) -> Renderer<'a> {
    let of_frames = Settings {
        size: Some(size),
        seed: Some(seed),
        ..technique.settings.clone()
    };
    // Samples are the technique's alone, whatever the files set.
    let given = Settings {
        samples: None,
        splits: None,
        target_error: None,
        ..inputs.given.clone()
    };
    cache.renderer(inputs, inputs.resolve(&of_frames.or(given)))
}
