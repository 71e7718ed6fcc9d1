//! Frames against those of Mitsuba 3, pixel by pixel.
//!
//! tests/reference/make_mitsuba.py renders the references: integrator `path`, max_depth = bounces + 2, and bounces + 1
//! for light of the sky. All camera rays go through pixel centres: an edge that few random rays hit would have an error
//! that cannot be estimated from these few.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::camera::Camera;
use flythrough::render::RenderSettings;
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};

const WIDTH: usize = 40;
const HEIGHT: usize = 30;

/// The rounding error of both renderers, relative to the pixel. Curved mirrors magnify it.
const ROUNDING: f64 = 5e-5;

/// The references with 0, 1 and 4 bounces.
fn references(name: &str) -> Vec<(u32, Vec<Estimate>)> {
    let file = root().join(format!("tests/reference/{name}.exr"));
    let picture = image::open(file).unwrap().into_rgb32f();
    assert_eq!(picture.dimensions(), (WIDTH as u32, 6 * HEIGHT as u32));
    let parts = picture.as_raw().chunks_exact(2 * 3 * WIDTH * HEIGHT);
    let estimates = |part: &[f32]| {
        let (means, errors) = part.split_at(part.len() / 2);
        let estimate = |(mean, error): (&f32, &f32)| Estimate {
            mean: f64::from(*mean),
            error: f64::from(*error),
        };
        means.iter().zip(errors).map(estimate).collect()
    };
    [0, 1, 4].into_iter().zip(parts.map(estimates)).collect()
}

/// Whether frames agree with the reference: no pixel is further off than noise explains, the mean square of all is that
/// of noise, and the means of blocks of 5 x 5 and of the whole frame agree, too.
fn compare(
    scene: &Scene,
    camera: &Camera,
    bounces: u32,
    reference: &[Estimate],
) -> Result<(), String> {
    let paths = scaled(64, 64, 128);
    let settings = RenderSettings {
        // Few might all miss a lamp of which a surface sees little; its error could not be estimated.
        shadow_rays: 64,
        ..settings(monte_carlo(bounces, &[paths]), WIDTH as u32, HEIGHT as u32)
    };
    let runs = runs(scene, camera, &settings, 0..32);
    let [pixels, blocks, whole] =
        [[1, 1], [5, 5], [WIDTH, HEIGHT]].map(|block| agreement_of_blocks(&runs, reference, block));
    // The mean square of 1200 pixels deviates by 0.04 from 1, or from 31/29 where our errors are the larger; rare
    // bright paths make it deviate a little more.
    let is_noise = (0.8..1.35).contains(&pixels.mean_square);
    if pixels.holds() && is_noise && blocks.holds() && whole.holds() {
        Ok(())
    } else {
        Err(format!(
            "{bounces} bounces: {pixels:?}, blocks {blocks:?}, the whole {whole:?}"
        ))
    }
}

/// Agreement of the means of blocks of pixels.
fn agreement_of_blocks(runs: &[Vec<f64>], reference: &[Estimate], block: [usize; 2]) -> Agreement {
    let ours: Vec<Vec<f64>> = runs.iter().map(|run| blocks(run, block)).collect();
    let means: Vec<f64> = reference.iter().map(|pixel| pixel.mean).collect();
    let squares: Vec<f64> = reference.iter().map(|pixel| pixel.error.powi(2)).collect();
    let count = (block[0] * block[1]) as f64;
    let both = blocks(&means, block)
        .into_iter()
        .zip(blocks(&squares, block));
    let theirs = both.map(|(mean, square)| Estimate {
        mean,
        error: (square / count).sqrt(),
    });
    Agreement::of(&estimates(&ours), &theirs.collect::<Vec<_>>(), 31, ROUNDING)
}

/// Means of the blocks of a picture's channels.
fn blocks(picture: &[f64], [width, height]: [usize; 2]) -> Vec<f64> {
    let mut means = vec![0.0; picture.len() / (width * height)];
    for (i, value) in picture.iter().enumerate() {
        let (x, y, channel) = (i / 3 % WIDTH, i / 3 / WIDTH, i % 3);
        let block = y / height * (WIDTH / width) + x / width;
        means[3 * block + channel] += value / (width * height) as f64;
    }
    means
}

#[test]
fn cornell_box() {
    let scene = shipped_scene("test3.ron");
    let camera = shipped_path("test3.ron").camera(0);
    for (bounces, reference) in references("test3") {
        compare(&scene, &camera, bounces, &reference).unwrap();
        if bounces == 4 {
            // A missing bounce is detected.
            compare(&scene, &camera, 3, &reference).unwrap_err();
        }
    }
}

