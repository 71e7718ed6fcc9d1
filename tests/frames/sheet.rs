//! Contact sheets and previews of a sequence.

use crate::support::project::{ALL, KEYS, Project, frame_inodes, keys};
use crate::support::*;
use flythrough::math::color::srgb_to_linear;
use glam::Vec3;
use image::{Rgb, RgbImage};
use std::fs;
use std::path::{Path, PathBuf};

/// Blue to the right of a line and yellow to the left of it. In 41 frames the line goes from the right edge of the
/// picture to the left one.
fn rendered(more: &[&str]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let scene = "Scene(
        background: (0.9, 0.7, 0.1),
        ambient: (1, 1, 3),
        materials: {\"blue\": (diffuse: (0.3, 0.3, 1))},
        objects: [triangle(vertices: [(0, -99, 0), (99, 0, 0), (0, 99, 0)], material: \"blue\")],
    )";
    fs::write(file("s.ron"), scene).unwrap();
    let path = "CameraPath(fps: 20, interpolation: linear, keyframes: [
        (time: 0, position: (-1.5, 0, 2), look_at: (-1.5, 0, 0), fov: 45),
        (time: 2, position: (1.5, 0, 2), look_at: (1.5, 0, 0), fov: 45),
    ])";
    fs::write(file("p.ron"), path).unwrap();
    let [scene, path, out] = ["s.ron", "p.ron", "out/frames"].map(file);
    let arguments = ["render", &scene, &path, "-o", &out, "--size", "480x240"];
    let output = flythrough(&[&arguments, more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    (folder, PathBuf::from(out))
}

fn sheet(folder: &Path, more: &[&str]) -> RgbImage {
    let output = flythrough(&[&["sheet", folder.to_str().unwrap()], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let named = String::from_utf8(output.stdout).unwrap();
    image::open(named.trim_end()).unwrap().into_rgb8()
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Rectangle {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
}

/// The tiles of a sheet, row by row: rectangles without a background pixel, wider than any letter.
fn tiles(sheet: &RgbImage) -> Vec<Rectangle> {
    let background = *sheet.get_pixel(0, 0);
    let mut tiles: Vec<Rectangle> = Vec::new();
    for y in 0..sheet.height() {
        let mut left = 0;
        for x in 0..=sheet.width() {
            if x < sheet.width() && *sheet.get_pixel(x, y) != background {
                continue;
            }
            let width = x - left;
            let grows = |tile: &&mut Rectangle| {
                (tile.left, tile.width, tile.top + tile.height) == (left, width, y)
            };
            if let Some(tile) = tiles.iter_mut().find(grows) {
                tile.height += 1;
            } else if width > 60 {
                tiles.push(Rectangle {
                    left,
                    top: y,
                    width,
                    height: 1,
                });
            }
            left = x + 1;
        }
    }
    tiles
}

/// The mean linear colour of a part of a picture.
fn mean(picture: &RgbImage, part: Rectangle) -> Vec3 {
    let linear = |code: u8| srgb_to_linear(f32::from(code) / 255.0);
    let mut sum = Vec3::ZERO;
    for y in part.top..part.top + part.height {
        for x in part.left..part.left + part.width {
            sum += Vec3::from(picture.get_pixel(x, y).0.map(linear));
        }
    }
    sum / (part.width * part.height) as f32
}

#[test]
fn tiles_show_frames_spread_over_the_path() {
    let (_folder, out) = rendered(&[]);
    let light_of = |frame: usize| {
        let frame = image::open(out.join(format!("frame_{frame:05}.png"))).unwrap();
        let whole = Rectangle {
            left: 0,
            top: 0,
            width: 480,
            height: 240,
        };
        mean(&frame.into_rgb8(), whole)
    };
    let light: Vec<Vec3> = (0..41).map(light_of).collect();
    for (more, shown) in [
        (
            &[][..],
            (0..30)
                .map(|i| (f64::from(i) * 40.0 / 29.0).round() as usize)
                .collect::<Vec<_>>(),
        ),
        (&["--frames", "3,10-16:2,40"], vec![3, 10, 12, 14, 16, 40]),
    ] {
        let sheet = sheet(&out, more);
        let tiles = tiles(&sheet);
        assert_eq!(tiles.len(), shown.len(), "{tiles:?}");
        for (tile, frame) in tiles.into_iter().zip(shown) {
            assert_eq!((tile.width, tile.height), (240, 120));
            let error = (mean(&sheet, tile) - light[frame]).abs().max_element();
            // A fifth of the difference from one frame to the next.
            assert!(error < 0.003, "{frame}: {error}");
        }
    }
    for pair in light.windows(2) {
        assert!((pair[0] - pair[1]).abs().max_element() > 0.015, "{pair:?}");
    }
}

#[test]
fn frames_of_all_formats_look_the_same() {
    let of = |format: &str| {
        let (_folder, out) = rendered(&["--format", format, "--exposure", "1"]);
        sheet(&out, &[])
    };
    let png = of("png");
    for format in ["png16", "exr"] {
        let other = of(format);
        assert_eq!(other.dimensions(), png.dimensions());
        let codes = other.as_raw().iter().zip(png.as_raw());
        let difference = codes.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(difference <= 1, "{format}: {difference}");
    }
}

#[test]
fn missing_and_damaged_frames_have_empty_tiles() {
    let (_folder, out) = rendered(&[]);
    let whole = sheet(&out, &[]);
    let tiles = tiles(&whole);
    fs::remove_file(out.join("frame_00000.png")).unwrap();
    let truncated = out.join("frame_00040.png");
    let bytes = fs::read(&truncated).unwrap();
    fs::write(&truncated, &bytes[..bytes.len() / 2]).unwrap();
    let before = frames(&out);
    let damaged = sheet(&out, &[]);
    assert_eq!(frames(&out), before);
    assert_eq!(damaged.dimensions(), whole.dimensions());
    let damaged_tiles = [tiles[0], tiles[29]];
    for (x, y, pixel) in damaged.enumerate_pixels() {
        let inside = |tile: &Rectangle| {
            (tile.left..tile.left + tile.width).contains(&x)
                && (tile.top..tile.top + tile.height).contains(&y)
        };
        let is_same = pixel == whole.get_pixel(x, y);
        assert!(is_same || damaged_tiles.iter().any(inside), "{x} {y}");
    }
    for tile in damaged_tiles {
        let corner = *damaged.get_pixel(tile.left, tile.top);
        assert_ne!(corner, *damaged.get_pixel(0, 0));
        let pixels = (0..tile.width * tile.height)
            .map(|i| *damaged.get_pixel(tile.left + i % tile.width, tile.top + i / tile.width));
        let letters = pixels.filter(|pixel: &Rgb<u8>| *pixel != corner).count();
        assert!((100..3000).contains(&letters), "{letters}");
    }
    // `verify` does not take the sheet for a frame.
    let verified = flythrough(&["verify", out.to_str().unwrap()]);
    let printed = String::from_utf8(verified.stdout).unwrap();
    assert_eq!(printed.lines().count(), 3, "{printed}");
}

#[test]
fn sheets_need_a_folder_of_frames_and_replace_none_of_its_files() {
    let nothing = tempfile::tempdir().unwrap();
    let output = flythrough(&["sheet", nothing.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("sequence.ron"));
    assert_eq!(fs::read_dir(nothing.path()).unwrap().count(), 0);

    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let before = files(&project.out());
    let out = project.out().to_str().unwrap().to_owned();
    for name in [
        "frame_00003.png",
        "frame_00099.png",
        "sequence.ron",
        "irradiance.cache",
    ] {
        let file = format!("{out}/../out/{name}");
        let output = flythrough(&["sheet", &out, "-o", &file]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(
            stderr(&output).contains("use another"),
            "{}",
            stderr(&output)
        );
    }
    assert_eq!(files(&project.out()), before);
    let elsewhere = format!("{}/frame_00003.png", nothing.path().display());
    sheet(&project.out(), &["-o", &elsewhere]);

    let leftover = project.out().join(".sheet.png.0123456789abcdef.part");
    fs::write(&leftover, "half").unwrap();
    project.render(&["--force", "--frames", "0"]);
    assert!(!leftover.exists());
}

/// The files in a folder with their bytes, in order.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.is_file());
    let mut files: Vec<_> = files
        .map(|path| (path.clone(), fs::read(path).unwrap()))
        .collect();
    files.sort();
    files
}

const COSTLY_SETTINGS: &str =
    "settings: (mode: \"montecarlo-supersampling\", size: (640, 480), samples: 3, splits: [2, 1],
    gi: \"cached\", target_error: 0.5, bounces: 2),";

/// A project whose path sets everything that a preview ignores.
fn costly_project() -> Project {
    let project = Project::new();
    let path = keys(&KEYS).replace("keyframes", &format!("{COSTLY_SETTINGS} keyframes"));
    project.write("p.ron", path.as_bytes());
    project
}

fn status(command: &str, folder: &Path) -> (Option<i32>, String) {
    let output = flythrough(&[command, folder.to_str().unwrap()]);
    (
        output.status.code(),
        String::from_utf8(output.stdout).unwrap(),
    )
}

#[test]
fn a_preview_is_small_and_ray_traced_and_leaves_frames_alone() {
    let project = costly_project();
    assert_eq!(project.render(&["--frames", "0-4"]), [0, 1, 2, 3, 4]);
    let finished = files(&project.out());
    let preview = project.out().join("preview");
    let output = project.run("render", &["--preview"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    let sheet = preview.join("sheet.png");
    assert!(
        printed.contains(&format!("contact sheet: {}", sheet.display())),
        "{printed}"
    );
    assert_eq!(
        tiles(&image::open(&sheet).unwrap().into_rgb8()).len(),
        ALL.len()
    );
    assert_eq!(files(&project.out()), finished);

    // The same by flags, without settings in the files.
    let plain = Project::new();
    plain.render(&[
        "--size",
        "320x240",
        "--mode",
        "raytracing",
        "--bounces",
        "2",
    ]);
    assert_eq!(frames(&preview), frames(&plain.out()));

    assert_eq!(status("verify", &preview).0, Some(0));
    assert_eq!(status("audit", &preview).0, Some(0));
    assert_eq!(status("missing", &preview), (Some(0), String::new()));
    let inodes = frame_inodes(&preview);
    project.run("render", &["--preview"]);
    assert_eq!(frame_inodes(&preview), inodes);

    fs::remove_file(preview.join("frame_00003.png")).unwrap();
    assert_eq!(status("missing", &preview), (Some(0), "3\n".to_owned()));
    project.run("render", &["--preview", "--frames", "3", "--quiet"]);
    assert_eq!(status("verify", &preview).0, Some(0));
    let of_one = image::open(&sheet).unwrap().into_rgb8();
    assert_eq!(tiles(&of_one).len(), 1);

    // `verify` reads the inputs of a preview with the settings of a preview.
    let moved = keys(&[KEYS[0], KEYS[1], (2.0, 0.4)])
        .replace("keyframes", &format!("{COSTLY_SETTINGS} keyframes"));
    project.write("p.ron", moved.as_bytes());
    let (code, printed) = status("verify", &preview);
    assert_eq!(
        (code, printed.matches(": stale").count()),
        (Some(3), 4),
        "{printed}"
    );
}

#[test]
fn a_preview_takes_no_settings_and_replaces_no_finished_frames() {
    let project = costly_project();
    for more in [
        &["--mode", "montecarlo"][..],
        &["--size", "64x48"],
        &["--samples", "4"],
        &["--splits", "2"],
        &["--target-error", "0.1"],
        &["--gi", "cached"],
        &["--gi-cache", "light"],
        &["--budget", "2h"],
        &["--aov", "error"],
        &["--prepare", "sequence"],
    ] {
        let output = project.run("render", &[&["--preview"], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(stderr(&output).contains("cannot be used with"), "{more:?}");
        assert!(!project.out().exists(), "{more:?}");
    }
    let finished = project.out().join("preview");
    let [scene, path] = ["s.ron", "p.ron"].map(|name| project.folder.path().join(name));
    let names = [&scene, &path, &finished].map(|name| name.to_str().unwrap());
    let [scene, path, out] = names;
    let arguments = ["render", scene, path, "-o", out, "-s", "16x12", "-f", "0"];
    assert_eq!(flythrough(&arguments).status.code(), Some(0));
    let before = files(&finished);
    let output = project.run("render", &["--preview"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("use another"),
        "{}",
        stderr(&output)
    );
    assert_eq!(files(&finished), before);
}
