//! Shared by the test binaries: scenes from text, cameras, and runs of the program.
#![allow(dead_code, reason = "each test binary uses a part of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

pub(crate) mod project;
pub(crate) mod statistics;

use flythrough::camera::{Camera, CameraPath};
use flythrough::camera_formats::load_camera_path;
use flythrough::input::{InputFiles, load_scene};
use flythrough::integrator::IntegratorSettings;
use flythrough::render::{RenderSettings, Renderer};
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The number of samples, seeds, frames or tries for the tier of scripts/test.sh that `FLYTHROUGH_TEST_TIER` names, or
/// for the default tier without it.
pub(crate) fn scaled<T>(quick: T, default: T, thorough: T) -> T {
    match std::env::var("FLYTHROUGH_TEST_TIER").as_deref() {
        Ok("quick") => quick,
        Ok("default") | Err(_) => default,
        Ok("thorough") => thorough,
        Ok(other) => {
            panic!("FLYTHROUGH_TEST_TIER is {other:?}: neither quick, default nor thorough")
        }
    }
}

/// Says that a test lacks something and does nothing; in CI it may not.
pub(crate) fn not_tested(why: &str) {
    assert!(std::env::var_os("CI").is_none(), "not tested in CI: {why}");
    // Not `eprintln!`, which test runners capture.
    let _ = writeln!(std::io::stderr(), "NOT TESTED: {why}");
}

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A scene from the text of a scene file.
pub(crate) fn scene(text: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    load_scene(&file, &mut InputFiles::default()).unwrap().scene
}

pub(crate) fn shipped_scene(name: &str) -> Scene {
    let file = root().join("scenes").join(name);
    load_scene(&file, &mut InputFiles::default()).unwrap().scene
}

pub(crate) fn shipped_path(name: &str) -> CameraPath {
    let file = root().join("paths").join(name);
    load_camera_path(&file, &mut InputFiles::default())
        .unwrap()
        .path
}

