//! What is said of the shipped paths, and of walks through what stands in the shipped gallery.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use flythrough::camera::CameraPath;
use flythrough::input::{InputFiles, load_camera_path};
use flythrough::preflight::{Oddity, preflight};
use support::{shipped_path, shipped_scene};

const NEAR: f64 = 0.1;

/// Four seconds straight along -Z.
fn walk([x, y]: [f64; 2], from: f64, to: f64) -> CameraPath {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("path.ron");
    let key = |time: f64, z: f64| {
        let position = format!("position: ({x}, {y}, {z})");
        format!(
            "(time: {time:?}, {position}, look_at: ({x}, {y}, {:?}), fov: 50),",
            z - 100.0
        )
    };
    let keys = key(0.0, from) + &key(4.0, to);
    let text = format!("CameraPath(fps: 24, interpolation: linear, keyframes: [{keys}])");
    std::fs::write(&file, text).unwrap();
    load_camera_path(&file, &mut InputFiles::default())
        .unwrap()
        .path
}

#[test]
fn shipped_paths_touch_nothing_and_are_smooth() {
    for (scene, path) in [
        ("gallery.ron", "gallery.ron"),
        ("test2.ron", "translate_rotate.ron"),
        ("test2.ron", "zoom.ron"),
        ("test3.ron", "test3.ron"),
        ("test.ron", "test.ron"),
        ("test1.ron", "test.ron"),
    ] {
        let path = shipped_path(path);
        for finding in preflight(&shipped_scene(scene), &path, 1280, 720, NEAR) {
            let is_harmless =
                matches!(finding.kind, Oddity::Strobing { .. } | Oddity::RepeatsFirst);
            assert!(is_harmless, "{scene}: {finding}");
        }
    }
}

/// A sphere, a mesh whose faces look outward and one whose faces look inward and that is open at its foot.
#[test]
fn walks_through_exhibits_are_found() {
    let scene = shipped_scene("gallery.ron");
    let globe = (walk([-1.7, 1.4], -13.0, -15.0), -13.6, -14.4);
    let pedestal = (walk([1.7, 0.5], -9.0, -11.0), -9.74, -10.26);
    let figure = (walk([1.7, 1.5], -9.0, -11.0), -9.74, -10.26);
    for (path, first, last) in [globe, pedestal, figure] {
        let found = preflight(&scene, &path, 1280, 720, NEAR);
        assert!(matches!(found[0].kind, Oddity::Inside { .. }), "{found:?}");
        let &[[enters, leaves]] = found[0].frames.runs() else {
            panic!("{found:?}")
        };
        let z = |frame: u32| path.camera(frame).position.z;
        assert!((z(enters) - first).abs() < 0.03, "{}", z(enters));
        assert!((z(leaves) - last).abs() < 0.03, "{}", z(leaves));
        assert_eq!(found[1].kind, Oddity::Through);
        assert_eq!(found[1].frames.runs(), [[enters - 1; 2], [leaves; 2]]);
        assert!(matches!(found[2].kind, Oddity::Near { .. }));
    }
    let beside = walk([0.0, 1.7], 1.2, -4.0);
    assert_eq!(preflight(&scene, &beside, 1280, 720, NEAR), []);
}
