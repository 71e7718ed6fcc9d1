//! What features cost that a scene has but a frame does not show: `cargo bench --bench features`.
//!
//! A room with two matte spheres, one of which hides a triangle of another material. The triangle
//! decides for which features the shading is compiled, and changes no pixel. Best of nine runs each, in
//! turn, on all threads.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints or fails"
)]

use flythrough::camera_formats::load_camera_path;
use flythrough::film::Film;
use flythrough::input::{InputFiles, Samples, Settings, load_scene};
use flythrough::render::Renderer;
use flythrough::scene::Scene;
use std::path::Path;
use std::time::Instant;

const RUNS: usize = 9;

const HIDDEN: [(&str, &str); 6] = [
    ("none of them", "material: \"white\""),
    ("textures", "material: \"textured\""),
    ("highlights", "material: \"shiny\""),
    ("mirrors", "material: \"mirror\""),
    (
        "mixtures",
        "vertex_materials: [\"red\", \"white\", \"green\"]",
    ),
    (
        "all",
        "vertex_materials: [\"textured\", \"shiny\", \"mirror\"]",
    ),
];

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scenes: Vec<Scene> = HIDDEN
        .iter()
        .map(|(_, hidden)| scene(root, hidden))
        .collect();
    let mut files = InputFiles::default();
    let path = load_camera_path(&root.join("paths/test3.ron"), &mut files).unwrap();
    let camera = path.path.camera(0);
    println!("| mode | what the scene has, but does not show | seconds | ratio |");
    println!("|---|---|---|---|");
    for (mode, size, samples) in [
        ("raytracing", (1280, 960), 4),
        ("montecarlo", (320, 240), 16),
    ] {
        let settings = Settings {
            mode: Some(mode.parse().unwrap()),
            size: Some(size),
            samples: Some(Samples::Spread(samples)),
            splits: Some(vec![1]),
            ..Settings::default()
        };
        let settings = settings.resolve(1);
        let renderer = |scene| Renderer::new(scene, settings.clone(), None).unwrap();
        let renderers: Vec<Renderer> = scenes.iter().map(renderer).collect();
        let mut best = [f64::INFINITY; HIDDEN.len()];
        let mut first: Option<Film> = None;
        for _ in 0..RUNS {
            for (renderer, best) in renderers.iter().zip(&mut best) {
                let start = Instant::now();
                let film = renderer.render_frame(&camera, 0).film;
                *best = best.min(start.elapsed().as_secs_f64());
                let expected = first.get_or_insert_with(|| film.clone());
                assert!(film.pixels() == expected.pixels(), "the same picture");
            }
        }
        for ((name, _), seconds) in HIDDEN.iter().zip(best) {
            println!(
                "| {mode} | {name} | {seconds:.3} | {:.2} |",
                seconds / best[0]
            );
        }
    }
}

/// The room of scenes/test3.ron without its mirror, and the triangle in the left sphere.
fn scene(root: &Path, hidden: &str) -> Scene {
    let text = std::fs::read_to_string(root.join("scenes/test3.ron")).unwrap();
    let texture = root.join("scenes/textures").read_dir().unwrap();
    let texture = texture.map(|entry| entry.unwrap().path()).next().unwrap();
    let text = text
        .replace("material: \"mirror\"", "material: \"white\"")
        .replace(
            "\"mirror\": (",
            &format!(
                "\"textured\": (texture: {texture:?}),\n\"shiny\": (specular: (1, 1, 1), shininess: 9),\n\"mirror\": ("
            ),
        )
        .replace(
            "objects: [",
            &format!(
                "objects: [\ntriangle(vertices: [(-0.5, -0.6, 0.2), (-0.4, -0.6, 0.2), (-0.4, -0.7, 0.2)], {hidden}),"
            ),
        );
    let file = std::env::temp_dir().join(format!("features-{}.ron", std::process::id()));
    std::fs::write(&file, text).unwrap();
    let scene = load_scene(&file, &mut InputFiles::default()).unwrap();
    std::fs::remove_file(&file).unwrap();
    scene.scene
}
