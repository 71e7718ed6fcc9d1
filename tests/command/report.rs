//! The report on speed against error, of small frames, and the checks it is built on.

use crate::hostile_names::{HOSTILE, assert_is_harmless};
use crate::support::statistics::spread;
use crate::support::*;
use flythrough::metrics::{BiasCheck, HeldOutPixel};
use flythrough::render::{PixelSampling, RenderSettings};
use std::collections::BTreeSet;
use std::fs;

const SIZE: [u32; 2] = [64, 48];

/// Every fifth pixel of test3, twice by a technique and twice by an unbiased reference.
fn held_out(technique: &RenderSettings) -> Vec<HeldOutPixel> {
    let scene = shipped_scene("test3.ron");
    let camera = shipped_path("test3.ron").camera(20);
    let all = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let pixels: Vec<(u32, u32)> = all.step_by(5).collect();
    let render =
        |settings: &RenderSettings| renderer(&scene, settings).render_pixels(&camera, 0, &pixels);
    let oracle = RenderSettings {
        seed: 1000,
        ..spread(monte_carlo(4, &[1]), SIZE, 512)
    };
    let pictures = [0, 1].map(|seed| {
        let settings = RenderSettings {
            seed,
            ..technique.clone()
        };
        render(&settings).into_iter().map(|[a, b]| 0.5 * (a + b))
    });
    let [first, second] = pictures;
    let both = first.zip(second).zip(render(&oracle));
    both.map(|((c1, c2), oracle)| HeldOutPixel {
        technique: [c1, c2],
        oracle,
    })
    .collect()
}

/// Biased are three bounces in place of four, clamped radiance, and edges without antialiasing, whose mean is right.
#[test]
fn biased_techniques_are_detected_and_unbiased_ones_are_not() {
    let unbiased = spread(monte_carlo(4, &[2]), SIZE, 16);
    let check = |pixels: &[HeldOutPixel]| BiasCheck::of(pixels, 0.0);
    let of_unbiased = check(&held_out(&unbiased));
    assert!(!of_unbiased.is_biased(), "{of_unbiased:?}");
    let few_bounces = check(&held_out(&spread(monte_carlo(3, &[2]), SIZE, 16)));
    assert!(few_bounces.is_biased(), "{few_bounces:?}");
    assert!(few_bounces.mean_bias.mean < 0.0);
    let mut clamped = held_out(&unbiased);
    for pixel in &mut clamped {
        pixel.technique = pixel
            .technique
            .map(|radiance| radiance.min(glam::Vec3::splat(0.3)));
    }
    assert!(check(&clamped).is_biased());
    // One sample in the pixel's middle: no smooth edges.
    let aliased = check(&held_out(&settings(
        monte_carlo(4, &[256]),
        SIZE[0],
        SIZE[1],
    )));
    assert!(aliased.is_biased(), "{aliased:?}");
}

#[test]
fn single_pixels_are_rendered_as_in_the_frame() {
    let scene = shipped_scene("test3.ron");
    let camera = shipped_path("test3.ron").camera(3);
    for sampling in [
        PixelSampling::Center,
        PixelSampling::Corners,
        PixelSampling::Spread(4),
    ] {
        for integrator in [monte_carlo(2, &[4]), ray_tracing()] {
            let settings = RenderSettings {
                sampling,
                ..settings(integrator, 20, 15)
            };
            let renderer = renderer(&scene, &settings);
            let frame = renderer.render_frame(&camera, 7);
            let pixels = [(0, 0), (19, 14), (10, 7), (3, 11)];
            let single = renderer.render_pixels(&camera, 7, &pixels);
            for ((x, y), [a, b]) in pixels.iter().zip(single) {
                let number = (y * 20 + x) as usize;
                assert_close(0.5 * (a + b), frame.film.pixels()[number], 1e-6);
                let half_difference = frame.half_difference.as_ref().map(|d| d.pixels()[number]);
                assert_close(0.5 * (a - b), half_difference.unwrap_or_default(), 1e-6);
            }
        }
    }
}

/// Frames with a locked seed have the same noise; others have not.
#[test]
fn a_locked_seed_gives_the_same_noise_in_every_frame() {
    let scene = shipped_scene("test3.ron");
    let camera = shipped_path("test3.ron").camera(0);
    for lock_seed in [true, false] {
        let settings = RenderSettings {
            lock_seed,
            ..settings(monte_carlo(2, &[2]), 12, 9)
        };
        let renderer = renderer(&scene, &settings);
        let [a, b] = [0, 1].map(|frame| renderer.render_frame(&camera, frame));
        assert_eq!(a.film == b.film, lock_seed);
    }
}

