//! The program's exit status, messages and files: `render`, `check`, `quote` and `selftest`.

use crate::support::project::Project;
use crate::support::*;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The shipped scenes and the paths through them.
const PAIRS: [(&str, &str); 7] = [
    ("test", "test"),
    ("test1", "test"),
    ("test2", "translate_rotate"),
    ("test2", "zoom"),
    ("test3", "test3"),
    ("gallery", "gallery"),
    ("sunroom", "sunroom"),
];

/// Renders small frames into a folder; returns the exit status and stderr.
fn render_small(scene: &str, path: &str, out: &Path, more: &[&str]) -> (Option<i32>, String) {
    let (scene, path) = (format!("scenes/{scene}.ron"), format!("paths/{path}.ron"));
    let mut arguments = vec!["render", &scene, &path, "--out", out.to_str().unwrap()];
    arguments.extend(["--size", "24x14", "--splits", "2"]);
    arguments.extend(more);
    let output = flythrough(&arguments);
    (output.status.code(), stderr(&output))
}

/// Of frames that take one pass over their tiles, and several; the second time some are there.
#[test]
fn progress_ends_with_all_frames() {
    for mode in ["raytracing", "supersampling", "montecarlo"] {
        let project = Project::new();
        for frames in ["0-3", "0-8"] {
            let more = ["--mode", mode, "--frames", frames, "--size", "40x30"];
            let progress = ["--progress", "openjd"];
            let output = project.run("render", &[&more[..], &progress].concat());
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            let lines = String::from_utf8(output.stdout).unwrap();
            let told = lines
                .lines()
                .filter_map(|line| line.strip_prefix("openjd_progress: "));
            let told: Vec<f64> = told.map(|percent| percent.parse().unwrap()).collect();
            assert!(told.is_sorted(), "{mode}: {told:?}");
            assert_eq!(told.last(), Some(&100.0), "{mode}: {told:?}");
        }
    }
}

/// A reader that closes the pipe early, as `head` does, is no error.
#[test]
fn output_that_nobody_reads() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_flythrough"))
        .current_dir(root())
        .args(["check", "scenes/test3.ron", "paths/test3.ron"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stderr(&output), "");
}

/// Each case is a test of the library, and scripts/test.sh runs the command of the release build.
#[test]
#[ignore = "thorough"]
fn selftest_shows_every_case() {
    let output = flythrough(&["selftest"]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{table}");
    for case in flythrough::selftest::CASES {
        let named = |line: &&str| line.starts_with(&format!("  {} ", case.name));
        let row = table.lines().find(named).expect(case.name);
        assert!(
            row.contains(case.measures) && row.ends_with("  ok"),
            "{row}"
        );
    }
}

#[test]
fn every_shipped_scene_and_path_is_in_pairs_and_has_only_harmless_warnings() {
    let names = |folder: &str| -> Vec<String> {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        let files = entries.map(|e| e.unwrap().path());
        let ron = files.filter(|f| f.extension().is_some_and(|e| e == "ron"));
        ron.map(|f| f.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect()
    };
    for scene in names("scenes") {
        assert!(PAIRS.iter().any(|(s, _)| *s == scene), "{scene}");
    }
    for path in names("paths") {
        assert!(PAIRS.iter().any(|(_, p)| *p == path), "{path}");
    }
    for (scene, path) in PAIRS {
        let output = flythrough(&[
            "check",
            &format!("scenes/{scene}.ron"),
            &format!("paths/{path}.ron"),
        ]);
        let report = String::from_utf8(output.stdout.clone()).unwrap();
        assert_eq!(output.status.code(), Some(0));
        let warnings = stderr(&output);
        let count = format!("warnings   {}\n", warnings.lines().count());
        assert!(report.ends_with(&count), "{report}");
        for warning in warnings.lines() {
            let is_harmless = warning.contains("strobes") || warning.contains("repeats the first");
            assert!(is_harmless, "{scene} {path}: {warning}");
        }
    }
}

#[test]
fn every_shipped_scene_renders_in_every_mode() {
    for (scene, path) in PAIRS {
        for mode in [
            "raytracing",
            "supersampling",
            "montecarlo",
            "montecarlo-supersampling",
        ] {
            let out = tempfile::tempdir().unwrap();
            // Some modes do not use the splits.
            let mut more = vec!["--mode", mode, "--frames", "0", "--quiet"];
            if mode != "raytracing" {
                more.extend(["--target-error", "0.02"]);
            }
            let result = render_small(scene, path, out.path(), &more);
            assert_eq!(result, (Some(0), String::new()), "{scene} {path} {mode}");
            let file = out.path().join("frame_00000.png");
            let picture = image::open(file).unwrap().into_rgb8();
            assert_eq!(picture.dimensions(), (24, 14));
            let sum: u64 = picture.as_raw().iter().map(|&code| u64::from(code)).sum();
            assert!(sum > 24 * 14 * 3 * 20, "{scene} {path} {mode} is dark");
        }
    }
}

/// As many threads as the scheduler grants, unless the user gives a number.
#[test]
fn threads_are_those_that_slurm_grants() {
    let threads = |granted: &str, more: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_flythrough"))
            .current_dir(root())
            .args([
                "quote",
                "scenes/test.ron",
                "paths/test.ron",
                "--size",
                "8x8",
            ])
            .args(more)
            .env("SLURM_CPUS_PER_TASK", granted)
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap(),
        )
    };
    for (granted, more, expected) in [
        ("1", &[][..], "on 1 threads"),
        ("3", &[], "on 3 threads"),
        ("3", &["-t", "2"], "on 2 threads"),
    ] {
        let (status, printed) = threads(granted, more);
        assert!(
            status == Some(0) && printed.contains(expected),
            "{granted} {more:?}: {printed}"
        );
    }
    assert_eq!(threads("many", &[]).0, Some(2));
}

