//! Light of the sky: closed forms, and which way its images face.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::input::{InputFiles, load_scene};
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use image::{Rgb, Rgb32FImage};
use std::f64::consts::{FRAC_PI_2, PI};

/// A horizontal plate of this albedo under the sky.
const ALBEDO: f64 = 0.8;

fn lit_plate(background: &str) -> String {
    let plate = plate(0.0, 20.0, "white");
    format!(
        "Scene(
            background: {background},
            materials: {{\"white\": (diffuse: ({ALBEDO}, {ALBEDO}, {ALBEDO}))}},
            objects: [{plate}],
        )"
    )
}

/// Sixteen estimates of the radiance of the middle of the plate, seen from above or from below.
fn check_irradiance(scene: &Scene, height: f64, irradiance: [f64; 3], tolerance: f64) {
    let view = camera(DVec3::new(-1.0, height, 0.5), DVec3::ZERO, 1e-6);
    let settings = settings(monte_carlo(1, &[4096]), 4, 4);
    let pixels = render(scene, &view, &settings);
    let pixels: Vec<Vec<f64>> = pixels.iter().map(|pixel| channels(&[*pixel])).collect();
    let seen = estimates(&pixels);
    let expected = irradiance.map(|irradiance| Estimate::exact(ALBEDO / PI * irradiance));
    assert!(seen[0].error < 1e-3 * irradiance[0]);
    let agreement = Agreement::of(&seen, &expected, 15, tolerance);
    assert!(agreement.holds(), "{seen:?} {expected:?} {agreement:?}");
}

/// Pi L of a uniform sky; 2 pi / 3 L of one that falls from L at the zenith to black at the horizon, and in general
/// pi (horizon + 2 pole) / 3.
#[test]
fn irradiance_of_closed_form() {
    let uniform = scene(&lit_plate("(1, 2, 0.5)"));
    for height in [2.0, -2.0] {
        check_irradiance(&uniform, height, [PI, 2.0 * PI, 0.5 * PI], 5e-5);
    }
    let cosine = scene(&lit_plate(
        "gradient(zenith: (1, 2, 0.5), horizon: (0, 0, 0))",
    ));
    let third = PI / 3.0;
    check_irradiance(&cosine, 2.0, [2.0, 4.0, 1.0].map(|i| i * third), 5e-5);
    let gradient = scene(&lit_plate(
        "gradient(zenith: (1, 2, 0.5), horizon: (3, 1, 1), nadir: (1, 0, 0))",
    ));
    check_irradiance(&gradient, 2.0, [5.0, 5.0, 2.0].map(|i| i * third), 5e-5);
    check_irradiance(&gradient, -2.0, [5.0, 1.0, 1.0].map(|i| i * third), 5e-5);
}

/// A scene with a picture as its sky, saved in the format of its name.
fn under_map(text: &str, name: &str, picture: &Rgb32FImage) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    picture.save(folder.path().join(name)).unwrap();
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    load_scene(&file, &mut InputFiles::default()).unwrap().scene
}

/// A picture of the cosine sky lights a plate as the cosine sky does; the intensity scales it.
#[test]
fn a_picture_of_the_cosine_sky() {
    let rows = 256;
    let picture = Rgb32FImage::from_fn(4, rows, |_, row| {
        let angle = PI * (f64::from(row) + 0.5) / f64::from(rows);
        Rgb([0.5 * angle.cos().max(0.0) as f32; 3])
    });
    let map = lit_plate("map(file: \"sky.exr\", intensity: 2)");
    let scene = under_map(&map, "sky.exr", &picture);
    check_irradiance(&scene, 2.0, [2.0 * PI / 3.0; 3], 2e-4);
}

/// Cameras that look along the axes see the columns and rows of the picture, in both formats.
#[test]
fn pictures_face_as_documented() {
    // Two columns for each of -Z, +X, +Z and -X, from half a column right of the left edge; the pole rows are red.
    let picture = Rgb32FImage::from_fn(8, 8, |column, row| match row {
        0 => Rgb([0.5, 0.0, 0.0]),
        7 => Rgb([0.25, 0.0, 0.0]),
        _ => Rgb([0.0, (1 + column.div_ceil(2) % 4) as f32, 0.0]),
    });
    let axes = [DVec3::NEG_Z, DVec3::X, DVec3::Z, DVec3::NEG_X];
    for name in ["sky.exr", "sky.hdr"] {
        for quarters in 0..4 {
            let text = format!(
                "Scene(objects: [], background: map(file: {name:?}, rotation: {}))",
                90 * quarters as i32 - 360
            );
            let scene = under_map(&text, name, &picture);
            // Counter-clockwise from above: a quarter takes -Z to -X.
            for (number, axis) in axes.into_iter().enumerate() {
                let column = (number + quarters) % 4;
                let seen = center_radiance(&scene, ray_tracing(), DVec3::ZERO, axis);
                assert_close(seen, Vec3::Y * (1 + column) as f32, 1e-4);
            }
            let steep = FRAC_PI_2 - 0.01;
            for (side, red) in [(1.0, 0.5), (-1.0, 0.25)] {
                let target = DVec3::new(steep.cos(), side * steep.sin(), 0.0);
                let seen = center_radiance(&scene, ray_tracing(), DVec3::ZERO, target);
                assert_close(seen, Vec3::X * red, 1e-4);
            }
        }
    }
}
