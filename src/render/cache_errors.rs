use super::{ErrorEstimate, PixelSampling, RenderSettings, render_pixels};
use crate::camera::CameraPath;
use crate::integrator::Integrator;
use crate::metrics::{BiasCheck, HeldOutPixel};
use crate::sampling::Sequence;
use crate::scene::Scene;
use rayon::prelude::*;

/// One pixel in so many of a sequence is held out.
const SHARE: u64 = 1 << 14;

/// But no fewer and no more.
const LEAST: u64 = 1024;
const MOST: u64 = 4096;

/// What a frame's error is told by.
const WINDOW: usize = 1024;

/// Of each of the two estimates of a pixel.
const PATHS: u32 = 256;

/// Nothing else has this seed.
const SEED: u32 = 7 << 24;

/// How far the light is off that frames look up, frame by frame of the path: of the pixels that are held out
/// in a frame and in those around it. None if there are no bounces.
///
/// At each of them what is looked up, c, is held against two independent estimates A and B that look nothing
/// up: (c - A)(c - B) is the square of the error on average, however noisy they are.
pub fn cache_errors(
    scene: &Scene,
    path: &CameraPath,
    looking_up: &RenderSettings,
) -> Vec<ErrorEstimate> {
    let bounces = looking_up.integrator.bounces();
    if bounces == 0 {
        return Vec::new();
    }
    // Pixels as their middle sees them: edges are no error of the light.
    let looking_up = RenderSettings {
        sampling: PixelSampling::Center,
        seed: looking_up.seed ^ SEED,
        lock_seed: false,
        ..looking_up.clone()
    };
    let exact = RenderSettings {
        integrator: Integrator::MonteCarlo {
            bounces,
            splits: vec![2 * PATHS],
        },
        ..looking_up.clone()
    };
    let frames = u64::from(path.timeline().frame_count());
    let (width, height) = (looking_up.width, looking_up.height);
    let all = frames * u64::from(width) * u64::from(height);
    let count = (all / SHARE).clamp(LEAST, MOST);
    let places = Sequence::new(looking_up.seed, 0, 0, 0);
    let of_frame = |frame: u64| {
        let pixel = |number: u64| {
            let [u, v] = places.sample_2d(number as u32, 0);
            let [x, y] = [(u, width), (v, height)].map(|(u, size)| (u * size as f32) as u32);
            (x.min(width - 1), y.min(height - 1))
        };
        // Number i belongs to frame i * frames / count.
        let first = |frame: u64| (frame * count).div_ceil(frames);
        let pixels: Vec<(u32, u32)> = (first(frame)..first(frame + 1)).map(pixel).collect();
        let camera = path.camera(frame as u32);
        let of = |settings| render_pixels(scene, &camera, settings, frame as u32, &pixels);
        let both = of(&looking_up).into_iter().zip(of(&exact));
        both.map(|(technique, oracle)| HeldOutPixel { technique, oracle })
            .collect::<Vec<_>>()
    };
    let held_out: Vec<HeldOutPixel> = (0..frames)
        .into_par_iter()
        .flat_map_iter(of_frame)
        .collect();
    let exposure = -libm::log2f(looking_up.white);
    let error = |frame: u64| {
        let middle = (frame * count / frames) as usize;
        let last = held_out.len() - WINDOW;
        let first = middle.saturating_sub(WINDOW / 2).min(last);
        let check = BiasCheck::of(&held_out[first..first + WINDOW], exposure);
        ErrorEstimate {
            relative_square_error: check.squared_bias.mean.max(0.0),
            standard_error: check.squared_bias.error,
        }
    };
    (0..frames).map(error).collect()
}
