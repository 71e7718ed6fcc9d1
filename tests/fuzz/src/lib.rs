//! Shared by the fuzz targets: a folder for input files, and the check of a scene file.

use flythrough::camera::Camera;
use flythrough::input::{InputFiles, load_scene};
use flythrough::integrator::IntegratorSettings;
use flythrough::render::{RenderSettings, Renderer};
use flythrough::scene::Scene;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use tempfile::TempDir;

/// An uncompressed TGA file of one red texel.
const PICTURE: [u8; 21] = [
    0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 0, 0, 255,
];

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("t.tga"), PICTURE).expect("writable");
    folder
});

/// Writes a file into the folder of all input files, beside the picture `t.tga`.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let file = FOLDER.path().join(name);
    fs::write(&file, bytes).expect("writable");
    file
}

/// Loads a scene and, if it is accepted, renders it in both kinds of mode: no radiance is negative.
pub fn check_scene(scene: &[u8]) {
    let loaded = load_scene(&file("s.ron", scene), &mut InputFiles::default());
    match loaded {
        Ok(input) => render(&input.scene),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn render(scene: &Scene) {
    let bounds = scene.bounds();
    let (middle, size) = if scene.triangle_count() + scene.sphere_count() > 0 {
        (
            0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3()),
            bounds.max.as_dvec3() - bounds.min.as_dvec3(),
        )
    } else {
        Default::default()
    };
    let target = scene.origin + middle;
    let distance = size.max_element().max(1e-6) * 1.5;
    for eye in [target + distance, target + 1e-3 * distance] {
        // Far from the origin the eye and the middle of a small scene may round to one point.
        let Ok(camera) = Camera::look_at(eye, target, 0.8) else {
            continue;
        };
        for integrator in [
            IntegratorSettings::Whitted { bounces: 3 },
            IntegratorSettings::PathTraced {
                bounces: 3,
                splits: vec![2],
            },
        ] {
            let settings = RenderSettings::new(integrator, 4, 3);
            let renderer = Renderer::new(scene, settings, None).expect("needs no cache");
            let rendered = renderer.render_frame(&camera, 0);
            for pixel in rendered.film.pixels() {
                assert!(pixel.min_element() >= 0.0, "{pixel}");
            }
        }
    }
}