/// A mirror sphere without a diffuse part, from close by.
#[test]
fn mirror() {
    let scene = room(
        "\"mirror\": (reflective: (0.8, 0.8, 0.8)), \"olive\": (diffuse: (0.6, 0.6, 0.2))",
        "sphere(center: (0.35, -0.5, -0.2), radius: 0.5, material: \"mirror\"),
         sphere(center: (-0.45, -0.65, 0.2), radius: 0.35, material: \"olive\"),",
    );
    let camera = camera(
        DVec3::new(0.0, -0.2, 1.5),
        DVec3::new(0.3, -0.5, -0.2),
        45.0,
    );
    for (bounces, reference) in references("mirror") {
        compare(&scene, &camera, bounces, &reference).unwrap();
    }
}

/// A model with interpolated normals.
///
/// Where these face away from the camera, at the outline, this renderer reflects the light on the visible side, Mitsuba
/// that on the other. The camera sees no such point.
#[test]
fn mesh() {
    let model = root().join("scenes/models/knot.obj");
    let scene = room(
        "\"olive\": (diffuse: (0.6, 0.6, 0.2))",
        &format!(
            "model(file: {model:?}, scale: (1.5, 1.5, 1.5), translation: (0, -1.2, 0), material: \"olive\"),"
        ),
    );
    let camera = camera(DVec3::new(-0.5, 0.0, 3.0), DVec3::new(0.0, -0.4, 0.0), 34.0);
    for (bounces, reference) in references("mesh") {
        compare(&scene, &camera, bounces, &reference).unwrap();
    }
}

/// Surfaces that emit: a square on one side, a sphere, and a triangle on both sides that reflects, too.
#[test]
fn emitters() {
    let scene = room_without_lights(
        "\"lamp\": (emission: (6, 6, 5)),
         \"panel\": (diffuse: (0.3, 0.3, 0.3), emission: (0.5, 1, 2), two_sided: true),
         \"bulb\": (emission: (3, 1, 1)),
         \"olive\": (diffuse: (0.6, 0.6, 0.2))",
        "triangle(vertices: [(-0.3, 0.95, -0.3), (0.3, 0.95, -0.3), (0.3, 0.95, 0.3)], material: \"lamp\"),
         triangle(vertices: [(-0.3, 0.95, -0.3), (0.3, 0.95, 0.3), (-0.3, 0.95, 0.3)], material: \"lamp\"),
         triangle(vertices: [(0.05, -0.8, -0.6), (0.8, -0.8, -0.35), (0.5, 0.1, -0.5)], material: \"panel\"),
         sphere(center: (0.4, -0.6, 0.35), radius: 0.12, material: \"bulb\"),
         sphere(center: (-0.45, -0.65, 0.2), radius: 0.35, material: \"olive\"),",
    );
    let camera = camera(DVec3::new(-0.5, 0.0, 3.0), DVec3::new(0.0, -0.1, 0.0), 45.0);
    for (bounces, reference) in references("emitters") {
        compare(&scene, &camera, bounces, &reference).unwrap();
        if bounces == 4 {
            // A missing bounce is detected.
            compare(&scene, &camera, 3, &reference).unwrap_err();
        }
    }
}

/// The open, under a sun and a uniform sky.
#[test]
fn sun_and_sky() {
    let open = |irradiance: &str| {
        scene(&format!(
            "Scene(
                background: (0.3, 0.5, 1),
                materials: {{
                    \"floor\": (diffuse: (0.6, 0.55, 0.5)),
                    \"wall\": (diffuse: (0.8, 0.4, 0.3)),
                    \"white\": (diffuse: (0.8, 0.8, 0.8)),
                    \"olive\": (diffuse: (0.6, 0.6, 0.2)),
                }},
                lights: [sun(direction: (-0.5, -1, -0.6), irradiance: {irradiance})],
                objects: [
                    {}
                    triangle(vertices: [(-1.8, 0, -1), (2.4, 0, -1), (2.4, 1.8, -1)], material: \"wall\"),
                    triangle(vertices: [(-1.8, 0, -1), (2.4, 1.8, -1), (-1.8, 1.8, -1)], material: \"wall\"),
                    sphere(center: (0.5, 0.5, 0), radius: 0.5, material: \"white\"),
                    sphere(center: (-0.6, 0.35, 0.4), radius: 0.35, material: \"olive\"),
                ],
            )",
            plate(0.0, 3.0, "floor")
        ))
    };
    let scene = open("(3, 2.7, 2.2)");
    let camera = camera(DVec3::new(0.3, 1.6, 3.2), DVec3::new(0.1, 0.35, 0.0), 45.0);
    for (bounces, reference) in references("sun_and_sky") {
        if bounces == 0 {
            // A sun that is a point and a sky that lights nothing yet: there is no noise.
            let settings = settings(monte_carlo(0, &[1]), WIDTH as u32, HEIGHT as u32);
            let pixels = channels(&render(&scene, &camera, &settings));
            for (pixel, reference) in pixels.iter().zip(&reference) {
                let error = (pixel - reference.mean).abs();
                assert!(error < 1e-5, "{pixel} {reference:?}");
            }
            continue;
        }
        compare(&scene, &camera, bounces, &reference).unwrap();
        if bounces == 4 {
            // A missing bounce and a sun that is 0.5 % too bright are detected.
            compare(&scene, &camera, 3, &reference).unwrap_err();
            let brighter = open("(3.015, 2.7135, 2.211)");
            compare(&brighter, &camera, 4, &reference).unwrap_err();
        }
    }
}

/// Mitsuba's own PointLightIntensity scene: its reference image has the mean 0.269208.
#[test]
fn mean_of_a_lit_sphere_and_square() {
    let scene = scene(
        "Scene(
            materials: {\"white\": (diffuse: (1, 1, 1)), \"grey\": (diffuse: (0.5, 0.5, 0.5))},
            lights: [(position: (1.25, 0, 1), intensity: (5, 5, 5))],
            objects: [
                triangle(vertices: [(-1, -1, 0), (1, -1, 0), (1, 1, 0)], material: \"white\"),
                triangle(vertices: [(-1, -1, 0), (1, 1, 0), (-1, 1, 0)], material: \"white\"),
                sphere(radius: 0.25, material: \"grey\"),
            ],
        )",
    );
    let camera = camera(DVec3::Z * 4.0, DVec3::ZERO, 34.022);
    let pixels = render(&scene, &camera, &spread(ray_tracing(), [128, 128], 64));
    let mean = pixels.iter().sum::<Vec3>() / pixels.len() as f32;
    assert_close(mean, Vec3::splat(0.269_208), 1.5e-4);
}
