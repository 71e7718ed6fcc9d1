//! Camera paths of other programs: import of their files, and export for them.

use crate::support::{root, shipped_path};
use flythrough::camera::{Camera, FrameCameras};
use flythrough::camera_formats::{
    CameraFormat, camera_path_to_ron, camera_table, export_cameras, import_cameras,
    load_camera_path,
};
use flythrough::input::InputFiles;
use glam::{DMat3, DQuat, DVec3};
use serde_json::Value;
use std::path::PathBuf;

fn reference(name: &str) -> PathBuf {
    root().join("tests/reference/cameras").join(name)
}

/// A camera of a row-major matrix and a field of view in degrees.
fn camera(matrix: &Value, fov: &Value) -> Camera {
    let numbers = matrix.as_array().unwrap().iter();
    let m: Vec<f64> = numbers.map(|number| number.as_f64().unwrap()).collect();
    let column = |i: usize| DVec3::new(m[i], m[4 + i], m[8 + i]);
    Camera {
        position: column(3),
        rotation: DMat3::from_cols(column(0), column(1), column(2)),
        half_height: (0.5 * fov.as_f64().unwrap().to_radians()).tan(),
    }
}

fn json(name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(reference(name)).unwrap()).unwrap()
}

/// The frames per second and the cameras that a file should have.
fn truth(name: &str) -> (f64, Vec<Camera>) {
    let truth = json(name);
    let frames = truth["frames"].as_array().unwrap().iter();
    let cameras = frames.map(|frame| camera(&frame["camera_to_world"], &frame["fov"]));
    (truth["fps"].as_f64().unwrap(), cameras.collect())
}

/// The largest difference of any number of two lists of cameras.
fn difference(a: &[Camera], b: &[Camera]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b);
    let differences = pairs.map(|(a, b)| {
        let rotated = (a.rotation - b.rotation).to_cols_array().map(f64::abs);
        let rotated = rotated.into_iter().fold(0.0, f64::max);
        let moved = (a.position - b.position).abs().max_element();
        let zoomed = (a.half_height - b.half_height).abs();
        assert!(a.rotation.is_finite() && a.position.is_finite() && zoomed.is_finite());
        rotated.max(moved).max(zoomed)
    });
    differences.fold(0.0, f64::max)
}

/// The cameras of a camera path file's text.
fn loaded(text: &str) -> FrameCameras {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("path.ron");
    std::fs::write(&file, text).unwrap();
    let loaded = load_camera_path(&file, &mut InputFiles::default()).unwrap();
    FrameCameras::of(&loaded.path)
}

fn imported(bytes: &[u8], fps: Option<f64>) -> FrameCameras {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, bytes).unwrap();
    import_cameras(&file, fps, None).unwrap().frames
}

#[test]
fn blenders_cameras_are_those_of_the_specification() {
    for (name, truths) in [
        (
            "sampled.glb",
            &["sampled.truth.json", "sampled.truth60.json"][..],
        ),
        ("linear.glb", &["linear.truth.json"]),
        ("step.glb", &["step.truth.json"]),
        ("cubicspline.glb", &["cubicspline.truth.json"]),
        ("rig.gltf", &["rig.truth60.json"]),
    ] {
        for truth_name in truths {
            let (fps, expected) = truth(truth_name);
            let imported = import_cameras(&reference(name), Some(fps), None).unwrap();
            let error = difference(&imported.frames.cameras, &expected);
            assert!(error < 1e-6, "{truth_name}: {error}");
            // And so are the frames of the camera path file that is made of them.
            let text = camera_path_to_ron(&imported.frames, None, "");
            let loaded = loaded(&text);
            let error = difference(&loaded.cameras, &imported.frames.cameras);
            assert!(error < 1e-12, "{truth_name}: {error}");
            assert_eq!(loaded.cuts, imported.frames.cuts, "{truth_name}");
        }
    }
}

/// Blender writes quaternions of either sign. Interpolated as they are, as the specification has it, the camera would
/// swing by 140 degrees. The difference of 0.6 degrees that remains is in the tangents of its exporter.
#[test]
fn signs_of_quaternions_do_not_make_a_camera_swing() {
    let file = reference("cubicspline_flip.glb");
    let imported = import_cameras(&file, None, None).unwrap().frames;
    let (_, expected) = truth("cubicspline_flip.blender.json");
    let error = difference(&imported.cameras, &expected);
    assert!(error < 0.7_f64.to_radians(), "{error}");
}

