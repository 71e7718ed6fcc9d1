//! Validation of an irradiance cache: the cache error of each frame of a path, an unbiased estimate from held-out
//! pixels that are also path traced.

use crate::camera::CameraPath;
use crate::integrator::{IntegratorError, IntegratorSettings};
use crate::irradiance_cache::IrradianceCache;
use crate::metrics::{BiasCheck, HeldOutPixel};
use crate::render::{ErrorEstimate, PixelSampling, RenderSettings, Renderer};
use crate::sampling::SobolSequence;
use crate::scene::Scene;
use rayon::prelude::*;

/// One pixel of this many in a sequence is held out.
const PIXELS_PER_HELD_OUT: u64 = 1 << 14;

/// Bounds of the number of held-out pixels.
const MIN_HELD_OUT: u64 = 1024;
const MAX_HELD_OUT: u64 = 4096;

/// Held-out pixels, in order of frames, that a frame's error is estimated from.
const WINDOW: usize = 1024;

/// Paths of each of the two path-traced estimates of a pixel.
const PATHS: u32 = 256;

/// XORed with the seed, so that held-out pixels share no samples with frames or records.
const SEED: u32 = 7 << 24;

/// The cache error of each frame of a path, a relative squared error from held-out pixels of this frame and those
/// around it; empty if there are no bounces. `settings` are those of the frames, `cache` has their bounces.
///
/// At each held-out pixel the cached light c is compared with two independent path-traced estimates A and B:
/// the expected value of (c - A)(c - B) is the squared error of c, whatever the noise of A and B.
pub fn cache_errors(
    scene: &Scene,
    path: &CameraPath,
    settings: &RenderSettings,
    cache: &IrradianceCache,
) -> Result<Vec<ErrorEstimate>, IntegratorError> {
    let bounces = settings.integrator.bounces();
    // One sample in the middle of each pixel: aliasing of edges is no error of the cache.
    let of_integrator = |integrator: IntegratorSettings| {
        let settings = RenderSettings {
            integrator,
            sampling: PixelSampling::Center,
            seed: settings.seed ^ SEED,
            lock_seed: false,
            ..settings.clone()
        };
        Renderer::new(scene, settings, Some(cache))
    };
    let cached = of_integrator(IntegratorSettings::Cached { bounces })?;
    let splits = vec![2 * PATHS];
    let path_traced = of_integrator(IntegratorSettings::PathTraced { bounces, splits })?;
    if bounces == 0 {
        return Ok(Vec::new());
    }
    let frames = u64::from(path.timeline().frame_count());
    let (width, height) = (settings.width, settings.height);
    let all = frames * u64::from(width) * u64::from(height);
    let count = (all / PIXELS_PER_HELD_OUT).clamp(MIN_HELD_OUT, MAX_HELD_OUT);
    let positions = SobolSequence::new(cached.settings().seed, 0, 0, 0);
    let of_frame = |frame: u64| {
        let pixel = |index: u64| {
            let [u, v] = positions.sample_2d(index as u32, 0);
            let [x, y] = [(u, width), (v, height)].map(|(u, size)| (u * size as f32) as u32);
            (x.min(width - 1), y.min(height - 1))
        };
        // Pixel i belongs to frame i * frames / count.
        let first = |frame: u64| (frame * count).div_ceil(frames);
        let pixels: Vec<(u32, u32)> = (first(frame)..first(frame + 1)).map(pixel).collect();
        let camera = path.camera(frame as u32);
        let of = |renderer: &Renderer| renderer.render_pixels(&camera, frame as u32, &pixels);
        let both = of(&cached).into_iter().zip(of(&path_traced));
        both.map(|(technique, oracle)| HeldOutPixel { technique, oracle })
            .collect::<Vec<_>>()
    };
    let held_out: Vec<HeldOutPixel> = (0..frames)
        .into_par_iter()
        .flat_map_iter(of_frame)
        .collect();
    let exposure = -libm::log2f(settings.display_white);
    let error = |frame: u64| {
        let middle = (frame * count / frames) as usize;
        let last = held_out.len() - WINDOW;
        let first = middle.saturating_sub(WINDOW / 2).min(last);
        let check = BiasCheck::of(&held_out[first..first + WINDOW], exposure);
        ErrorEstimate {
            rel_mse: check.squared_bias.mean.max(0.0),
            standard_error: check.squared_bias.error,
        }
    };
    Ok((0..frames).map(error).collect())
}
