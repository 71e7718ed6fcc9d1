//! Preflight warnings of paths through the exhibits of the shipped gallery.

use crate::support::shipped_scene;
use flythrough::camera::CameraPath;
use flythrough::camera_formats::parse_camera_path;
use flythrough::preflight::{WarningKind, preflight};
use std::path::Path;

const NEAR: f64 = 0.1;

fn loaded(text: &str) -> CameraPath {
    parse_camera_path(Path::new("path.ron"), text.as_bytes())
        .unwrap()
        .path
}

/// Four seconds straight along -Z.
fn walk([x, y]: [f64; 2], from: f64, to: f64) -> CameraPath {
    let key = |time: f64, z: f64| {
        let position = format!("position: ({x}, {y}, {z})");
        format!(
            "(time: {time:?}, {position}, look_at: ({x}, {y}, {:?}), fov: 50),",
            z - 100.0
        )
    };
    let keys = key(0.0, from) + &key(4.0, to);
    loaded(&format!(
        "CameraPath(fps: 24, interpolation: linear, keyframes: [{keys}])"
    ))
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
        assert!(
            matches!(found[0].kind, WarningKind::InsideSolid { .. }),
            "{found:?}"
        );
        let &[[enters, leaves]] = found[0].frames.runs() else {
            panic!("{found:?}")
        };
        let z = |frame: u32| path.camera(frame).position.z;
        assert!((z(enters) - first).abs() < 0.03, "{}", z(enters));
        assert!((z(leaves) - last).abs() < 0.03, "{}", z(leaves));
        assert_eq!(found[1].kind, WarningKind::CrossesSurface);
        assert_eq!(found[1].frames.runs(), [[enters - 1; 2], [leaves; 2]]);
        assert!(matches!(found[2].kind, WarningKind::NearSurface { .. }));
    }
    let beside = walk([0.0, 1.7], 1.2, -4.0);
    assert_eq!(preflight(&scene, &beside, 1280, 720, NEAR), []);
}

/// Each variant of a round trip has the warnings that it should, and no others.
#[test]
fn each_kind_of_round_trip_has_its_own_warnings() {
    // Around the middle of the hall, far from all exhibits.
    let stations = [
        (1.2, -3.0),
        (-1.2, -3.4),
        (-1.0, -5.0),
        (1.1, -5.2),
        (1.2, -3.0),
    ];
    let keys = |more: &str, end: f64| -> String {
        let keys = stations.iter().enumerate().map(|(i, (x, z))| {
            let time = 6.0 * i as f64;
            let x = if i == 4 { x + end } else { *x };
            format!(
                "(time: {time}, position: ({x}, 1.7, {z}), look_at: (0, 2.0, -40), fov: 50{more}),"
            )
        });
        keys.collect()
    };
    let path = |fields: &str, more: &str, end: f64| {
        loaded(&format!(
            "CameraPath(fps: 24, {fields} keyframes: [{}])",
            keys(more, end)
        ))
    };
    let scene = shipped_scene("gallery.ron");
    let found = |path: &CameraPath| -> Vec<String> {
        let found = preflight(&scene, path, 1280, 720, NEAR);
        let names = found.iter().map(|finding| format!("{:?}", finding.kind));
        names
            .map(|name| name.split(' ').next().unwrap().to_owned())
            .collect()
    };
    let smooth: [&str; 0] = [];
    assert_eq!(found(&path("", "", 0.0)), ["RepeatsFirstFrame"]);
    assert_eq!(found(&path("", "", 0.5)), smooth);
    for fields in ["closed: true,", "closed: true, speed: constant,"] {
        assert_eq!(found(&path(fields, "", 0.0)), smooth, "{fields}");
    }
    let eased = path("ease_in: 2, ease_out: 2, speed: constant,", "", 0.5);
    assert_eq!(found(&eased), smooth);
    let stops = path("interpolation: linear,", ", ease: in_out", 0.5);
    assert_eq!(found(&stops), smooth);
    let corners = path("interpolation: linear,", "", 0.5);
    assert_eq!(found(&corners), ["VelocityJump"]);
    let seam = path("interpolation: linear, closed: true,", "", 0.0);
    assert_eq!(found(&seam), ["VelocityJump", "VelocityJumpAtSeam"]);
    // Cuts are no jumps.
    assert_eq!(found(&path("interpolation: hold,", "", 0.5)), smooth);
}

/// The camera passes almost straight above its target.
#[test]
fn look_at_near_the_vertical_is_found() {
    let key = |time: u32, x: f64| {
        format!("(time: {time}, position: ({x}, 3, -4), look_at: (0, 0, -4.03), fov: 50),")
    };
    let text = format!(
        "CameraPath(fps: 24, interpolation: linear, keyframes: [{}{}])",
        key(0, -0.61),
        key(4, 0.6)
    );
    let found = preflight(
        &shipped_scene("gallery.ron"),
        &loaded(&text),
        1280,
        720,
        NEAR,
    );
    let spins = found
        .iter()
        .find(|f| matches!(f.kind, WarningKind::SpinsNearVertical { .. }));
    let spins = spins.expect("a picture that spins");
    let &[[first, last]] = spins.frames.runs() else {
        panic!("{spins}")
    };
    assert!(
        first <= 48 && last >= 48 && spins.frames.count() < 12,
        "{spins}"
    );
}
