//! A job is kept beside its frames as data: it survives a move of the project, and other builds are told apart.

use crate::support::project::{ALL, Project};
use crate::support::{flythrough, stderr};
use flythrough::film::Film;
use flythrough::frames::{FrameFolder, SequenceRecord};
use flythrough::render::{Claim, FrameSink, RenderedFrame};
use std::fs;
use std::path::Path;
use std::process::Output;

fn run(command: &str, folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = flythrough(&[&[command, folder.to_str().unwrap()], more].concat());
    let said = [stdout, stderr].concat();
    (status.code(), String::from_utf8(said).unwrap())
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
    let (status, said) = run("audit", &out, &["--sample", "2"]);
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(run("verify", &out, &[]).0, Some(0));
    let scene = fs::read_to_string(moved.join("s.ron")).unwrap();
    fs::write(moved.join("s.ron"), scene.replace("0.5, m", "0.4, m")).unwrap();
    let (status, said) = run("verify", &out, &[]);
    assert_eq!(status, Some(3), "{said}");
    assert_eq!(said.matches(": stale").count(), ALL.len(), "{said}");
    assert_eq!(run("audit", &out, &[]).0, Some(2));
}

/// Only the frames are moved: the files that they were made from are named anew.
#[test]
fn inputs_that_are_elsewhere_are_named() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let root = project.folder.path();
    let out = root.join("far/away/frames");
    fs::create_dir_all(root.join("far/away")).unwrap();
    fs::rename(project.out(), &out).unwrap();
    let (_, said) = run("verify", &out, &[]);
    assert!(said.contains("changes since are not seen"), "{said}");
    assert_eq!(run("audit", &out, &[]).0, Some(2));
    let [scene, path] = ["s.ron", "p.ron"].map(|name| root.join(name));
    let named = [
        "--scene",
        scene.to_str().unwrap(),
        "--path",
        path.to_str().unwrap(),
    ];
    let (status, said) = run("verify", &out, &named);
    assert_eq!(status, Some(0), "{said}");
    assert!(!said.contains("changes since are not seen"), "{said}");
    let (status, said) = run("audit", &out, &named);
    assert_eq!(status, Some(0), "{said}");
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
    project.picture(7);
    assert_eq!(run("verify", &out, &named).0, Some(3));
}

/// The frames of a folder as another build would have rendered them: black.
fn rendered_by(build: &str, out: &Path) {
    let folder = FrameFolder::open(out).unwrap();
    let sequence = SequenceRecord {
        build: build.to_owned(),
        ..folder.sequence().clone()
    };
    let (width, height) = (sequence.width, sequence.height);
    let folder = FrameFolder::new(out, sequence, true);
    folder.prepare().unwrap();
    for frame in 0..folder.sequence().frames {
        let Claim::Granted(slot) = folder.claim(frame, false).unwrap() else {
            panic!("nobody else is there");
        };
        let rendered = RenderedFrame {
            film: Film::new(width, height),
            deviation: None,
            error: None,
            rays: 0,
            non_finite_samples: 0,
        };
        let encoded = folder.encode(frame, rendered).unwrap();
        folder.keep(frame, slot, &encoded).unwrap();
    }
}

#[test]
fn frames_of_another_build_are_not_taken_unasked() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let out = project.out();
    rendered_by("0123456789abcdef", &out);
    let (status, said) = project.verify();
    assert_eq!(status, Some(3));
    let lines = said.matches("rendered by build 0123456789abcdef").count();
    assert_eq!(lines, ALL.len(), "{said}");
    for command in ["missing", "sheet", "audit"] {
        let (status, said) = run(command, &out, &[]);
        assert_eq!(status, Some(2), "{command}: {said}");
        assert!(said.contains("--accept-build 0123456789abcdef"), "{said}");
    }
    // Whoever accepts them keeps them, and the folder remembers it.
    let accept = ["--accept-build", "0123456789abcdef"];
    assert_eq!(run("verify", &out, &accept).0, Some(0));
    let none: [u32; 0] = [];
    assert_eq!(project.render(&accept), none);
    assert_eq!(project.verify().0, Some(0));
    assert_eq!(project.missing(&[]), "");
    // They are not what this build renders, whatever is accepted.
    assert_eq!(run("audit", &out, &accept).0, Some(3));
    // Whoever does not, renders them again.
    assert_eq!(project.render(&[]), ALL);
    assert_eq!(run("audit", &out, &["--sample", "3"]).0, Some(0));
}

#[test]
fn builds_say_what_they_are() {
    let output = flythrough(&["--version"]);
    let said = String::from_utf8(output.stdout).unwrap();
    let build = flythrough::job::BUILD;
    assert_eq!(build.len(), 16);
    assert!(
        said.trim_end().ends_with(&format!("(build {build})")),
        "{said}"
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
    let (status, said) = run("status", &project.out(), &["--json"]);
    assert_eq!(status, Some(0));
    let json: serde_json::Value = serde_json::from_str(&said).unwrap();
    for (key, value) in [
        ("frames", serde_json::json!(9)),
        ("fps", serde_json::json!(4.0)),
        ("width", serde_json::json!(16)),
        ("height", serde_json::json!(12)),
        ("format", serde_json::json!("png")),
        ("irradiance_cache", serde_json::json!(false)),
        ("current", serde_json::json!(4)),
        ("missing", serde_json::json!("3-6,8")),
        ("worst_error", serde_json::Value::Null),
    ] {
        assert_eq!(json[key], value, "{key}");
    }
    assert_eq!(
        run("status", &project.out(), &["--get", "missing"]).1,
        "3-6,8\n"
    );
    let (status, said) = run("status", &project.out(), &["--get", "colour"]);
    assert_eq!(status, Some(2));
    assert!(said.contains("there are: build, current, format"), "{said}");
    let (_, said) = run("status", &project.out(), &[]);
    assert!(
        said.contains("9 frames at 4 per second, 16x12, png"),
        "{said}"
    );
    assert!(said.contains("missing   5 (3-6,8)"), "{said}");
    assert_eq!(run("status", project.folder.path(), &[]).0, Some(2));
}

/// Threads, order and progress decide no pixel, and no two settings are taken for each other.
#[test]
fn jobs_that_differ_in_nothing_that_counts_are_the_same() {
    let project = Project::new();
    project.render(&["--prepare", "sequence", "--seed", "0", "--samples", "2"]);
    let hashes = || {
        let folder = FrameFolder::open(&project.out()).unwrap();
        folder.sequence().input_hashes.clone()
    };
    let once = hashes();
    project.render(&["--prepare", "sequence", "--samples", "2", "-t", "1"]);
    assert_eq!(hashes(), once);
    let mut all = once;
    for more in [
        &["--samples", "3"][..],
        &["--seed", "1"],
        &["--samples", "2", "--lock-seed"],
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
