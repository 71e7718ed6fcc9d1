//! The warnings of `check` about scenes and settings, and those of `render`, which are the same.

use crate::support::*;
use std::fs;
use std::path::Path;

/// A grey floor in the plane y = 0, seen by the path of [`walk`].
fn floor() -> String {
    plate(0.0, 9.0, "grey")
}

/// Two seconds over the floor; the camera looks up from the second key on, where there is nothing.
fn walk(settings: &str) -> String {
    let key = |time: u32, x: u32, y: i32| {
        format!("(time: {time}, position: ({x}, 2, 0), look_at: ({x}, {y}, -9), fov: 50),")
    };
    let keys = key(0, 0, -2) + &key(1, 1, -2) + &key(2, 2, 30);
    format!("CameraPath(fps: 12, settings: ({settings}), keyframes: [{keys}])")
}

/// The warnings of a scene of these lights and objects, with a second, red material and a texture.
fn warnings(fields: &str, lights: &str, objects: &str) -> Vec<String> {
    let scene = format!(
        "Scene({fields} lights: [{lights}], objects: [{objects}], materials: {{
            \"grey\": (diffuse: (0.5, 0.5, 0.5)),
            \"red\": (diffuse: (0.9, 0.1, 0.1)),
            \"glare\": (diffuse: (0.9, 0.9, 0.9), specular: (0.5, 0.1, 0.1)),
        }})"
    );
    let (status, message) = check(&scene, &path(LOOK_DOWN), &[]);
    assert_eq!(status, Some(0), "{message}");
    message.lines().map(str::to_owned).collect()
}

/// From above the middle of the floor.
const LOOK_DOWN: &str = "(time: 0, position: (0, 5, 4), look_at: (0.1, 0, 0), fov: 50)";

const LAMP: &str = "(position: (0, 8, 0), intensity: (9, 9, 9)),";