#[test]
fn the_path_wins_over_the_scene_and_a_flag_over_both() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file(
        "s.ron",
        "Scene(settings: (size: (10, 10), samples: 2), objects: [])",
    );
    file(
        "p.ron",
        "CameraPath(fps: 1, settings: (size: (20, 10)), keyframes: [(time: 0, position: (0, 0, 0), look_at: (0, 0, 1), fov: 50)])",
    );
    let [s, p, out] = ["s.ron", "p.ron", "out"].map(|n| folder.path().join(n));
    let [s, p, out] = [&s, &p, &out].map(|n| n.to_str().unwrap());
    let size = || image::image_dimensions(format!("{out}/frame_00000.png")).unwrap();
    assert_eq!(
        flythrough(&["render", s, p, "-o", out]).status.code(),
        Some(0)
    );
    assert_eq!(size(), (20, 10));
    let flag = ["render", s, p, "-o", out, "--size", "30x10"];
    assert_eq!(flythrough(&flag).status.code(), Some(0));
    assert_eq!(size(), (30, 10));
}

#[test]
fn formats_hold_the_same_pixels() {
    let out = tempfile::tempdir().unwrap();
    let render = |format: &str, name: &str| {
        let folder = out.path().join(format);
        let more = ["--format", format, "--frames", "0", "--exposure", "0"];
        assert_eq!(render_small("test", "test", &folder, &more).0, Some(0));
        image::open(folder.join(name)).unwrap()
    };
    let eight = render("png", "frame_00000.png").into_rgb8();
    let sixteen = render("png16", "frame_00000.png").into_rgb16();
    let linear = render("exr", "frame_00000.exr").into_rgb32f();
    for ((a, b), c) in eight
        .as_raw()
        .iter()
        .zip(sixteen.as_raw())
        .zip(linear.as_raw())
    {
        let encoded = flythrough::math::color::linear_to_srgb(*c);
        assert_eq!((encoded * 65535.0).round() as u16, *b);
        // Dithered: one of the two codes around.
        assert!((encoded * 255.0 - f32::from(*a)).abs() < 1.0);
    }
}

