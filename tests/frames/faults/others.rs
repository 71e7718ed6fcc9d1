//! Files of somebody else, and frames of another scene: nothing of them is destroyed unasked.

use super::batch::*;
use crate::support::project::Project;
use crate::support::*;
use std::fs;
use std::path::Path;

const SMALL: [&str; 4] = ["--size", "16x12", "--frames", "0-1"];

/// All files of a folder, by name.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            (
                entry.file_name().into_string().unwrap(),
                fs::read(entry.path()).unwrap(),
            )
        })
        .collect();
    all.sort();
    all
}

/// Runs a command that is refused, with status 2 and a message that names `what` and the flag; it leaves the folder as
/// it is. With the flag it is done.
fn needs_the_flag(arguments: &[&str], folder: &Path, what: &str) {
    let before = contents(folder);
    let output = flythrough(arguments);
    let printed = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {printed}");
    assert!(
        printed.contains(what) && printed.contains("--replace"),
        "{printed}"
    );
    assert!(contents(folder) == before, "{arguments:?}");
    let output = flythrough(&[arguments, &["--replace"]].concat());
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments:?}: {}",
        stderr(&output)
    );
    assert!(contents(folder) != before, "{arguments:?}");
}

#[test]
fn finished_frames_of_another_scene_or_path_are_kept() {
    let project = Project::new();
    let batch = Batch::new(2);
    for number in 0..3 {
        let out = project.out();
        project.render(&["--frames", "0-1"]);
        let of_project = |name: &str| {
            project
                .folder
                .path()
                .join(name)
                .to_str()
                .unwrap()
                .to_owned()
        };
        let batch_path = batch
            .folder
            .path()
            .join("p.ron")
            .to_str()
            .unwrap()
            .to_owned();
        let (scene, path) = match number {
            0 => ("scenes/test3.ron".to_owned(), batch_path),
            1 => (of_project("s.ron"), batch_path),
            _ => ("scenes/test3.ron".to_owned(), of_project("p.ron")),
        };
        let out_name = out.to_str().unwrap();
        let arguments = [&["render", &scene, &path, "-o", out_name], &SMALL[..]].concat();
        let prepare = [&arguments[..], &["--prepare", "sequence"]].concat();
        assert_eq!(flythrough(&prepare).status.code(), Some(2));
        needs_the_flag(&arguments, &out, "frame_00000.png");
        // A rerun needs no flag; an interrupted one neither.
        fs::remove_file(out.join("frame_00001.png")).unwrap();
        assert_eq!(flythrough(&arguments).status.code(), Some(0));
        fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn files_of_others_under_the_names_of_frames_are_kept() {
    for name in [
        "frame_00000.png",
        "frame_00001.png",
        "sequence.ron",
        "manifest.ron",
        "cameras.jsonl",
        "errors.csv",
        "errors.svg",
        "estimate.ron",
        "irradiance.cache",
        "sheet.png",
    ] {
        let batch = Batch::new(2);
        let out = batch.out();
        fs::create_dir(&out).unwrap();
        fs::write(out.join(name), "precious").unwrap();
        let path = batch.folder.path().join("p.ron");
        let (path, out_name) = (path.to_str().unwrap(), out.to_str().unwrap());
        let arguments = [
            &["render", "scenes/test3.ron", path, "-o", out_name],
            &SMALL[..],
        ]
        .concat();
        needs_the_flag(&arguments, &out, name);
    }
}

/// It may have taken hours, and its frames are to come.
#[test]
fn the_cache_of_another_scene_is_kept() {
    let project = Project::new();
    let batch = Batch::new(2);
    let more = [
        "--size",
        "16x12",
        "--mode",
        "montecarlo",
        "--prepare",
        "cache",
    ];
    assert_eq!(project.run("render", &more).status.code(), Some(0));
    let path = batch.folder.path().join("p.ron");
    let out = project.out();
    let arguments = [
        "render",
        "scenes/test3.ron",
        path.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
    ];
    needs_the_flag(&[&arguments[..], &more].concat(), &out, "irradiance.cache");
}

#[test]
fn pictures_and_exports_do_not_replace_files() {
    let project = Project::new();
    project.render(&["--frames", "0-1"]);
    let root = project.folder.path();
    let file = |name: &str| root.join(name).to_str().unwrap().to_owned();
    let [scene, path, out] = ["s.ron", "p.ron", "out"].map(file);
    for name in ["x.png", "x.svg", "x.json", "x.cache", "imported.ron"] {
        fs::write(root.join(name), "precious").unwrap();
    }
    needs_the_flag(&["sheet", &out, "-o", &file("x.png")], root, "x.png");
    needs_the_flag(
        &["path", "plot", &scene, &path, "-o", &file("x.svg")],
        root,
        "x.svg",
    );
    needs_the_flag(
        &["path", "export", &path, "-o", &file("x.json")],
        root,
        "x.json",
    );
    let imported = file("x.json");
    needs_the_flag(
        &["path", "import", &imported, "-o", &file("imported.ron")],
        root,
        "imported.ron",
    );
    let bake = [
        "bake",
        &scene,
        &path,
        "-o",
        &file("x.cache"),
        "--size",
        "16x12",
    ];
    needs_the_flag(&bake, root, "x.cache");
    assert_eq!(flythrough(&bake).status.code(), Some(0), "it is this cache");
    fs::write(root.join("report.md"), "precious").unwrap();
    let output = flythrough(&["report", &scene, &path, "-o", root.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let printed = stderr(&output);
    assert!(printed.contains("report.md: is there already"), "{printed}");
    // The folder's own sheet is drawn again and again, but not over somebody's picture.
    for _ in 0..2 {
        assert_eq!(flythrough(&["sheet", &out]).status.code(), Some(0));
    }
    fs::write(project.out().join("sheet.png"), "precious").unwrap();
    needs_the_flag(&["sheet", &out], &project.out(), "sheet.png");
}

/// What a change of the format or of the length leaves is named, and is no success until it is gone.
#[test]
fn leftovers_are_named_and_removed_if_asked() {
    let project = Project::new();
    let run = |more: &[&str]| project.run("render", &[&["--size", "16x12"], more].concat());
    assert_eq!(run(&[]).status.code(), Some(0));
    let output = run(&["--format", "exr"]);
    assert_eq!(output.status.code(), Some(3));
    let printed = stderr(&output);
    assert!(
        printed.contains("frame_00008.png: no frame of the sequence: render --clean removes it"),
        "{printed}"
    );
    assert_eq!(project.verify().0, Some(3));
    // A part of the sequence is rendered all the same.
    assert_eq!(
        run(&["--format", "exr", "--frames", "3"]).status.code(),
        Some(0)
    );
    fs::write(project.out().join("frame_77.png"), "precious").unwrap();
    let output = run(&["--format", "exr", "--clean"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("frame_77.png: no frame of the sequence: move it away"));
    fs::remove_file(project.out().join("frame_77.png")).unwrap();
    assert_eq!(run(&["--format", "exr", "--clean"]).status.code(), Some(0));
    assert_eq!(project.verify().0, Some(0));
    assert!(!project.file(0).exists());
}
