//! The record of a job beside its frames: projects can be moved, and frames of other builds are recognised.

use crate::support::project::{ALL, Project};
use crate::support::{flythrough, stderr};
use flythrough::film::Film;
use flythrough::frames::{FrameFolder, SequenceRecord};
use flythrough::render::{Claim, ErrorEstimate, FrameErrorEstimate, FrameSink, RenderedFrame};
use std::fs;
use std::path::Path;
use std::process::Output;

fn run(command: &str, folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = flythrough(&[&[command, folder.to_str().unwrap()], more].concat());
    let printed = [stdout, stderr].concat();
    (status.code(), String::from_utf8(printed).unwrap())
}

#[test]
fn a_project_can_be_moved() {
    let project = Project::new();
    assert_eq!(project.render(&["--mode", "montecarlo"]), ALL);
    let record = fs::read_to_string(project.out().join("sequence.ron")).unwrap();
    let root = project.folder.path();
    assert!(!record.contains(root.to_str().unwrap()), "{record}");
    let moved = root.join("elsewhere/deeper");
    fs::create_dir_all(&moved).unwrap();
    for name in ["s.ron", "p.ron", "m.obj", "t.png", "out"] {
        fs::rename(root.join(name), moved.join(name)).unwrap();
    }
    let out = moved.join("out");
    let (status, printed) = run("audit", &out, &["--sample", "2"]);
    assert_eq!(status, Some(0), "{printed}");
    assert_eq!(run("verify", &out, &[]).0, Some(0));
    let scene = fs::read_to_string(moved.join("s.ron")).unwrap();
    fs::write(moved.join("s.ron"), scene.replace("0.5, m", "0.4, m")).unwrap();
    let (status, printed) = run("verify", &out, &[]);
    assert_eq!(status, Some(3), "{printed}");
    assert_eq!(printed.matches(": stale").count(), ALL.len(), "{printed}");
    assert_eq!(run("audit", &out, &[]).0, Some(2));
}

/// Only the frames are moved; flags name the files that they were made from.
#[test]
fn inputs_that_are_elsewhere_are_named() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let root = project.folder.path();
    let out = root.join("far/away/frames");
    fs::create_dir_all(root.join("far/away")).unwrap();
    fs::rename(project.out(), &out).unwrap();
    let (status, printed) = run("verify", &out, &[]);
    assert_eq!(status, Some(2), "{printed}");
    assert!(printed.contains("p.ron: cannot be read"), "{printed}");
    assert_eq!(run("verify", &out, &["--as-recorded"]).0, Some(0));
    assert_eq!(run("audit", &out, &[]).0, Some(2));
    let [scene, path] = ["s.ron", "p.ron"].map(|name| root.join(name));
    let named = [
        "--scene",
        scene.to_str().unwrap(),
        "--path",
        path.to_str().unwrap(),
    ];
    let (status, printed) = run("verify", &out, &named);
    assert_eq!(status, Some(0), "{printed}");
    let (status, printed) = run("audit", &out, &named);
    assert_eq!(status, Some(0), "{printed}");
    // A render from there records where they are now.
    let arguments = [
        "render",
        named[1],
        named[3],
        "--size",
        "16x12",
        "-o",
        out.to_str().unwrap(),
    ];
    let rendered = flythrough(&arguments);
    assert_eq!(rendered.status.code(), Some(0), "{}", stderr(&rendered));
    project.write_texture(7);
    assert_eq!(run("verify", &out, &named).0, Some(3));
}

/// Replaces frames of a folder by black ones with a correct record, of a build.
pub(crate) fn replace_frames(out: &Path, frames: &[u32], build: &str) {
    let folder = FrameFolder::open(out).unwrap();
    let sequence = SequenceRecord {
        build: build.to_owned(),
        ..folder.sequence().clone()
    };
    let (width, height) = (sequence.width, sequence.height);
    let folder = FrameFolder::new(out, sequence, true);
    folder.prepare().unwrap();
    for &frame in frames {
        let Claim::Granted(lock) = folder.claim(frame, false).unwrap() else {
            panic!("nobody else is there");
        };
        let rendered = RenderedFrame {
            film: Film::new(width, height),
            half_difference: None,
            expected_errors: Vec::new(),
            cache_errors: None,
            display_white: 1.0,
            error: FrameErrorEstimate {
                whole: ErrorEstimate {
                    rel_mse: 0.0,
                    standard_error: 0.0,
                },
                worst_block: 0.0,
                blurred: 0.0,
            },
            rays: 0,
            non_finite_samples: 0,
        };
        let encoded = folder.encode(frame, rendered).unwrap();
        folder.store(frame, lock, &encoded).unwrap();
    }
}

