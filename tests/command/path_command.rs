//! `flythrough path import` and `export`, and the table of cameras that `render` writes.

use crate::support::project::Project;
use crate::support::{flythrough, root, stderr};
use std::path::Path;

fn run(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = flythrough(arguments);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    (output.status.code(), printed, stderr(&output))
}

fn text(file: &Path) -> String {
    std::fs::read_to_string(file).unwrap()
}

/// What the files hold is compared in tests/input/camera_files.rs.
#[test]
fn exported_paths_can_be_imported() {
    let folder = tempfile::tempdir().unwrap();
    let name = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (format, more) in [
        ("zoom.json", &[][..]),
        ("zoom.gltf", &["--fps", "24"]),
        ("zoom.GLB", &["--fps", "24"]),
    ] {
        export("paths/zoom.ron", &name(format));
        let (from, path) = (name(format), name("back.ron"));
        let import = [&["path", "import", &from, "--force", "-o", &path], more].concat();
        let (status, printed, error) = run(&import);
        assert_eq!(status, Some(0), "{error}");
        assert!(
            printed.contains("133 frames at 24 per second, 5.50 s"),
            "{printed}"
        );
        export(&path, &name("back.jsonl"));
        let table = text(&folder.path().join("back.jsonl"));
        assert_eq!(table.lines().count(), 133);
    }
}

fn export(path: &str, out: &str) {
    let (status, _, error) = run(&["path", "export", path, "-o", out, "--force"]);
    assert_eq!(status, Some(0), "{error}");
}

#[test]
fn import_and_export_do_not_overwrite_files() {
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
fn exports_and_imports_that_fail_say_why() {
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

/// The table is of the rendered path, and is written again if it is lost.
#[test]
fn render_writes_a_table_of_cameras() {
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
