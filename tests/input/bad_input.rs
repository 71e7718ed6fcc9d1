//! Wrong scenes and camera paths: each is refused with its location and what to do.

use crate::support::*;

#[test]
fn scenes() {
    let sphere = |fields: &str| {
        format!(
            "Scene(materials: {{\"m\": ()}}, objects: [sphere(radius: 1, material: \"m\", {fields})])"
        )
    };
    let cases = [
        ("Scene(objects: [)".to_owned(), "s.ron:1:17: Expected identifier"),
        ("Scene(\n  objets: [],\n)".to_owned(), "s.ron:2:3: Unexpected field named `objets`"),
        ("Scene(objects: \"none\")".to_owned(), "s.ron:1:15: Expected opening"),
        ("Scene()".to_owned(), "missing field named `objects`"),
        (sphere("center: (0, NaN, 0)"), "s.ron: objects[0].center: (0, NaN, 0): every number"),
        (sphere("translation: (inf, 0, 0)"), "objects[0].translation: (inf, 0, 0)"),
        (sphere("scale: (1, 0, 1)"), "objects[0].scale: [1, 0, 1]: no factor may be 0"),
        (sphere("wobble: 3"), "Unexpected field named `wobble`"),
        (
            "Scene(objects: [sphere(radius: -1, material: \"m\")], materials: {\"m\": ()})".to_owned(),
            "objects[0].radius: -1 is not a number above 0",
        ),
        (
            "Scene(objects: [sphere(radius: 1, material: \"gold\")], materials: {\"red\": (), \"blue\": ()})".to_owned(),
            "objects[0].material: no material is called \"gold\"; `materials` has: blue, red",
        ),
        (
            "Scene(objects: [], materials: {\"m\": (diffuse: (0, 1.5, 0))})".to_owned(),
            "materials[\"m\"].diffuse: (0, 1.5, 0): every channel must lie between 0 and 1",
        ),
        (
            "Scene(objects: [], materials: {\"m\": (shininess: -2)})".to_owned(),
            "materials[\"m\"].shininess: -2 is not between 0 and",
        ),
        (
            "Scene(objects: [],\n materials: {\"m\": (),\n \"m\": ()})".to_owned(),
            "the name \"m\" is used twice",
        ),
        (
            "Scene(objects: [], materials: {\"m\": (texture: \"no.png\")})".to_owned(),
            "s.ron: materials[\"m\"].texture names no.png, which cannot be read: No such file",
        ),
        (
            "Scene(objects: [model(file: \"no.obj\")])".to_owned(),
            "s.ron: objects[0].file names no.obj, which cannot be read",
        ),
        (
            "Scene(objects: [triangle(vertices: [(0, 0, 0), (1, 0, 0)], material: \"m\")])".to_owned(),
            "a triangle's list has 3 entries, not 2",
        ),
        (
            "Scene(objects: [triangle(vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0)])])".to_owned(),
            "objects[0]: give either `material` or `vertex_materials: [a, b, c]`",
        ),
        (
            "Scene(objects: [], lights: [(position: (0, 0, 0), intensity: (1, -1, 1))])".to_owned(),
            "lights[0].intensity: (1, -1, 1): every channel",
        ),
        (
            "Scene(objects: [], lights: [(position: (0, 0, 0), intensity: (1, 1, 1), falloff: linear)])".to_owned(),
            "linear",
        ),
        ("Scene(objects: [], settings: (samples: 0))".to_owned(), "settings.samples: 0 is not"),
        ("Scene(objects: [], settings: (size: (32768, 16384)))".to_owned(), "settings.size: 32768x16384 are more"),
        ("Scene(objects: [], objects: [])".to_owned(), "s.ron:1:20: Unexpected duplicate field named `objects`"),
        (sphere("radius: 2"), "duplicate field named `radius`"),
        (sphere("scale: (1e15, 1e15, 1e15), center: (2, 0, 0)"), "objects[0]: its scale and translation take [2, 0, 0] beyond 1e15"),
        (sphere("scale: (1e-15, 1e-15, 1e-15)").replace("radius: 1", "radius: 1e-3"), "objects[0].radius: 1e-18 is not between 1e-15 and 1e15"),
        ("Scene(objects: [], settings: (mode: \"fast\"))".to_owned(), "no mode is called \"fast\""),
    ];
    for (scene, expected) in cases {
        let (status, message) = check(&scene, &path(KEY), &[]);
        assert_eq!(status, Some(2), "{scene}: {message}");
        assert!(message.contains(expected), "{scene}: {message}");
    }
}