#[test]
fn nerfstudios_frames_survive_import_and_export() {
    for (name, count, fps, size, tolerance) in [
        ("nerfstudio.json", 240, 30.0, (1280, 720), 1e-12),
        ("nerfstudio_loop.json", 30, 30.0, (640, 480), 1e-12),
        // Stored in single precision.
        ("nerfstudio_blender.json", 25, 24.0, (1280, 720), 1e-6),
    ] {
        let import = import_cameras(&reference(name), None, None).unwrap();
        assert_eq!(import.size, Some(size), "{name}");
        let written = json(name);
        let frames = written["camera_path"].as_array().unwrap();
        let expected = frames.iter();
        let expected = expected.map(|frame| camera(&frame["camera_to_world"], &frame["fov"]));
        let expected: Vec<Camera> = expected.collect();
        assert_eq!(expected.len(), count);
        let path = loaded(&camera_path_to_ron(
            &import.frames,
            import.size,
            "of the editor",
        ));
        assert!((path.fps - fps).abs() < 1e-12);
        let error = difference(&path.cameras, &expected);
        assert!(error < tolerance, "{name}: {error}");
        // Exported, and imported again.
        let keys = [(0.0, expected[0])];
        let text = export_cameras(CameraFormat::Nerfstudio, &path, &keys, size).unwrap();
        let error = difference(&imported(&text, None).cameras, &path.cameras);
        assert!(error < 1e-12, "{name}: {error}");
    }
}

/// The shipped paths in every format, read again.
#[test]
fn exported_paths_are_read_again() {
    for name in [
        "gallery.ron",
        "translate_rotate.ron",
        "zoom.ron",
        "test.ron",
    ] {
        let path = FrameCameras::of(&shipped_path(name));
        let text = camera_path_to_ron(&path, Some((64, 36)), "line\nline");
        let error = difference(&loaded(&text).cameras, &path.cameras);
        assert!(error < 1e-12, "{name}: {error}");

        for format in [CameraFormat::Gltf, CameraFormat::GltfBinary] {
            let bytes = export_cameras(format, &path, &[], (16, 9)).unwrap();
            let read = imported(&bytes, Some(path.fps));
            let error = difference(&read.cameras, &path.cameras);
            // Single precision, of coordinates up to 31.
            assert!(error < 2e-6, "{name}: {error}");
        }

        let table = camera_table(&path).unwrap();
        let rows = table
            .lines()
            .map(|line| -> Value { serde_json::from_str(line).unwrap() });
        let cameras = rows.enumerate().map(|(frame, row)| {
            assert_eq!(row["frame"], frame);
            let time = row["time"].as_f64().unwrap();
            assert!((time - frame as f64 / path.fps).abs() < 1e-12);
            let numbers = |key: &str| -> Vec<f64> {
                let numbers = row[key].as_array().unwrap().iter();
                numbers.map(|number| number.as_f64().unwrap()).collect()
            };
            Camera {
                position: DVec3::from_slice(&numbers("position")),
                rotation: DMat3::from_quat(DQuat::from_slice(&numbers("quaternion"))),
                half_height: (0.5 * row["fov"].as_f64().unwrap().to_radians()).tan(),
            }
        });
        let error = difference(&cameras.collect::<Vec<_>>(), &path.cameras);
        assert!(error < 1e-14, "{name}: {error}");
    }
}

/// With step interpolation the camera stands still and jumps. Each jump is a cut.
#[test]
fn steps_are_cuts() {
    let step = import_cameras(&reference("step.glb"), None, None).unwrap();
    let cameras = &step.frames.cameras;
    let jumps = (0..cameras.len() - 1).filter(|&frame| cameras[frame] != cameras[frame + 1]);
    let jumps: Vec<usize> = jumps.collect();
    assert!(!jumps.is_empty());
    assert_eq!(step.frames.cuts, jumps);
    for name in ["linear.glb", "cubicspline.glb"] {
        let smooth = import_cameras(&reference(name), None, None).unwrap();
        assert!(smooth.frames.cuts.is_empty(), "{name}");
    }
    // Steps in each of 24 frames per second are a motion that stutters, not cuts.
    let path = FrameCameras::of(&shipped_path("zoom.ron"));
    let text = export_cameras(CameraFormat::Gltf, &path, &[], (1, 1)).unwrap();
    let stepped = String::from_utf8(text).unwrap().replace("LINEAR", "STEP");
    for fps in [24.0, 60.0] {
        assert!(imported(stepped.as_bytes(), Some(fps)).cuts.is_empty());
    }
}

/// In single precision such late frames have equal times.
#[test]
fn times_that_gltf_cannot_tell_apart_are_refused() {
    let mut late = FrameCameras::of(&shipped_path("zoom.ron"));
    for (start, fps, is_refused) in [
        (0.0, 24.0, false),
        (3600.0, 24.0, false),
        (1e5, 24.0, true),
        (-1e5, 240.0, true),
    ] {
        (late.start, late.fps) = (start, fps);
        let written = export_cameras(CameraFormat::GltfBinary, &late, &[], (1, 1));
        let refusal = written.err().map(|error| error.to_string());
        assert_eq!(refusal.is_some(), is_refused, "{start}");
        assert!(refusal.is_none_or(|printed| printed.contains("single precision")));
    }
}