/// Every frame records its error. `errors.csv` and `errors.svg` have those of all frames in the folder, whichever run
/// they are from. Frames of modes without Monte Carlo noise have none.
#[test]
fn sequences_list_the_errors_of_their_frames() {
    for (format, extension) in [("png", "png"), ("exr", "exr")] {
        let out = tempfile::tempdir().unwrap();
        let more = ["--mode", "montecarlo", "--format", format];
        let render = |frames: &str| {
            let frames = ["--frames", frames];
            render_small("test3", "test3", out.path(), &[&more[..], &frames].concat())
        };
        assert_eq!(render("2-3").0, Some(0));
        assert_eq!(render("0").0, Some(0));
        let read = |name: &str| fs::read_to_string(out.path().join(name)).unwrap();
        let table = read("errors.csv");
        let rows: Vec<Vec<f64>> = table
            .lines()
            .skip(1)
            .map(|row| row.split(',').map(|n| n.parse().unwrap()).collect())
            .collect();
        assert_eq!(
            table.lines().next(),
            Some("frame,relMSE,low,high,worst_block,blurred")
        );
        assert_eq!(
            rows.iter().map(|row| row[0]).collect::<Vec<_>>(),
            [0.0, 2.0, 3.0]
        );
        for row in &rows {
            assert!(row[2] < row[1] && row[1] < row[3], "{row:?}");
            assert!(row[4] > row[1] && row[5] < row[1], "{row:?}");
        }
        let manifest = read("manifest.ron");
        assert!(
            manifest.contains(&format!("rel_mse: {}", rows[2][1])),
            "{manifest}"
        );
        assert!(read("errors.svg").contains("relMSE"));
        assert!(
            out.path()
                .join(format!("frame_00003.{extension}"))
                .is_file()
        );
    }
    let out = tempfile::tempdir().unwrap();
    let more = ["--mode", "raytracing", "--frames", "0"];
    assert_eq!(render_small("test3", "test3", out.path(), &more).0, Some(0));
    let table = fs::read_to_string(out.path().join("errors.csv")).unwrap();
    assert_eq!(table.lines().count(), 2);
}

#[test]
fn error_maps_are_kept_beside_the_frames() {
    let out = tempfile::tempdir().unwrap();
    let more = ["--mode", "montecarlo", "--frames", "1", "--aov", "error"];
    assert_eq!(render_small("test3", "test3", out.path(), &more).0, Some(0));
    let map = image::open(out.path().join("error_00001.exr"))
        .unwrap()
        .into_rgb32f();
    assert_eq!(map.dimensions(), (24, 14));
    assert!(map.as_raw().iter().all(|error| *error >= 0.0));
    // A missing error map is rendered again, even if the frame exists.
    fs::remove_file(out.path().join("error_00001.exr")).unwrap();
    assert_eq!(render_small("test3", "test3", out.path(), &more).0, Some(0));
    assert!(out.path().join("error_00001.exr").is_file());
    let noisy = map.as_raw().iter().filter(|error| **error > 0.0).count();
    assert!(noisy > 24 * 14, "{noisy}");
}

#[test]
fn maps_of_the_cache_error_are_kept_beside_the_frames() {
    let out = tempfile::tempdir().unwrap();
    let given = [
        "--mode",
        "montecarlo",
        "--samples",
        "1",
        "--frames",
        "1",
        "--aov",
    ];
    let more = [&given[..], &["error,cache-error"]].concat();
    let (code, message) = render_small("test3", "test3", out.path(), &more);
    assert_eq!(code, Some(2));
    assert!(message.contains("--aov cache-error"), "{message}");
    let more = [&more[..], &["--gi", "cached"]].concat();
    assert_eq!(render_small("test3", "test3", out.path(), &more).0, Some(0));
    for name in ["error_00001.exr", "cache_error_00001.exr"] {
        let map = image::open(out.path().join(name)).unwrap().into_rgb32f();
        assert_eq!(map.dimensions(), (24, 14));
        assert!(map.as_raw().iter().all(|error| *error >= 0.0));
        let seen = map.as_raw().iter().filter(|error| **error > 0.0).count();
        assert!(seen > 2 * 24 * 14, "{name}: {seen}");
    }
    let fewer = [&given[..], &["error", "--gi", "cached"]].concat();
    assert_eq!(
        render_small("test3", "test3", out.path(), &fewer).0,
        Some(0)
    );
    let stray = out.path().join("cache_error_00001.exr");
    assert!(stray.is_file());
    let clean = [&fewer[..], &["--clean"]].concat();
    assert_eq!(
        render_small("test3", "test3", out.path(), &clean).0,
        Some(0)
    );
    assert!(!stray.is_file());
}

