//! `flythrough path`, and the table of cameras that `render` leaves.

use crate::support::project::Project;
use crate::support::{flythrough, root, stderr};
use glam::{DVec3, DVec4};
use serde::Deserialize;
use std::path::Path;

fn run(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = flythrough(arguments);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    (output.status.code(), said, stderr(&output))
}

fn text(file: &Path) -> String {
    std::fs::read_to_string(file).unwrap()
}

/// A path goes out in every format, comes back, and its frames are the same.
#[test]
fn paths_go_out_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let name = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let table = |path: &str, out: &str| {
        export(path, &name(out));
        let text = text(&folder.path().join(out));
        let lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
        lines.collect::<Vec<Line>>()
    };
    let expected = table("paths/zoom.ron", "zoom.jsonl");
    assert_eq!(expected.len(), 55);
    for (format, fps, tolerance) in [
        ("zoom.json", None, 1e-12),
        ("zoom.gltf", Some("24"), 1e-6),
        ("zoom.GLB", Some("24"), 1e-6),
    ] {
        export("paths/zoom.ron", &name(format));
        let (from, path) = (name(format), name("back.ron"));
        let fps = fps.map(|fps| vec!["--fps", fps]).unwrap_or_default();
        let import = [&["path", "import", &from, "--force", "-o", &path], &fps[..]].concat();
        let (status, said, error) = run(&import);
        assert_eq!(status, Some(0), "{error}");
        assert!(
            said.contains("55 frames at 24 per second, 2.25 s"),
            "{said}"
        );
        let back = table(&path, "back.jsonl");
        assert_eq!(back.len(), 55);
        for (a, b) in expected.iter().zip(&back) {
            assert_eq!(a.frame, b.frame);
            assert!((a.time - b.time).abs() < tolerance);
            assert!(a.position.abs_diff_eq(b.position, 4.0 * tolerance));
            // Either sign is the same rotation.
            let agrees = a.quaternion.dot(b.quaternion).abs();
            assert!((agrees - 1.0).abs() < tolerance, "{format}: {a:?} {b:?}");
            assert!((a.fov - b.fov).abs() < 60.0 * tolerance);
        }
    }
}

#[derive(Debug, Deserialize)]
struct Line {
    frame: u32,
    time: f64,
    position: DVec3,
    quaternion: DVec4,
    fov: f64,
}

fn export(path: &str, out: &str) {
    let (status, _, error) = run(&["path", "export", path, "-o", out, "--force"]);
    assert_eq!(status, Some(0), "{error}");
}

#[test]
fn files_are_not_lost_to_an_import_or_export() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("path.ron");
    std::fs::write(&file, "by hand").unwrap();
    let (from, out) = (
        "tests/reference/cameras/nerfstudio_loop.json",
        file.to_str().unwrap(),
    );
    let table = file.with_extension("jsonl");
    std::fs::write(&table, "by hand").unwrap();
    for (what, from, out) in [
        ("import", from, &file),
        ("export", "paths/zoom.ron", &table),
    ] {
        let (status, _, error) = run(&["path", what, from, "-o", out.to_str().unwrap()]);
        assert_eq!(status, Some(2));
        assert!(error.contains("is there already"), "{error}");
        assert_eq!(text(out), "by hand");
    }
    let (status, ..) = run(&["path", "import", from, "-o", out, "--force"]);
    assert_eq!(status, Some(0));
    assert!(text(&file).starts_with("// The camera of nerfstudio_loop.json"));
}

#[test]
fn what_cannot_be_exported_or_imported_says_why() {
    for (arguments, expected) in [
        (
            &["export", "paths/zoom.ron", "-o", "zoom.usd"][..],
            "name it .json, .gltf, .glb or .jsonl",
        ),
        (
            &["export", "paths/none.ron", "-o", "zoom.json"],
            "paths/none.ron: cannot be read",
        ),
        (
            &["import", "paths/zoom.ron", "-o", "/nonexistent/x.ron"],
            "neither a camera_path.json",
        ),
        (
            &[
                "import",
                "tests/reference/cameras/step.glb",
                "-o",
                "x.ron",
                "--camera",
                "B",
            ],
            "choose one by --camera: \"ShotCam\"",
        ),
        (
            &[
                "import",
                "tests/reference/cameras/nerfstudio_loop.json",
                "-o",
                "x.ron",
                "--fps",
                "25",
            ],
            "leave --fps and --camera out",
        ),
    ] {
        let (status, _, error) = run(&[&["path"], arguments].concat());
        assert_eq!(status, Some(2), "{arguments:?}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
    }
    assert!(!root().join("x.ron").exists());
}

/// The table is of what was rendered, and made again if it is lost.
#[test]
fn render_leaves_a_table_of_cameras() {
    let project = Project::new();
    project.render(&[]);
    let table = project.out().join("cameras.jsonl");
    let written = text(&table);
    assert_eq!(written.lines().count(), 9);
    let first = "{\"frame\":0,\"time\":0.0,\"position\":[-0.2,0.0,3.0],\"quaternion\":[0.0,0.0,0.0,1.0],\"fov\":45.0}";
    assert_eq!(written.lines().next(), Some(first));
    std::fs::remove_file(&table).unwrap();
    assert!(project.render(&[]).is_empty());
    assert_eq!(text(&table), written);
    assert_eq!(project.verify().0, Some(0));
}