#[test]
fn a_scene_without_mistakes_has_no_warnings() {
    let none: [&str; 0] = [];
    assert_eq!(warnings("", LAMP, &floor()), none);
    // A ball on the floor and one around all, a lamp beside a ball.
    let balls = "sphere(center: (0, 1, 0), radius: 1, material: \"grey\"),
        sphere(radius: 99, material: \"red\"),
        sphere(center: (0, 8, 1), radius: 0.5, material: \"red\"),";
    assert_eq!(warnings("", LAMP, &(floor() + balls)), none);
}

#[test]
fn each_mistake_of_a_scene_is_named() {
    let ball = |y: f64, material: &str| {
        format!("sphere(center: (0, {y}, 0), radius: 0.5, material: \"{material}\"),")
    };
    for (lights, objects, expected) in [
        (
            LAMP,
            ball(8.0, "red"),
            vec!["lights[0] at (0, 8, 0) is inside objects[2], which is closed"],
        ),
        (
            "",
            String::new(),
            vec!["there are no lights that shine, and ambient and background are 0"],
        ),
        (
            "(position: (0, 8, 0), intensity: (0, 0, 0)),",
            String::new(),
            vec![
                "lights[0]: intensity 0 gives no light",
                "every frame is black",
            ],
        ),
        (
            LAMP,
            ball(3.0, "glare"),
            vec!["material \"glare\": more light is reflected than falls on it, 1.4 times"],
        ),
        (
            LAMP,
            ball(1.0, "grey") + &ball(1.0, "grey"),
            vec![
                "1 shape coincides with another: a sphere of objects[3] is also in objects[2], at (0, 1, 0)",
            ],
        ),
        (
            LAMP,
            floor(),
            vec!["2 shapes coincide with another: a triangle of objects[2] is also in objects[0]"],
        ),
        (
            LAMP,
            plate(0.0, 1.0, "red"),
            vec!["pairs of surfaces lie in the same place (z-fighting): objects["],
        ),
        (
            LAMP,
            plate(1e-4, 1.0, "red") + &plate(0.0, 2.0, "grey"),
            vec![],
        ),
    ] {
        let found = warnings("", lights, &(floor() + &objects));
        assert_eq!(found.len(), expected.len(), "{objects}: {found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.starts_with("warning: s.ron: "), "{found}");
            assert!(found.contains(expected), "{found}");
        }
    }
}

#[test]
fn settings_that_make_no_difference_are_named_where_they_are_given() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let scene = format!(
        "Scene({GREY} settings: (splits: [4]), lights: [{LAMP}], objects: [{}])",
        floor()
    );
    fs::write(file("s.ron"), scene).unwrap();
    fs::write(file("p.ron"), walk("gi: \"path-traced\"")).unwrap();
    let found = |flags: &[&str]| {
        let (scene, path) = (file("s.ron"), file("p.ron"));
        let output = flythrough(&[&["check", &scene, &path], flags].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let ignored = stderr(&output);
        let ignored = ignored
            .lines()
            .filter(|line| line.contains("makes no difference"));
        let ignored =
            ignored.map(|line| line.replace(&format!("{}/", folder.path().display()), ""));
        let place = |line: String| line.split(": makes").next().unwrap().to_owned();
        ignored.map(place).collect::<Vec<String>>()
    };
    let [of_path, of_scene] = [
        "warning: p.ron: settings.gi",
        "warning: s.ron: settings.splits",
    ];
    assert_eq!(found(&[]), [of_path, of_scene]);
    assert_eq!(
        found(&["--seed", "3"]),
        ["warning: --seed", of_path, of_scene]
    );
    assert_eq!(found(&["--mode", "montecarlo"]), [""; 0]);
    let cached = ["--mode", "montecarlo", "--gi", "cached", "--splits", "2"];
    assert_eq!(found(&cached), ["warning: --splits"]);
}

/// Runs `render` in a folder with small frames; returns what it warns of.
fn render(folder: &Path, more: &[&str]) -> String {
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (scene, path, out) = (file("s.ron"), file("p.ron"), file("frames"));
    let arguments = ["render", &scene, &path, "--out", &out];
    let size: &[&str] = if more.contains(&"--preview") {
        &[]
    } else {
        &["--size", "16x9"]
    };
    let output = flythrough(&[&arguments, size, more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    stderr(&output)
}

#[test]
fn render_warns_as_check_does_before_it_starts() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let scene = format!(
        "Scene({GREY} settings: (splits: [4]), lights: [{LAMP} {}], objects: [{}])",
        light("(0, 7, 0)", 0.0),
        floor()
    );
    fs::write(file("s.ron"), scene).unwrap();
    fs::write(file("p.ron"), walk("")).unwrap();
    let checked = flythrough(&["check", &file("s.ron"), &file("p.ron"), "--size", "16x9"]);
    let checked = stderr(&checked);
    for expected in [
        "settings.splits",
        "lights[1]: intensity 0",
        "the camera sees nothing",
    ] {
        assert!(checked.contains(expected), "{expected}: {checked}");
    }
    let fresh = |more: &[&str]| {
        let _ = fs::remove_dir_all(file("frames"));
        render(folder.path(), more)
    };
    for threads in ["1", "3"] {
        assert_eq!(fresh(&["--threads", threads]), checked);
    }
    // Nothing is rendered.
    assert_eq!(render(folder.path(), &[]), "");
    assert_eq!(fresh(&["--prepare", "sequence"]), checked);
    assert_eq!(fresh(&["--quiet"]), "");
    // What is not about these frames is left out, and a preview has settings of its own.
    let first = fresh(&["--frames", "0"]);
    assert!(
        first.contains("lights[1]") && !first.contains("sees nothing"),
        "{first}"
    );
    assert!(fresh(&["--frames", "24"]).contains("sees nothing"));
    let preview = fresh(&["--preview"]);
    assert!(
        preview.contains("sees nothing") && !preview.contains("splits"),
        "{preview}"
    );
}
