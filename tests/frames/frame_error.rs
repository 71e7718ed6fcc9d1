//! Estimated errors of frames, and adaptive sampling.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::camera::Camera;
use flythrough::film::Film;
use flythrough::render::{PixelSampling, RenderSettings, RenderedFrame};
use flythrough::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::LazyLock;

const SIZE: [u32; 2] = [80, 60];

/// A Cornell box with a mirror, near lights and two shadows.
static ROOM: LazyLock<(Scene, Camera)> = LazyLock::new(|| {
    let camera = shipped_path("test3.ron").camera(20);
    (shipped_scene("test3.ron"), camera)
});

/// Textures of fine detail, mirrors, spheres and models.
static GALLERY: LazyLock<(Scene, Camera)> = LazyLock::new(|| {
    let camera = shipped_path("gallery.ron").camera(60);
    (shipped_scene("gallery.ron"), camera)
});

/// Sun, sky and emitters, inside and out.
static SUNROOM: LazyLock<(Scene, Camera)> = LazyLock::new(|| {
    let camera = shipped_path("sunroom.ron").camera(100);
    (shipped_scene("sunroom.ron"), camera)
});

/// The room of test3, lit by a square below its ceiling alone.
static LAMP: LazyLock<(Scene, Camera)> = LazyLock::new(|| {
    let room = room_without_lights(
        "\"mirror\": (diffuse: (0.7, 0.7, 0.7), reflective: (0.8, 0.8, 0.8)),
         \"olive\": (diffuse: (0.6, 0.6, 0.2)),
         \"lamp\": (emission: (18, 15, 11)),",
        "triangle(vertices: [(-0.25, 0.995, -0.25), (0.25, 0.995, -0.25), (0.25, 0.995, 0.25)], material: \"lamp\"),
         triangle(vertices: [(-0.25, 0.995, -0.25), (0.25, 0.995, 0.25), (-0.25, 0.995, 0.25)], material: \"lamp\"),
         sphere(center: (0.35, -0.5, -0.2), radius: 0.5, material: \"mirror\"),
         sphere(center: (-0.45, -0.65, 0.2), radius: 0.35, material: \"olive\"),",
    );
    (room, shipped_path("test3.ron").camera(20))
});

fn frame(settings: &RenderSettings, seed: u32) -> RenderedFrame {
    frame_of(&ROOM, settings, seed)
}

fn frame_of(
    (scene, camera): &(Scene, Camera),
    settings: &RenderSettings,
    seed: u32,
) -> RenderedFrame {
    let settings = RenderSettings {
        seed,
        ..settings.clone()
    };
    renderer(scene, &settings).render_frame(camera, 0)
}

/// The mean of (x - r)^2 / (m^2 + (white / 10)^2), where m is the mean of the neighbouring pixels of the reference.
fn rel_mse(film: &Film, reference: &Film, white: f64) -> f64 {
    relative_mean(film, reference, reference, white)
}

/// The same, where m is that of another film.
fn relative_mean(film: &Film, reference: &Film, radiance: &Film, white: f64) -> f64 {
    let (width, height) = (SIZE[0] as i32, SIZE[1] as i32);
    let at = |film: &Film, x: i32, y: i32| film.pixels()[(y * width + x) as usize].as_dvec3();
    let inside = |x: i32, y: i32| (0..width).contains(&x) && (0..height).contains(&y);
    let mut sum = 0.0;
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        let around = around.filter(|(dx, dy)| (*dx, *dy) != (0, 0) && inside(x + dx, y + dy));
        let around: Vec<DVec3> = around
            .map(|(dx, dy)| at(radiance, x + dx, y + dy))
            .collect();
        let mean = around.iter().sum::<DVec3>() / around.len() as f64;
        let error = at(film, x, y) - at(reference, x, y);
        sum += (error * error / (mean * mean + (0.1 * white).powi(2))).element_sum();
    }
    sum / f64::from(3 * width * height)
}

/// 95 % intervals should hold the true error of 95 in 100 frames. Of 200 frames, fewer than 90 or more than 99 in 100
/// are within theirs in less than one of 500 cases. The truth is the converged picture, whatever the frame's samples.
#[test]
fn intervals_hold_the_true_error() {
    // Initialised first: their initialisers need the threads that would wait for them below.
    LazyLock::force(&ROOM);
    LazyLock::force(&GALLERY);
    use PixelSampling::{Adaptive, Center, Corners, Spread};
    let noisy = || monte_carlo(4, &[scaled(4, 4, 16)]);
    let cases = [
        (&ROOM, ray_tracing(), Adaptive(0.003)),
        (&LAMP, ray_tracing(), Adaptive(0.01)),
        (&LAMP, ray_tracing(), Center),
        (&ROOM, ray_tracing(), Center),
        (&ROOM, ray_tracing(), Spread(1)),
        (&GALLERY, ray_tracing(), Adaptive(0.01)),
        (&ROOM, noisy(), Center),
        (&GALLERY, ray_tracing(), Spread(4)),
        (&ROOM, ray_tracing(), Spread(4)),
        (&ROOM, ray_tracing(), Spread(16)),
        (&ROOM, ray_tracing(), Corners),
        (&ROOM, noisy(), Corners),
        (&ROOM, noisy(), Spread(4)),
        (&ROOM, noisy(), Adaptive(0.01)),
        (&LAMP, noisy(), Spread(4)),
        (&LAMP, noisy(), Adaptive(0.03)),
        (&SUNROOM, noisy(), Spread(4)),
    ];
    for (view, integrator, sampling) in &cases[..scaled(2, 5, cases.len())] {
        let settings = RenderSettings {
            display_white: 0.35,
            sampling: *sampling,
            ..settings(integrator.clone(), SIZE[0], SIZE[1])
        };
        let reference = RenderSettings {
            sampling: Spread(1024),
            ..settings.clone()
        };
        let reference = frame_of(view, &reference, 1_000_000);
        let runs = (0..200).into_par_iter().map(|seed| {
            let rendered = frame_of(view, &settings, seed);
            let true_error = rel_mse(&rendered.film, &reference.film, 0.35);
            let error = rendered.error.whole;
            let [low, high] = error.interval();
            let is_within = (low..=high).contains(&true_error);
            (is_within, error.rel_mse, true_error)
        });
        let runs: Vec<(bool, f64, f64)> = runs.collect();
        let case = format!("{integrator:?} {sampling:?}");
        let within = runs.iter().filter(|(is_within, ..)| *is_within).count();
        assert!((180..=198).contains(&within), "{case}: {within} of 200");
        let mean = |of: fn(&(bool, f64, f64)) -> f64| runs.iter().map(of).sum::<f64>() / 200.0;
        let (estimated, measured) = (mean(|run| run.1), mean(|run| run.2));
        // A few held-out pixels tell what filters of textures change: an estimate that ends a frame is more often low.
        let has_textures = !view.0.textures().is_empty();
        let most = if has_textures { 0.2 } else { 0.08 };
        assert!(
            (estimated / measured - 1.0).abs() < most,
            "{case}: {estimated} {measured}"
        );
        let of_reference = reference.error.whole.rel_mse;
        assert!(of_reference < 0.01 * measured, "{case}: {of_reference}");
    }
}

/// A black wall before a white background covers seven tenths of the pixels of one column: what its one sample in the
/// middle is off by, and the mean of its corners, is known, in the whole, in the worst block and in the blocks' means.
#[test]
fn the_error_of_an_edge_is_the_known_one() {
    let (width, height) = (16, 12);
    let scene = scene(
        "Scene(background: (1, 1, 1), ambient: (0, 0, 0), materials: {\"black\": (diffuse: (0, 0, 0))}, objects: [
            triangle(vertices: [(0.3, -50, 0), (90, -50, 0), (90, 50, 0)], material: \"black\"),
            triangle(vertices: [(0.3, -50, 0), (90, 50, 0), (0.3, 50, 0)], material: \"black\"),
        ])",
    );
    // Pixels are 1 wide at the wall, and column 8 is from 0 to 1.
    let degrees = 2.0 * 0.6_f64.atan().to_degrees();
    let camera = camera(DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO, degrees);
    // Of black and white the light is nothing beside the tenth of this.
    let display_white = 1000.0;
    for (sampling, off) in [(PixelSampling::Center, 0.3), (PixelSampling::Corners, 0.2)] {
        let estimates = |seed: u32| {
            let settings = RenderSettings {
                seed,
                sampling,
                display_white,
                ..settings(ray_tracing(), width, height)
            };
            let error = renderer(&scene, &settings).render_frame(&camera, 0).error;
            [error.whole.rel_mse, error.worst_block, error.blurred]
        };
        let estimates: Vec<[f64; 3]> = (0..300).map(estimates).collect();
        let square = off * off / f64::from(0.1 * display_white).powi(2);
        // One column of 16; one of the 8 of a block; the blocks of half of the picture.
        let expected = [square / 16.0, square / 8.0, 0.5 * square / 64.0];
        for (of, expected) in expected.into_iter().enumerate() {
            let values: Vec<f64> = estimates.iter().map(|estimate| estimate[of]).collect();
            let estimate = Estimate::of(&values);
            // The estimates of the light are relative to 1e4 and something.
            let off = (estimate.mean - expected).abs();
            // The largest of two noisy blocks is a little too large.
            let more = if of == 1 { 0.2 * expected } else { 0.0 };
            assert!(
                off < 4.0 * estimate.error + more,
                "{sampling:?} {of}: {estimate:?} {expected}"
            );
            assert!(
                estimate.error < 0.05 * expected,
                "{sampling:?} {of}: {estimate:?}"
            );
        }
    }
}

/// Adaptive sampling leaves every pixel unbiased, although it adds samples where neighbouring pixels need them.
#[test]
fn frames_of_a_target_error_reach_it_without_bias() {
    let size = [32, 24];
    for (integrator, samples, target) in [(monte_carlo(4, &[2]), 4, 0.01), (ray_tracing(), 1, 0.01)]
    {
        let integrator_is_whitted = integrator == ray_tracing();
        let plain = RenderSettings {
            sampling: PixelSampling::Spread(samples),
            ..settings(integrator, size[0], size[1])
        };
        let adaptive = RenderSettings {
            target_error: Some(target),
            ..plain.clone()
        };
        let rendered: Vec<RenderedFrame> = (0..64).map(|seed| frame(&adaptive, seed)).collect();
        for rendered in &rendered {
            let error = rendered.error.whole;
            assert!(error.interval()[1] <= target, "{error:?}");
            // Not far below the target.
            assert!(error.rel_mse > 0.02 * target, "{error:?}");
        }
        let few = frame(&plain, 0);
        assert!(few.error.whole.rel_mse > 2.0 * target);
        // Edges of a few samples are not normally distributed: their mean is compared below.
        if integrator_is_whitted {
            continue;
        }
        let adaptive: Vec<Vec<f64>> = rendered.iter().map(|r| channels(r.film.pixels())).collect();
        let reference = RenderSettings {
            sampling: PixelSampling::Spread(scaled(64, 64, 256)),
            ..plain
        };
        let reference = runs(&ROOM.0, &ROOM.1, &reference, 1_000_000..1_000_064);
        let agreement = Agreement::of(&estimates(&adaptive), &estimates(&reference), 63, 0.0);
        assert!(agreement.holds(), "{agreement:?}");
        // 1.03 for 63 degrees of freedom, with a standard deviation of 0.05 for 768 pixels.
        assert!((0.8..1.4).contains(&agreement.mean_square), "{agreement:?}");
    }
}

/// Where samples are few and noisy, a bright one must not stop others from being taken. Compares the mean radiance of
/// whole frames.
#[test]
fn added_samples_do_not_make_frames_brighter() {
    // Initialised first: its initialiser needs the threads that would wait for it below.
    LazyLock::force(&ROOM);
    let mean = |settings: &RenderSettings, seeds: std::ops::Range<u32>| {
        let means = seeds.into_par_iter().map(|seed| {
            let film = frame(settings, seed).film;
            let sum: f64 = channels(film.pixels()).iter().sum();
            sum / film.pixels().len() as f64
        });
        Estimate::of(&means.collect::<Vec<f64>>())
    };
    for (integrator, target) in [(monte_carlo(4, &[1]), 0.05), (ray_tracing(), 0.01)] {
        let few = spread(integrator, [32, 24], 1);
        let adaptive = RenderSettings {
            target_error: Some(target),
            ..few.clone()
        };
        let many = RenderSettings {
            sampling: PixelSampling::Spread(64),
            ..few
        };
        let (adaptive, uniform) = (mean(&adaptive, 0..400), mean(&many, 1_000_000..1_000_100));
        let error = adaptive.error.hypot(uniform.error);
        assert!(error < 6e-4 * uniform.mean, "{adaptive:?} {uniform:?}");
        let z = (adaptive.mean - uniform.mean) / error;
        assert!(z.abs() < 3.3, "{z}: {adaptive:?} {uniform:?}");
    }
}

/// The half buffers of a frame are its film plus and minus its half difference. They are independent, so their errors
/// are not correlated.
#[test]
fn half_buffers_are_independent() {
    let paths = scaled(4, 4, 16);
    let settings = settings(monte_carlo(4, &[paths]), SIZE[0], SIZE[1]);
    let reference = frame(
        &RenderSettings {
            integrator: monte_carlo(4, &[128 * paths]),
            ..settings.clone()
        },
        1_000_000,
    );
    let products = |seed| {
        let [a, b] = frame(&settings, seed).half_buffers();
        let [a, b, r] = [&a, &b, &reference.film].map(|film| channels(film.pixels()));
        let of = |i: usize| {
            let (a, b) = (a[i] - r[i], b[i] - r[i]);
            (a * b, 0.5 * (a * a + b * b))
        };
        let all = (0..r.len()).map(of);
        all.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
    };
    let all: Vec<(f64, f64)> = (0..32).map(products).collect();
    let correlation = all.iter().map(|p| p.0).sum::<f64>() / all.iter().map(|p| p.1).sum::<f64>();
    // 32 frames of 1,728 pixels; channels of a pixel vary together.
    assert!(
        correlation.abs() < 4.0 / (32.0 * 1728.0_f64).sqrt(),
        "{correlation}"
    );
}

/// The squares of the pixels' standard errors, relative to the radiance around them, are those of the frame.
#[test]
fn standard_errors_of_pixels_make_up_that_of_the_frame() {
    let noisy = monte_carlo(4, &[4]);
    for (integrator, sampling, most) in [
        (ray_tracing(), PixelSampling::Center, 1e-3),
        (ray_tracing(), PixelSampling::Corners, 1e-3),
        (ray_tracing(), PixelSampling::Adaptive(0.01), 1e-3),
        // The frame's error corrects for the noise of the radiance around pixels.
        (noisy, PixelSampling::Spread(4), 0.1),
    ] {
        let settings = RenderSettings {
            display_white: 0.35,
            sampling,
            ..settings(integrator, SIZE[0], SIZE[1])
        };
        let frame = frame(&settings, 1);
        let errors = frame.standard_errors();
        let no_error = Film::new(SIZE[0], SIZE[1]);
        let mean = relative_mean(&errors, &no_error, &frame.film, 0.35);
        let whole = frame.error.whole.rel_mse;
        assert!(
            (mean / whole - 1.0).abs() < most,
            "{sampling:?} {mean} {whole}"
        );
    }
}

/// Whole blocks and pixels that nothing disturbs have no error.
#[test]
fn even_light_has_no_error() {
    let nothing = scene("Scene(background: (0.5, 0.25, 1), objects: [])");
    for sampling in [
        PixelSampling::Center,
        PixelSampling::Corners,
        PixelSampling::Spread(3),
        PixelSampling::Adaptive(1e-6),
    ] {
        let settings = RenderSettings {
            sampling,
            ..settings(ray_tracing(), 21, 10)
        };
        let frame = renderer(&nothing, &settings).render_frame(&ROOM.1, 0);
        let error = frame.error;
        assert_eq!(error.whole.interval(), [0.0, 0.0], "{sampling:?}");
        assert_eq!(
            [error.worst_block, error.blurred],
            [0.0, 0.0],
            "{sampling:?}"
        );
    }
}

/// In frames of one pixel or one row pixels have fewer neighbours, or none.
#[test]
fn small_frames_have_an_error_estimate() {
    for (width, height) in [(1, 1), (9, 1), (1, 9), (2, 2)] {
        for sampling in [PixelSampling::Spread(2), PixelSampling::Corners] {
            let settings = RenderSettings {
                sampling,
                target_error: Some(0.05),
                ..settings(monte_carlo(2, &[4]), width, height)
            };
            let error = frame(&settings, 0).error.whole;
            assert!(error.rel_mse > 0.0, "{error:?}");
            assert!(error.standard_error.is_finite(), "{error:?}");
        }
    }
}
