//! Validation of an irradiance cache: the cache error of each frame of a path, an unbiased estimate from held-out
//! pixels that are also path traced.

use crate::camera::CameraPath;
use crate::integrator::{IntegratorError, IntegratorSettings};
use crate::irradiance_cache::IrradianceCache;
use crate::metrics::{BiasCheck, Estimate, HeldOutPixel};
use crate::render::{
    ChosenPixel, ErrorEstimate, PixelSampling, RenderSettings, Renderer, hold_out,
};
use crate::sampling::SobolSequence;
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;

/// Pixels, of all frames together, at which the noise of the cache is looked at, and bounds of those of a frame.
const ALL_SURVEYED: u32 = 1 << 19;
const MIN_SURVEYED: u32 = 512;
const MAX_SURVEYED: u32 = 8192;

/// One pixel of this many in a sequence is held out.
const PIXELS_PER_HELD_OUT: u64 = 1 << 14;

/// Bounds of the number of held-out pixels.
const MIN_HELD_OUT: u64 = 1024;
const MAX_HELD_OUT: u64 = 4096;

/// Held-out pixels, in order of frames, that decide by how much the noise of the cache is multiplied to give its error.
const WINDOW: usize = 1024;

/// Paths of each of the two path-traced estimates of a pixel.
const PATHS: u32 = 256;

/// XORed with the seed, so that held-out pixels share no samples with frames or records.
const SEED: u32 = 7 << 24;

/// An error relative to the radiance that is expected where the cache has no noise: of what all its paths have missed.
const LEAST: f64 = 0.003;

/// A frame in the survey.
struct SurveyedFrame {
    /// The mean square of the noise that the cache shows, relative as the error.
    noise: f64,
    /// The errors at its held-out pixels, over the density of these: their expected value is the frame's error.
    errors: Vec<f64>,
}

/// The cache error of each frame of a path, a relative squared error; empty if there are no bounces. `settings` are those of
/// the frames, `cache` has their bounces.
///
/// Where a frame's pixels get error from is known from the noise of the cache: the difference between what each half of its
/// paths gives. What the error is, noise and all else, comes from held-out pixels, in this frame and those around it, chosen
/// where there is noise: the cached light c is compared with two independent path-traced estimates A and B, as the expected
/// value of (c - A)(c - B) is the squared error of c, whatever the noise of A and B. A frame's error is that of the frames
/// around it, times the ratio of their noise (a ratio estimate: Cochran 1977, "Sampling Techniques", chapter 6).
pub fn cache_errors(
    scene: &Scene,
    path: &CameraPath,
    settings: &RenderSettings,
    cache: &IrradianceCache,
) -> Result<Vec<ErrorEstimate>, IntegratorError> {
    let bounces = settings.integrator.bounces();
    if bounces == 0 {
        return Ok(Vec::new());
    }
    // One sample in the middle of each pixel: aliasing of edges is no error of the cache.
    let of_integrator = |integrator: IntegratorSettings, cache| {
        let settings = RenderSettings {
            integrator,
            sampling: PixelSampling::Center,
            seed: settings.seed ^ SEED,
            lock_seed: false,
            ..settings.clone()
        };
        Renderer::new(scene, settings, Some(cache))
    };
    let cached = || IntegratorSettings::Cached { bounces };
    let splits = vec![2 * PATHS];
    let path_traced = of_integrator(IntegratorSettings::PathTraced { bounces, splits }, cache)?;
    let [half_a, half_b] = cache.halves();
    let (half_a, half_b) = (
        of_integrator(cached(), &half_a)?,
        of_integrator(cached(), &half_b)?,
    );
    let frames = path.timeline().frame_count();
    let survey = Survey {
        path,
        halves: [&half_a, &half_b],
        path_traced: &path_traced,
        exposure: -libm::log2f(settings.display_white),
        surveyed: (ALL_SURVEYED / frames).clamp(MIN_SURVEYED, MAX_SURVEYED),
    };
    let all = u64::from(frames) * u64::from(settings.width) * u64::from(settings.height);
    let count = (all / PIXELS_PER_HELD_OUT).clamp(MIN_HELD_OUT, MAX_HELD_OUT);
    // Pixel i belongs to frame i * frames / count.
    let first = |frame: u32| (u64::from(frame) * count).div_ceil(frames.into());
    let of_frame = |frame: u32| survey.frame(frame, first(frame + 1) - first(frame));
    let surveyed: Vec<SurveyedFrame> = (0..frames).into_par_iter().map(of_frame).collect();
    Ok(errors(&surveyed))
}