#[test]
fn frames_of_another_build_are_used_only_if_accepted() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let out = project.out();
    replace_frames(&out, &ALL, "0123456789abcdef");
    let (status, printed) = project.verify();
    assert_eq!(status, Some(3));
    let lines = printed
        .matches("rendered by build 0123456789abcdef")
        .count();
    assert_eq!(lines, ALL.len(), "{printed}");
    for command in ["missing", "sheet", "audit"] {
        let (status, printed) = run(command, &out, &[]);
        assert_eq!(status, Some(2), "{command}: {printed}");
        assert!(
            printed.contains("--accept-build 0123456789abcdef"),
            "{printed}"
        );
    }
    // Accepted frames are kept, and the folder records that they are.
    let accept = ["--accept-build", "0123456789abcdef"];
    assert_eq!(run("verify", &out, &accept).0, Some(0));
    let none: [u32; 0] = [];
    assert_eq!(project.render(&accept), none);
    assert_eq!(project.verify().0, Some(0));
    assert_eq!(project.missing(&[]), "");
    // `audit` finds that this build renders other frames.
    assert_eq!(run("audit", &out, &accept).0, Some(3));
    // Unless they are accepted they are rendered again.
    assert_eq!(project.render(&[]), ALL);
    assert_eq!(run("audit", &out, &["--sample", "3"]).0, Some(0));
}

#[test]
fn the_build_is_in_the_version_and_in_every_frame() {
    let output = flythrough(&["--version"]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let build = flythrough::job::BUILD;
    assert_eq!(build.len(), 16);
    assert!(
        printed.trim_end().ends_with(&format!("(build {build})")),
        "{printed}"
    );
    let project = Project::new();
    project.render(&["--frames", "0"]);
    let file = fs::read(project.file(0)).unwrap();
    assert!(file.windows(16).any(|bytes| bytes == build.as_bytes()));
}

#[test]
fn status_is_for_scripts_and_people() {
    let project = Project::new();
    project.render(&["--frames", "0-2,7"]);
    let (status, printed) = run("status", &project.out(), &["--json"]);
    assert_eq!(status, Some(0));
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    for (key, value) in [
        ("frames", serde_json::json!(9)),
        ("fps", serde_json::json!(4.0)),
        ("width", serde_json::json!(16)),
        ("height", serde_json::json!(12)),
        ("format", serde_json::json!("png")),
        ("irradiance_cache", serde_json::json!(false)),
        ("current", serde_json::json!(4)),
        ("missing", serde_json::json!("3-6,8")),
    ] {
        assert_eq!(json[key], value, "{key}");
    }
    assert_eq!(
        run("status", &project.out(), &["--get", "missing"]).1,
        "3-6,8\n"
    );
    let (status, printed) = run("status", &project.out(), &["--get", "colour"]);
    assert_eq!(status, Some(2));
    assert!(
        printed.contains("there are: build, current, format"),
        "{printed}"
    );
    let (_, printed) = run("status", &project.out(), &[]);
    assert!(
        printed.contains("9 frames at 4 per second, 16x12, png"),
        "{printed}"
    );
    assert!(printed.contains("missing   5 (3-6,8)"), "{printed}");
    assert_eq!(run("status", project.folder.path(), &[]).0, Some(2));
}

/// Seed 0 is the default and threads change no pixel; any two other settings have different hashes.
#[test]
fn input_hashes_differ_exactly_if_pixels_may() {
    let project = Project::new();
    project.render(&["--prepare", "sequence", "--seed", "0", "--samples", "2"]);
    let hashes = || {
        let folder = FrameFolder::open(&project.out()).unwrap();
        folder.sequence().input_hashes.clone()
    };
    let first = hashes();
    for same in [
        &["--threads", "1"][..],
        &["--order", "coarse-to-fine"],
        &["--quiet"],
        &["--progress", "openjd"],
        &["--mode", "raytracing"],
        &["--bounces", "4"],
    ] {
        project.render(&[&["--prepare", "sequence", "--samples", "2"], same].concat());
        assert_eq!(hashes(), first, "{same:?}");
    }
    let mut all = first;
    for more in [
        &["--samples", "3"][..],
        &["--seed", "1"],
        &["--samples", "2", "--lock-seed"],
        &["--samples", "2", "--bounces", "3"],
        &["--samples", "2", "--format", "png16"],
        &["--samples", "2", "--exposure", "0.5"],
        &["--samples", "2", "--format", "exr"],
        &["--samples", "2", "--size", "12x16"],
        &["--mode", "supersampling"],
        &["--mode", "montecarlo", "--gi", "path-traced"],
        &["--mode", "montecarlo", "--gi", "cached"],
        &[
            "--mode",
            "montecarlo",
            "--gi",
            "path-traced",
            "--splits",
            "2",
        ],
    ] {
        project.render(&[&["--prepare", "sequence"], more].concat());
        all.extend(hashes());
    }
    let count = all.len();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), count);
}