/// A square [-half, half] in x and z at height y, of one material.
pub(crate) fn plate(y: f64, half: f64, material: &str) -> String {
    format!(
        "triangle(vertices: [(-{half}, {y}, {half}), ({half}, {y}, {half}), ({half}, {y}, -{half})], material: \"{material}\"),
         triangle(vertices: [(-{half}, {y}, {half}), ({half}, {y}, -{half}), (-{half}, {y}, -{half})], material: \"{material}\"),"
    )
}

/// The room of test3 with other objects in place of its spheres.
pub(crate) fn room(materials: &str, objects: &str) -> Scene {
    scene(&room_text(materials, objects))
}

/// The same without the lights of test3.
pub(crate) fn room_without_lights(materials: &str, objects: &str) -> Scene {
    let text = room_text(materials, objects);
    let (head, rest) = text.split_once("    lights: [").unwrap();
    let (_, rest) = rest.split_once("    ],\n").unwrap();
    scene(&format!("{head}{rest}"))
}

fn room_text(materials: &str, objects: &str) -> String {
    let text = std::fs::read_to_string(root().join("scenes/test3.ron")).unwrap();
    let (head, rest) = text.split_once("        \"mirror\"").unwrap();
    let (_, lights) = rest.split_once("    },\n").unwrap();
    let (lights, rest) = lights.split_once("        sphere").unwrap();
    let (_, walls) = rest.split_once("        // Floor").unwrap();
    format!("{head}{materials}}},\n{lights}{objects}//{walls}")
}

pub(crate) fn light(position: &str, intensity: f64) -> String {
    format!("(position: {position}, intensity: ({intensity}, {intensity}, {intensity})),")
}

/// The inside of a sphere of radius 2 about (5, -2, 7), of albedo (0.9, 0.5, 0.2), and a light of intensity 3.
pub(crate) fn inside_of_a_sphere(light_position: &str) -> Scene {
    scene(&format!(
        "Scene(
            materials: {{\"m\": (diffuse: (0.9, 0.5, 0.2))}},
            lights: [{}],
            objects: [sphere(center: (5, -2, 7), radius: 2, material: \"m\")],
        )",
        light(light_position, 3.0)
    ))
}

pub(crate) const GREY: &str = "materials: {\"grey\": (diffuse: (0.5, 0.5, 0.5))},";

/// A camera at `position` that looks at `target`, its vertical field of view in degrees.
pub(crate) fn camera(position: DVec3, target: DVec3, degrees: f64) -> Camera {
    Camera::look_at(position, target, degrees.to_radians()).unwrap()
}

pub(crate) fn settings(integrator: IntegratorSettings, width: u32, height: u32) -> RenderSettings {
    RenderSettings::new(integrator, width, height)
}

/// Renders by settings that need no irradiance cache.
pub(crate) fn renderer<'a>(scene: &'a Scene, settings: &RenderSettings) -> Renderer<'a> {
    Renderer::new(scene, settings.clone(), None).unwrap()
}

/// The pixels of one frame.
pub(crate) fn render(scene: &Scene, camera: &Camera, settings: &RenderSettings) -> Vec<Vec3> {
    render_frame(&renderer(scene, settings), camera)
}

/// The pixels of one frame.
pub(crate) fn render_frame(renderer: &Renderer, camera: &Camera) -> Vec<Vec3> {
    let rendered = renderer.render_frame(camera, 0);
    assert_eq!(rendered.non_finite_samples, 0);
    rendered.film.pixels().to_vec()
}

/// The same without an estimate of their error, which takes longer than a small frame.
pub(crate) fn pixels(renderer: &Renderer, camera: &Camera) -> Vec<Vec3> {
    assert_eq!(renderer.settings().target_error, None);
    let (width, height) = (renderer.settings().width, renderer.settings().height);
    let pixels = (0..width * height).map(|index| (index % width, index / width));
    let halves = renderer.render_pixels(camera, 0, &pixels.collect::<Vec<_>>());
    halves.iter().map(|[a, b]| 0.5 * (a + b)).collect()
}

/// The radiance that a camera sees in the middle of its image.
pub(crate) fn center_radiance(
    scene: &Scene,
    integrator: IntegratorSettings,
    position: DVec3,
    target: DVec3,
) -> Vec3 {
    render(
        scene,
        &camera(position, target, 1e-6),
        &settings(integrator, 1, 1),
    )[0]
}

pub(crate) fn ray_tracing() -> IntegratorSettings {
    IntegratorSettings::Whitted { bounces: 4 }
}

pub(crate) fn monte_carlo(bounces: u32, splits: &[u32]) -> IntegratorSettings {
    IntegratorSettings::PathTraced {
        bounces,
        splits: splits.to_vec(),
    }
}

pub(crate) fn assert_close(value: Vec3, expected: Vec3, tolerance: f32) {
    let error = (value - expected).abs().max_element();
    assert!(
        error <= tolerance,
        "{value} instead of {expected}, off by {error}"
    );
}

/// Runs the program in the project's root.
pub(crate) fn flythrough(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_flythrough"))
        .args(arguments)
        .current_dir(root())
        .output()
        .unwrap()
}

/// Runs `check` on a scene and a path given as text, with `files` beside them. Returns the exit status and stderr,
/// without the name of the folder.
pub(crate) fn check(scene: &str, path: &str, files: &[(&str, &[u8])]) -> (Option<i32>, String) {
    let mut all = vec![("s.ron", scene.as_bytes()), ("p.ron", path.as_bytes())];
    all.extend(files);
    check_files("s.ron", "p.ron", &all)
}

/// As [`check`]; the scene and the path are among the files.
pub(crate) fn check_files(
    scene: &str,
    path: &str,
    files: &[(&str, &[u8])],
) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let output = flythrough(&["check", &file(scene), &file(path)]);
    let prefix = format!("{}/", folder.path().display());
    (output.status.code(), stderr(&output).replace(&prefix, ""))
}

/// The key of a still camera.
pub(crate) const KEY: &str = "(time: 0, position: (0, 0, 0), look_at: (0, 0, -1), fov: 50)";

/// A camera path file with these keys.
pub(crate) fn path(keys: &str) -> String {
    format!("CameraPath(fps: 24, keyframes: [{keys}])")
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The frames of a folder with their bytes, sorted by name.
pub(crate) fn frames(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut frames: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.file_name()
                .unwrap()
                .to_string_lossy()
                .starts_with("frame_")
        })
        .map(|path| {
            (
                path.file_name().unwrap().into(),
                std::fs::read(&path).unwrap(),
            )
        })
        .collect();
    frames.sort();
    frames
}
