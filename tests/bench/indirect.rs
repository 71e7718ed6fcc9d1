//! Indirect light from an irradiance cache, beside direct light alone:
//! `cargo bench --bench indirect -- SCENE PATH 1280x720`.
//!
//! Seconds of the bake and of frames with four camera samples per pixel, and the error at random pixels against
//! path tracing, beside the cache error that the bake states. Seconds of frames are the least of five runs, on all
//! threads.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints or fails"
)]

use flythrough::bake::{BakeState, NoKeeper, cache_errors};
use flythrough::camera_formats::load_camera_path;
use flythrough::input::{GlobalIllumination, InputFiles, Mode, Settings, load_scene};
use flythrough::integrator::IntegratorSettings;
use flythrough::metrics::{BiasCheck, HeldOutPixel};
use flythrough::render::{PixelSampling, RenderSettings, Renderer};
use flythrough::sampling::Random;
use std::path::Path;
use std::time::Instant;

/// Frames that are timed and measured.
const FRAMES: u32 = 6;

/// Runs per frame; the fastest counts.
const RUNS: usize = 5;

/// Pixels per frame whose error is measured, and path-traced paths per pixel.
const PIXELS: usize = 200;
const PATHS: u32 = 8192;

/// Path-traced frames are timed at the size divided by this.
const SIZE_DIVISOR: u32 = 4;