#[test]
fn paths() {
    let one = |fields: &str| path(&format!("(time: 0, {fields})"));
    let two = |first: &str, second: &str| {
        let key = |time: u32, more: &str| {
            let fov = 50 + time;
            format!(
                "(time: {time}, position: (0, 0, {time}), rotation: (0, 0, 0), fov: {fov}, {more})"
            )
        };
        path(&format!("{}, {}", key(0, first), key(1, second)).replace(", )", ")"))
    };
    let cases = [
        (
            path(""),
            "p.ron: keyframes: there are none; write at least one",
        ),
        (
            path(&format!("{KEY}, {KEY}")),
            "p.ron: keyframes: key 1, at 0 s, is not after the key before it",
        ),
        (
            one("position: (0, 0, 0), fov: 50"),
            "keyframes[0]: give one of `look_at: (x, y, z)`, `yaw_pitch_roll",
        ),
        (
            one("position: (0, 0, 0), look_at: (0, 0, 1), rotation: (0, 0, 0), fov: 50"),
            "give one of",
        ),
        (
            one("position: (0, 0, 0), look_at: (0, 0, 0), fov: 50"),
            "the camera is at its look_at",
        ),
        (
            one("position: (0, 0, 0), look_at: (0, 5, 0), fov: 50"),
            "straight up or down",
        ),
        (
            one("position: (0, 0, 0), rotation: (0, 0, 0), fov: 180"),
            "keyframes[0].fov: 180",
        ),
        (
            one("position: (0, 0, 0), rotation: (0, 0, 0), fov: NaN"),
            "keyframes[0].fov: NaN",
        ),
        (
            one("position: (0, 1e30, 0), rotation: (0, 0, 0), fov: 50"),
            "keyframes[0].position",
        ),
        (
            format!("CameraPath(fps: 0, keyframes: [{KEY}])"),
            "fps: 0 is not a number above 0",
        ),
        (
            format!("CameraPath(fps: 24, pace: 1, keyframes: [{KEY}])"),
            "field named `pace`",
        ),
        (
            one("position: (0, 0, 0), quaternion: (1, 0, 0, 1), fov: 50"),
            "keyframes[0].quaternion: (1, 0, 0, 1) is not of length 1",
        ),
        (
            one("position: (0, 0, 0), quaternion: (0, 0, 0, NaN), fov: 50"),
            "keyframes[0].quaternion: (0, 0, 0, NaN) is not of length 1",
        ),
        (
            one("position: (0, 0, 0), rotation: (0, 0, 0), roll: 5, fov: 50"),
            "keyframes[0].roll: goes with look_at",
        ),
        (
            one("position: (0, 0, 0), look_at: (0, 0, 1), roll: NaN, fov: 50"),
            "keyframes[0].roll: NaN is not between -1000000000000000 and",
        ),
        (
            two(
                "interpolation: hermite, velocity: (0, 0, 1)",
                "velocity: (0, 0, 2)",
            )
            .replace("fps: 24", "fps: 24, closed: true"),
            "keyframes[1].velocity: differs from that of keyframes[0], which it repeats in a closed path",
        ),
        (
            one("position: (0, 0, 0), rotation: (0, 0, 0), velocity: (0, 0, 1), fov: 50"),
            "keyframes[0].velocity: has no effect",
        ),
        (
            two("interpolation: bezier, handle_out: (0, 0, 1)", ""),
            "keyframes[1].handle_in: is missing, and `interpolation: bezier` needs it",
        ),
        (
            two(
                "interpolation: hermite, velocity: (inf, 0, 1)",
                "velocity: (0, 0, 0)",
            ),
            "keyframes[0].velocity: (inf, 0, 1)",
        ),
        (two("interpolation: cubic", ""), "p.ron:1:"),
        (
            two("", "").replace("fps: 24", "fps: 24, closed: true"),
            "keyframes: the last key of a closed path repeats its first one at a later time; they differ in position",
        ),
        (
            two("", "").replace("fps: 24", "fps: 24, ease_in: 0.5, ease_out: 0.6"),
            "keyframes: ease_in and ease_out take 1.1 s together, and the path lasts 1 s",
        ),
        (
            two("", "").replace("fps: 24", "fps: 24, ease_in: -1"),
            "ease_in: -1 is not between 0",
        ),
        (
            two("interpolation: hold, ease: in", ""),
            "keyframes[0].ease: has no effect",
        ),
        (
            two("", "").replace("fps: 24", "fps: 24, closed: true, ease_in: 0.5"),
            "keyframes: a closed path loops: give both ease_in and ease_out",
        ),
        (
            two("ease: in_out", "").replace("fps: 24", "fps: 24, speed: constant"),
            "keyframes: key 0 has `ease`, but `speed: constant`",
        ),
        (
            two("", "").replace("0, 0, 0), fov: 51", "0, 180, 0), fov: 51"),
            "keyframes: key 1 is half a turn from the key before it",
        ),
        (
            "CameraPath(fps: 24, keyframes: [(time: \"0\")])".to_owned(),
            "p.ron:1:39: Expected float",
        ),
    ];
    for (path, expected) in cases {
        let (status, message) = check("Scene(objects: [])", &path, &[]);
        assert_eq!(status, Some(2), "{path}: {message}");
        assert!(message.contains(expected), "{path}: {message}");
    }
}

#[test]
fn files_that_are_not_there() {
    let output = flythrough(&["check", "scenes/none.ron", "paths/zoom.ron"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("scenes/none.ron: cannot be read: No such file"));
}