/// The error of each frame.
fn errors(frames: &[SurveyedFrame]) -> Vec<ErrorEstimate> {
    // Each held-out pixel with the noise of its frame.
    let pixels = frames
        .iter()
        .flat_map(|frame| frame.errors.iter().map(|&e| (e, frame.noise)));
    let pixels: Vec<(f64, f64)> = pixels.collect();
    let window = WINDOW.min(pixels.len());
    let mut before = 0;
    let error = |frame: &SurveyedFrame| {
        let middle = before + frame.errors.len() / 2;
        before += frame.errors.len();
        let first = middle.saturating_sub(window / 2).min(pixels.len() - window);
        let pixels = &pixels[first..first + window];
        // Relative to the noise of their frames, so that one frame does not decide for all.
        let ratios: Vec<f64> = pixels.iter().map(|(error, noise)| error / noise).collect();
        let ratio = Estimate::of(&ratios);
        ErrorEstimate {
            rel_mse: (ratio.mean * frame.noise).max(0.0),
            standard_error: ratio.error * frame.noise,
        }
    };
    frames.iter().map(error).collect()
}

/// Looks at frames.
struct Survey<'a> {
    path: &'a CameraPath,
    /// By the halves of the cache.
    halves: [&'a Renderer<'a>; 2],
    path_traced: &'a Renderer<'a>,
    exposure: f32,
    /// Pixels per frame.
    surveyed: u32,
}

impl Survey<'_> {
    /// A frame with `count` held-out pixels.
    fn frame(&self, frame: u32, count: u64) -> SurveyedFrame {
        let settings = self.path_traced.settings();
        let (width, height) = (settings.width, settings.height);
        let camera = self.path.camera(frame);
        let positions = SobolSequence::new(settings.seed, frame, 0, 0);
        let pixel = |index: u32| {
            let [u, v] = positions.sample_2d(index, 0);
            let [x, y] = [(u, width), (v, height)].map(|(u, size)| (u * size as f32) as u32);
            (x.min(width - 1), y.min(height - 1))
        };
        let pixels: Vec<(u32, u32)> = (0..self.surveyed).map(pixel).collect();
        let [a, b] = self
            .halves
            .map(|half| half.render_pixels(&camera, frame, &pixels));
        let noise = a.iter().zip(&b).map(|([a, _], [b, _])| self.noise(*a, *b));
        let noise: Vec<f64> = noise.collect();
        let weights: Vec<f32> = noise.iter().map(|noise| noise.sqrt() as f32).collect();
        let start = positions.sample_1d(0, 1);
        let chosen = match count {
            0 => Vec::new(),
            _ => hold_out(&weights, |_| 1.0, count as f64, start),
        };
        let held_out: Vec<(u32, u32)> = chosen.iter().map(|chosen| pixels[chosen.pixel]).collect();
        let oracle = self.path_traced.render_pixels(&camera, frame, &held_out);
        let error = |(chosen, oracle): (&ChosenPixel, [Vec3; 2])| {
            let index = chosen.pixel;
            let technique = [0, 1].map(|half| 0.5 * (a[index][half] + b[index][half]));
            let check = BiasCheck::of(&[HeldOutPixel { technique, oracle }], self.exposure);
            let error = check.squared_bias.mean / chosen.density;
            std::iter::repeat_n(error, chosen.times as usize)
        };
        SurveyedFrame {
            noise: noise.iter().sum::<f64>() / noise.len() as f64,
            errors: chosen.iter().zip(oracle).flat_map(error).collect(),
        }
    }

    /// The square of half the difference between two values, relative as the error, and at least of what all paths may have
    /// missed.
    fn noise(&self, a: Vec3, b: Vec3) -> f64 {
        let pixel = HeldOutPixel {
            technique: [0.5 * (a + b); 2],
            oracle: [a, a],
        };
        let check = BiasCheck::of(&[pixel], self.exposure);
        check.squared_bias.mean + LEAST * LEAST
    }
}