/// All frames end below the target, however many samples each of them takes.
#[test]
fn a_target_error_is_reached_in_every_frame() {
    let out = tempfile::tempdir().unwrap();
    let (scene, path) = ("scenes/test3.ron", "paths/test3.ron");
    let folder = out.path().to_str().unwrap();
    let start = ["render", scene, path, "-o", folder, "--mode", "montecarlo"];
    let more = [
        "--size",
        "32x24",
        "--splits",
        "2",
        "--target-error",
        "0.02",
        "--frames",
        "0-40:20",
    ];
    let output = flythrough(&[&start[..], &more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(
        printed.contains("error (relMSE)") && printed.contains("on average"),
        "{printed}"
    );
    let table = fs::read_to_string(out.path().join("errors.csv")).unwrap();
    let errors = table.lines().skip(1).map(|row| {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().unwrap()).collect();
        numbers[3]
    });
    let errors: Vec<f64> = errors.collect();
    assert_eq!(errors.len(), 3);
    assert!(errors.iter().all(|high| *high <= 0.02), "{errors:?}");
}

#[test]
fn quiet_prints_nothing() {
    let out = tempfile::tempdir().unwrap();
    let (scene, path) = ("scenes/test.ron", "paths/test.ron");
    let out = out.path().to_str().unwrap();
    let output = flythrough(&["render", scene, path, "-o", out, "--size", "8x8", "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

#[test]
fn frames_that_cannot_be_written_are_named_and_the_others_go_on() {
    let out = tempfile::tempdir().unwrap();
    fs::create_dir(out.path().join("frame_00001.png")).unwrap();
    let (status, message) = render_small(
        "test3",
        "test3",
        out.path(),
        &["--frames", "0-2", "--force"],
    );
    assert_eq!(status, Some(3));
    assert!(
        message.contains("frame 1 failed") && message.contains("frame_00001.png"),
        "{message}"
    );
    assert!(out.path().join("frame_00000.png").is_file());
    assert!(out.path().join("frame_00002.png").is_file());
}

/// The log may be on the disk that is full.
#[test]
fn messages_that_cannot_be_written_end_no_rendering() {
    let out = tempfile::tempdir().unwrap();
    fs::create_dir(out.path().join("frame_00001.png")).unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_flythrough"));
    command.current_dir(root()).args([
        "render",
        "scenes/test3.ron",
        "paths/test3.ron",
        "--size",
        "8x8",
    ]);
    command.args(["--frames", "0-2", "-o"]).arg(out.path());
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    let status = command.stdout(full()).stderr(full()).status().unwrap();
    assert_eq!(status.code(), Some(3));
    assert!(out.path().join("frame_00002.png").is_file());
}

/// Wrong commands end with status 2 and a message that names the fault.
#[test]
fn wrong_commands_are_refused() {
    let cases: [(&[&str], &str); 13] = [
        (&["--frames", "0-9999"], "the path has 0-48"),
        (&["--frames", "5-1"], "0-99:2"),
        (&["--size", "0x9"], "--size: 0 is not between 1 and"),
        (&["--size", "9"], "1280x720"),
        (&["--mode", "fast"], "montecarlo-supersampling"),
        (&["--samples", "0"], "--samples: 0"),
        (&["--splits", "3,0"], "--splits: 0"),
        (&["--bounces", "99"], "--bounces: 99"),
        (&["--threads", "0"], "--threads"),
        (&["--target-error", "2"], "--target-error: 2 is not between"),
        (
            &["--samples", "corners", "--target-error", "0.1"],
            "target_error: corners cannot be refined",
        ),
        (
            &["--mode", "raytracing", "--gi", "cached"],
            "choose a montecarlo mode",
        ),
        (&["--gi", "often"], "neither path-traced nor cached"),
    ];
    for (more, expected) in cases {
        let out = tempfile::tempdir().unwrap();
        let folder = out.path().to_str().unwrap();
        let start = [
            "render",
            "scenes/test3.ron",
            "paths/test3.ron",
            "-o",
            folder,
        ];
        let output = flythrough(&[&start, more].concat());
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(message.contains(expected), "{more:?}: {message}");
        assert!(frames(out.path()).is_empty());
    }
}