#[test]
fn a_report_has_everything_and_keeps_its_references() {
    let out = tempfile::tempdir().unwrap();
    let scene = out.path().join("s.ron");
    // The title of the report.
    let path = out.path().join(format!("[a](b) <i>*|{HOSTILE}.ron"));
    fs::write(
        &scene,
        "Scene(
            settings: (size: (64, 48), bounces: 1),
            materials: {\"grey\": (diffuse: (0.5, 0.5, 0.5))},
            lights: [(position: (0, 0.5, 0), intensity: (2, 2, 2))],
            objects: [sphere(center: (0, 0, 0), radius: 1, material: \"grey\"),
                      sphere(center: (0, -0.6, -0.3), radius: 0.2, material: \"grey\")],
        )",
    )
    .unwrap();
    let keys = "(time: 0, position: (0, 0, 0.9), look_at: (0, 0, 0), fov: 60),
                (time: 0.1, position: (0.01, 0, 0.9), look_at: (0, 0, 0), fov: 60)";
    fs::write(&path, crate::support::path(keys)).unwrap();
    let folder = out.path().join("report");
    let arguments = [
        "report",
        scene.to_str().unwrap(),
        path.to_str().unwrap(),
        "--out",
        folder.to_str().unwrap(),
        "--size",
        "16x12",
        "--frames",
        "1",
        "--seeds",
        "2",
        "--reference-error",
        "0.001",
    ];
    let run = || {
        let output = flythrough(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let printed = run();
    assert!(printed.contains("relMSE 0.01: `--mode"), "{printed}");
    assert!(printed.contains("Flicker with 32 paths"), "{printed}");
    assert!(
        printed.contains("more samples do not remove: direct light, center;"),
        "{printed}"
    );
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    let measured = report["measurements"].as_array().unwrap();
    let techniques = flythrough::report::techniques();
    assert_eq!(measured.len(), techniques.len());
    assert_eq!(read("report.csv").lines().count(), techniques.len() + 1);
    let text = read("report.md");
    assert!(text.starts_with(r"# \[a\]\(b\) \<i\>\*\|é"), "{text}");
    for text in [
        &text,
        &read("report.csv"),
        &read("curves.svg"),
        &read("flicker.svg"),
    ] {
        assert_is_harmless(text);
    }
    // Every picture of the report exists.
    let pictures: BTreeSet<&str> = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .collect();
    assert!(pictures.len() > 10);
    for picture in pictures {
        assert!(image::open(folder.join(picture)).is_ok(), "{picture}");
    }
    for technique in &techniques {
        assert!(text.contains(&technique.flags()), "{}", technique.flags());
    }
    // More samples have less error, and the estimate of frames is nearly the error.
    let errors = |flags: &str| {
        let row = measured.iter().find(|row| row["flags"] == flags).unwrap();
        ["rel_mse", "own_estimate"].map(|key| row[key].as_f64().unwrap())
    };
    let few = errors("--mode montecarlo --samples 4 --splits 1");
    let many = errors("--mode montecarlo --samples 256 --splits 1");
    assert!(few[0] > 10.0 * many[0], "{few:?} {many:?}");
    assert!((few[0] / few[1] - 1.0).abs() < 0.3, "{few:?}");
    // The advice is the cheapest that is good enough with every seed, and agrees with the check of its bias.
    for target in [0.01, 0.001, 0.0002] {
        let start = format!("relMSE {target}: ");
        let advice = printed.lines().find(|line| line.starts_with(&start));
        let advice = advice.unwrap_or_else(|| panic!("{printed}"));
        assert!(text.contains(advice));
        let good = measured
            .iter()
            .filter(|row| row["spread"][1].as_f64().unwrap() <= target);
        let seconds = |row: &&serde_json::Value| row["full_size_seconds"].as_f64().unwrap();
        let Some(best) = good.min_by(|a, b| seconds(a).total_cmp(&seconds(b))) else {
            assert!(advice.contains("no setting measured"), "{advice}");
            continue;
        };
        let flags = best["flags"].as_str().unwrap();
        assert!(advice.contains(&format!("`{flags}`")), "{advice}");
        let mut checked = report["bias"].as_array().unwrap().iter();
        let checked = checked.find(|row| row["curve"] == best["curve"]).unwrap();
        let is_biased = checked["is_biased"].as_bool().unwrap();
        assert_eq!(advice.contains("bias included"), is_biased, "{advice}");
    }
    // The irradiance cache takes fewer rays and has less error. Each frame is charged its part of baking.
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let bake = &report["bake"];
    assert_eq!(bake["frames"], 3);
    assert!(number(&bake["records"][0]) > 10.0, "{bake}");
    assert!(text.contains("The irradiance cache takes"));
    let bake_seconds_per_frame = number(&bake["seconds"]) / 3.0;
    let mut cached_rows = 0;
    for row in measured {
        let [width, height] = [0, 1].map(|i| number(&row["size"][i]));
        let is_cached = row["flags"].as_str().unwrap().contains("--gi cached");
        cached_rows += u32::from(is_cached);
        let frame_seconds = number(&row["seconds"]) * 64.0 * 48.0 / (width * height);
        let expected = frame_seconds
            + if is_cached {
                bake_seconds_per_frame
            } else {
                0.0
            };
        let relative_error = number(&row["full_size_seconds"]) / expected - 1.0;
        assert!(relative_error.abs() < 1e-9, "{row}");
    }
    assert_eq!(cached_rows, 8);
    let rays_and_error = |flags: &str| {
        let row = measured.iter().find(|row| row["flags"] == flags).unwrap();
        ["rays", "rel_mse"].map(|key| number(&row[key]))
    };
    let cached = rays_and_error("--mode montecarlo --samples 16 --gi cached");
    let path_traced = rays_and_error("--mode montecarlo --samples 16 --splits 1");
    assert!(cached[0] < path_traced[0], "{cached:?} {path_traced:?}");
    assert!(
        10.0 * cached[1] < path_traced[1],
        "{cached:?} {path_traced:?}"
    );
    let checked = report["bias"].as_array().unwrap();
    let of_cache = |row: &&serde_json::Value| row["curve"] == "irradiance cache";
    assert_eq!(checked.iter().filter(of_cache).count(), 1);
    let flicker = |kind: &str| {
        let rows = report["flicker"].as_array().unwrap().iter();
        let squares = rows.filter(|row| row["kind"] == kind);
        let squares: Vec<f64> = squares.map(|row| number(&row["square"]["mean"])).collect();
        assert_eq!(squares.len(), 2);
        squares.iter().sum::<f64>() / 2.0
    };
    let noise = flicker("path-traced, new seed in each frame");
    for kind in ["irradiance cache", "direct light alone"] {
        assert!(
            30.0 * flicker(kind) < noise,
            "{kind}: {} {noise}",
            flicker(kind)
        );
    }
    for reference in report["references"].as_array().unwrap() {
        let error = number(&reference["rel_mse"]);
        assert!(error < 1e-3, "{reference}");
    }
    // References are rendered once: a second run reads them, another scene gets new ones.
    let references = || -> Vec<Vec<u8>> {
        let files = fs::read_dir(folder.join("references")).unwrap();
        let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        files.sort();
        files.iter().map(|file| fs::read(file).unwrap()).collect()
    };
    let made = references();
    let modified = |folder: &std::path::Path| {
        let files = fs::read_dir(folder.join("references")).unwrap();
        files
            .map(|f| f.unwrap().metadata().unwrap().modified().unwrap())
            .max()
    };
    let before = modified(&folder);
    run();
    assert_eq!(modified(&folder), before);
    // Without bounces the cache is empty. The report ignores the `gi` that files set, and says so.
    let darker = fs::read_to_string(&scene)
        .unwrap()
        .replace("bounces: 1", "bounces: 0, gi: \"cached\"");
    fs::write(&scene, darker).unwrap();
    let printed = run();
    assert!(
        printed.contains("sets gi, which the report leaves out"),
        "{printed}"
    );
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(report["bake"]["records"], serde_json::json!([0, 0]));
    assert_ne!(references(), made);
}

#[test]
fn wrong_reports_are_refused() {
    let cases: [(&[&str], &str); 4] = [
        (&["--frames", "99"], "--frames: there is no frame 99"),
        (&["--size", "0x9"], "--size: 0 is not between 1 and"),
        (
            &["--reference-error", "0"],
            "--reference-error: 0 is not between",
        ),
        (&["--seeds", "1"], "--seeds"),
    ];
    for (more, expected) in cases {
        let out = tempfile::tempdir().unwrap();
        let out = out.path().to_str().unwrap();
        let start = ["report", "scenes/test3.ron", "paths/test3.ron", "-o", out];
        let output = flythrough(&[&start, more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}