fn main() {
    let arguments: Vec<String> = std::env::args().filter(|a| a != "--bench").collect();
    let [_, scene, path, size] = &arguments[..] else {
        println!("cargo bench --bench indirect -- SCENE PATH 1280x720");
        return;
    };
    let files = &mut InputFiles::default();
    let scene = load_scene(Path::new(scene), files).unwrap();
    let path = load_camera_path(Path::new(path), files).unwrap();
    let (width, height) = size.split_once('x').unwrap();
    let given = Settings {
        mode: Some(Mode::Montecarlo),
        gi: Some(GlobalIllumination::PathTraced),
        size: Some((width.parse().unwrap(), height.parse().unwrap())),
        splits: Some(vec![PATHS]),
        samples: None,
        target_error: None,
        ..path.settings.or(scene.settings)
    };
    let (scene, path) = (scene.scene, path.path);
    let path_traced = given.resolve(path.timeline().frame_count());
    let bounces = path_traced.integrator.bounces();

    let start = Instant::now();
    let mut state = BakeState::new(bounces, path_traced.seed);
    let size = (path_traced.width, path_traced.height);
    let Ok(()) = state.add_camera_path(&scene, &path, "path", size, 0, &|_, _| (), &mut NoKeeper);
    let cache = state.irradiance_cache(&scene, "path").unwrap();
    let baked = start.elapsed().as_secs_f64();
    let [primary, secondary] = cache.record_count();
    println!(
        "bake: {baked:.2} s, {primary} primary, {secondary} secondary records, {:.1} MB",
        cache.memory() as f64 / 1e6
    );

    let renderer =
        |settings: RenderSettings| Renderer::new(&scene, settings, Some(&cache)).unwrap();
    let by = |integrator: IntegratorSettings| RenderSettings {
        integrator,
        ..path_traced.clone()
    };
    let cached = by(IntegratorSettings::Cached { bounces });
    let direct = by(IntegratorSettings::Whitted { bounces });
    let count = path.timeline().frame_count();
    let middle = |part: u32| (2 * part + 1) * count / (2 * FRAMES);
    let frames: Vec<u32> = (0..FRAMES).map(middle).collect();
    let sampling = PixelSampling::Spread(4);
    let both =
        [&direct, &cached].map(|settings| renderer(settings.clone()).with_sampling(sampling));
    // Alternating, so that a slow phase of the machine slows both.
    let mut sums = [(0.0, 0.0); 2];
    for &frame in &frames {
        let camera = path.camera(frame);
        let mut best = [(f64::INFINITY, 0.0); 2];
        for _ in 0..RUNS {
            for (renderer, best) in both.iter().zip(&mut best) {
                let start = Instant::now();
                let rays = renderer.render_frame(&camera, frame).rays;
                *best = (best.0.min(start.elapsed().as_secs_f64()), rays as f64);
            }
        }
        for (sum, best) in sums.iter_mut().zip(best) {
            *sum = (sum.0 + best.0, sum.1 + best.1);
        }
    }
    let mean = |(seconds, rays)| (seconds / f64::from(FRAMES), rays / f64::from(FRAMES));
    let [(direct, direct_rays), (with, rays)] = sums.map(mean);
    let all = f64::from(count);
    let with_bake = baked / all + with;
    println!(
        "frame: {direct:.4} s with direct light alone, {with:.4} s with indirect light: {:.2} times as long, \
         {:.3} times the rays; with the bake, in {count} frames: {:.2} times",
        with / direct,
        rays / direct_rays,
        with_bake / direct
    );

    let exposure = given.exposure.unwrap_or(0.0);
    let mut random = Random::new(5);
    let stated = cache_errors(&scene, &path, &cached, &cache).unwrap();
    let held_out_by = [&cached, &path_traced].map(|settings| renderer(settings.clone()));
    let (mut everywhere, mut measured_pixels) = (Vec::new(), Vec::new());
    let mut below_stated = 0;
    for &frame in &frames {
        let pixel = |_| {
            let [x, y] =
                [path_traced.width, path_traced.height].map(|n| random.below(n as usize) as u32);
            (x, y)
        };
        let pixels: Vec<(u32, u32)> = (0..PIXELS).map(pixel).collect();
        let camera = path.camera(frame);
        let [technique, oracle] = held_out_by
            .each_ref()
            .map(|renderer| renderer.render_pixels(&camera, frame, &pixels));
        let both = technique.into_iter().zip(oracle);
        let held_out = both.map(|(technique, oracle)| HeldOutPixel { technique, oracle });
        let held_out: Vec<HeldOutPixel> = held_out.collect();
        let measured = print_error(&format!("frame {frame}"), &held_out, exposure);
        let [low, high] = stated[frame as usize].interval();
        println!("  stated cache error: {low:.6} to {high:.6}");
        below_stated += u32::from(measured <= high);
        everywhere.extend(held_out);
        measured_pixels.push((frame, pixels));
    }
    print_error("all frames", &everywhere, exposure);
    println!("{below_stated} of {FRAMES} frames are no worse than stated");

    let with_paths = |paths| {
        let splits = vec![paths];
        let settings = by(IntegratorSettings::PathTraced { bounces, splits });
        renderer(settings).with_seed(path_traced.seed + 1)
    };
    let square_error = |pixels: &[HeldOutPixel]| BiasCheck::of(pixels, exposure).squared_bias.mean;
    let cache_error = square_error(&everywhere);
    let error_of = |paths| {
        let renderer = with_paths(paths);
        let values = measured_pixels.iter().flat_map(|(frame, pixels)| {
            renderer.render_pixels(&path.camera(*frame), *frame, pixels)
        });
        let pixels = everywhere.iter().zip(values).map(|(pixel, [a, b])| {
            let mean = 0.5 * (a + b);
            HeldOutPixel {
                technique: [mean, mean],
                ..*pixel
            }
        });
        square_error(&pixels.collect::<Vec<_>>())
    };
    let powers = (3..13).map(|power| (1 << power, error_of(1 << power)));
    let worse = powers.take_while(|(_, error)| *error > cache_error);
    let Some((paths, error)) = worse.last() else {
        println!("8 paths per pixel are no worse");
        return;
    };
    // As many paths per pixel, divided among its four camera samples.
    let small = with_paths(paths / 4).with_sampling(sampling).with_size(
        path_traced.width / SIZE_DIVISOR,
        path_traced.height / SIZE_DIVISOR,
    );
    let start = Instant::now();
    for &frame in &frames {
        small.render_frame(&path.camera(frame), frame);
    }
    let seconds =
        start.elapsed().as_secs_f64() * f64::from(SIZE_DIVISOR * SIZE_DIVISOR) / f64::from(FRAMES);
    println!(
        "{paths} paths per pixel are worse, relMSE {error:.6}, and take {seconds:.1} s a frame: {:.0} times as long \
         as the cache with its part of the bake",
        seconds / with_bake
    );
}

/// Prints the errors of some pixels; returns the lower 95 % confidence bound of the squared error.
fn print_error(name: &str, pixels: &[HeldOutPixel], exposure: f32) -> f64 {
    let check = BiasCheck::of(pixels, exposure);
    let [low, high] = check.squared_bias.interval(pixels.len() as u32 - 1);
    println!(
        "{name}: relMSE {low:.6} to {high:.6}, mean {:+.3} % +- {:.3} %, 95 % of the pixels within {:.1} %",
        100.0 * check.mean_bias.mean,
        196.0 * check.mean_bias.error,
        100.0 * p95(pixels, exposure)
    );
    low
}

/// The relative error that 95 % of the pixels do not exceed, the oracle's noise in it.
fn p95(pixels: &[HeldOutPixel], exposure: f32) -> f32 {
    let error = |pixel: &HeldOutPixel| {
        let [x, r] = [pixel.technique, pixel.oracle].map(|[a, b]| 0.5 * exposure.exp2() * (a + b));
        (((x - r).powf(2.0) / (r * r + 0.01)).element_sum() / 3.0).sqrt()
    };
    let mut errors: Vec<f32> = pixels.iter().map(error).collect();
    errors.sort_by(f32::total_cmp);
    errors[errors.len() * 95 / 100]
}