/// A key so late that its frames could not be counted.
#[test]
fn endless_animations_are_refused() {
    let mut file = std::fs::read(reference("step.glb")).unwrap();
    let last = file
        .windows(4)
        .rposition(|bytes| bytes == 1.0416666_f32.to_le_bytes());
    let last = last.unwrap();
    file[last..last + 4].copy_from_slice(&1e14_f32.to_le_bytes());
    let folder = tempfile::tempdir().unwrap();
    let late = folder.path().join("late.glb");
    std::fs::write(&late, file).unwrap();
    let error = import_cameras(&late, None, None).unwrap_err().to_string();
    assert!(
        error.ends_with("animations: give more than 10000000 frames"),
        "{error}"
    );
}

/// Files that are truncated anywhere, or with any byte changed, are refused or read without a panic.
#[test]
fn no_damage_panics() {
    let folder = tempfile::tempdir().unwrap();
    let damaged = folder.path().join("damaged");
    std::fs::copy(reference("rig.bin"), folder.path().join("rig.bin")).unwrap();
    for name in ["sampled.glb", "cubicspline.glb", "rig.gltf"] {
        let whole = std::fs::read(reference(name)).unwrap();
        let mut refused = 0;
        for position in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[position] = match position % 3 {
                0 => b'9',
                1 => b'-',
                _ => 0xff,
            };
            for bytes in [&whole[..position], &bytes] {
                std::fs::write(&damaged, bytes).unwrap();
                refused += u32::from(import_cameras(&damaged, None, None).is_err());
            }
        }
        assert!(refused as usize > whole.len(), "{name}");
    }
}

#[test]
fn refusals_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    let refusal = |text: &str| {
        std::fs::write(&file, text).unwrap();
        let error = import_cameras(&file, None, None).unwrap_err().to_string();
        error.replace(&format!("{}: ", file.display()), "")
    };
    let frames = |fields: &str, frame: &str| {
        format!("{{{fields}, \"camera_path\": [{{\"camera_to_world\": {frame}}}]}}")
    };
    let identity = "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]";
    let seconds = "\"seconds\": 1";
    for (text, expected) in [
        ("{}".to_owned(), "file: neither a camera_path.json"),
        ("#!/bin/sh".to_owned(), "file: neither a camera_path.json"),
        (
            format!("{{{seconds}, \"camera_path\": []}}"),
            "camera_path: has no frames",
        ),
        (
            frames("\"a\": 1", &format!("{identity}, \"fov\": 50")),
            "seconds: is missing",
        ),
        (
            frames(seconds, &format!("{identity}, \"fov\": 180")),
            "camera_path[0].fov: 180 degrees",
        ),
        (
            frames(seconds, "[1, 2], \"fov\": 50"),
            "camera_path[0].camera_to_world: is not 16",
        ),
        (
            frames(seconds, "[2,0,0,0, 0,2,0,0, 0,0,2,0, 0,0,0,1], \"fov\": 50"),
            "camera_path[0].camera_to_world: turns and scales",
        ),
        (
            frames(
                "\"seconds\": 1, \"camera_type\": \"fisheye\"",
                &format!("{identity}, \"fov\": 50"),
            ),
            "camera_type: \"fisheye\"",
        ),
        (
            frames(
                "\"seconds\": 1, \"render_width\": 99999, \"render_height\": 1",
                &format!("{identity}, \"fov\": 50"),
            ),
            "render_width, render_height: 99999 is not between 1 and 32768",
        ),
        (
            "\u{feff}{\"camera_path\": [".to_owned(),
            ":1:17: EOF while parsing a list",
        ),
        (
            "glTF\u{2}\0\0\0\0\0\0\0".to_owned(),
            "glTF: is no binary glTF 2.0 file, or is cut short",
        ),
        (
            "{\"asset\": {\"version\": \"2.0\"}}".to_owned(),
            "cameras: there is none",
        ),
        (
            "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"camera\": 7}]}".to_owned(),
            "glTF: ",
        ),
        (
            "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"camera\": 0, \"name\": \"a\"},
              {\"camera\": 0, \"name\": \"b\"}], \"cameras\": [{\"type\": \"perspective\",
              \"perspective\": {\"yfov\": 1, \"znear\": 0.1}}]}"
                .to_owned(),
            "cameras: choose one by --camera: \"a\", \"b\"",
        ),
    ] {
        let message = refusal(&text);
        assert!(message.contains(expected), "{text}: {message}");
    }
}
