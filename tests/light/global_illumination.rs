//! Indirect light in rooms and under skies, against closed forms.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::integrator::LightSampler;
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Sixteen estimates of the radiance in the middle of a camera's image, by pixels that all see the same point.
fn center_estimates(
    scene: &Scene,
    [eye, target]: [DVec3; 2],
    bounces: u32,
    splits: u32,
) -> Vec<Vec<f64>> {
    let settings = settings(monte_carlo(bounces, &[splits]), 4, 4);
    let pixels = pixels(&renderer(scene, &settings), &camera(eye, target, 1e-6));
    pixels.iter().map(|pixel| channels(&[*pixel])).collect()
}

/// Inside a sphere of radius R a light of intensity I anywhere gives the wall the irradiance
/// rho^k I / R^2 by bounce k, the same everywhere.
#[test]
fn light_off_the_centre_of_a_sphere() {
    check_uniform_indirect_light("(5.9, -1.2, 7.4)");
}

/// The same with a light so close to the wall that it lights it a hundred times as brightly there as elsewhere.
#[test]
fn light_by_the_wall_of_a_sphere() {
    assert!(!LightSampler::new(&check_uniform_indirect_light("(6.9, -2, 7)")).is_empty());
}

fn check_uniform_indirect_light(position: &str) -> Scene {
    const ALBEDO: [f64; 3] = [0.9, 0.5, 0.2];
    let scene = inside_of_a_sphere(position);
    let eye = DVec3::new(4.5, -2.5, 6.5);
    for target in [DVec3::new(9.0, -2.0, 6.0), DVec3::new(3.0, -3.0, 9.0)] {
        // The same paths with one bounce more differ by the light of that bounce.
        let pixels =
            |bounces| center_estimates(&scene, [eye, target], bounces, scaled(512, 512, 2048));
        let pictures: Vec<Vec<Vec<f64>>> = (0..=8).map(pixels).collect();
        let mut seen = Vec::new();
        let mut expected = Vec::new();
        for (k, pair) in (1..).zip(pictures.windows(2)) {
            let of_bounce = pair[1].iter().zip(&pair[0]);
            let of_bounce = of_bounce.map(|(more, less)| more.iter().zip(less));
            let of_bounce = of_bounce.map(|pixel| pixel.map(|(a, b)| a - b).collect());
            seen.extend(estimates(&of_bounce.collect::<Vec<_>>()));
            expected.extend(ALBEDO.map(|rho| Estimate::exact(rho / PI * rho.powi(k) * 3.0 / 4.0)));
        }
        let mut both = seen.iter().zip(&expected);
        assert!(both.all(|(seen, expected)| seen.error < 0.1 * expected.mean));
        let agreement = Agreement::of(&seen, &expected, 15, 1e-5);
        assert!(agreement.holds(), "{target}: {agreement:?}");
    }
    scene
}

/// Of the light of a uniform sky on a floor, a black sphere of radius r blocks (r / h)^2 cos, where its centre is at
/// distance h, at an angle of that cosine to the normal, and a disc parallel to the floor r^2 / (r^2 + h^2).
#[test]
fn form_factors() {
    let sphere = |radius: f64, [x, y, z]: [f64; 3]| {
        let squared = x * x + y * y + z * z;
        (
            format!("sphere(center: ({x}, {y}, {z}), radius: {radius}, material: \"black\"),"),
            radius * radius / squared * y / squared.sqrt(),
        )
    };
    let disc = |radius: f64, height: f64| {
        const SIDES: u32 = 64;
        // A polygon of the same area as the circle.
        let step = 2.0 * PI / f64::from(SIDES);
        let vertex = |i: u32| {
            let (sin, cos) = (step * f64::from(i)).sin_cos();
            let radius = radius * (step / step.sin()).sqrt();
            format!("({}, {height}, {})", radius * cos, radius * sin)
        };
        let triangle = |i: u32| {
            format!(
                "triangle(vertices: [(0, {height}, 0), {}, {}], material: \"black\"),",
                vertex(i),
                vertex(i + 1)
            )
        };
        (
            (0..SIDES).map(triangle).collect(),
            radius * radius / (radius * radius + height * height),
        )
    };
    let view = [DVec3::new(-9.0, 1.0, 0.0), DVec3::ZERO];
    for (blocker, form_factor) in [
        sphere(0.5, [0.0, 2.0, 0.0]),
        sphere(1.5, [0.0, 2.0, 0.0]),
        sphere(0.5, [1.0, 1.0, 0.0]),
        sphere(0.2, [1.0, 0.25, 0.5]),
        disc(1.0, 1.0),
        disc(0.5, 2.0),
        disc(8.0, 2.0),
    ] {
        let floor = plate(0.0, 20.0, "white");
        let scene = scene(&format!(
            "Scene(
                background: (1, 1, 1),
                materials: {{\"white\": (diffuse: (0.8, 0.8, 0.8)), \"black\": ()}},
                objects: [{floor}{blocker}],
            )"
        ));
        let seen = estimates(&center_estimates(&scene, view, 1, 4096));
        let expected = [Estimate::exact(0.8 * (1.0 - form_factor)); 3];
        assert!(seen[0].error < 1e-3);
        // Sums of 4096 equal numbers in single precision are off by up to 5e-5.
        let agreement = Agreement::of(&seen, &expected, 15, 5e-5);
        assert!(agreement.holds(), "{blocker} {agreement:?}");
    }
}

/// A floor whose shading normals are tilted by an angle gets the light of that part of the hemisphere about the normals
/// which is above its plane: (1 + cos) / 2 of a uniform sky.
#[test]
fn tilted_normals() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("floor.obj");
    for degrees in [0.0, 20.0, 60.0, 80.0_f64] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let floor = format!("v -9 0 -9\nv 0 0 9\nv 9 0 -9\nvn {sin} {cos} 0\nf 1//1 2//1 3//1\n");
        std::fs::write(&file, floor).unwrap();
        let scene = scene(&format!(
            "Scene(
                background: (1, 1, 1),
                materials: {{\"m\": (diffuse: (0.8, 0.8, 0.8))}},
                objects: [model(file: {file:?}, material: \"m\")],
            )"
        ));
        let view = [DVec3::new(1.0, 2.0, 0.5), DVec3::ZERO];
        let seen = estimates(&center_estimates(&scene, view, 1, 4096));
        let expected = [Estimate::exact(0.8 * (1.0 + cos) / 2.0); 3];
        assert!(seen[0].error < 1e-3);
        let agreement = Agreement::of(&seen, &expected, 15, 5e-5);
        assert!(agreement.holds(), "{degrees} degrees: {agreement:?}");
    }
}

/// The albedo of a diffuse surface that is blended with a mirror.
fn albedo(diffuse: f64, reflective: f64) -> f64 {
    diffuse * (1.0 - reflective) + reflective
}

/// In a closed room of one material under ambient light alone, all paths end after the same number of bounces, each of
/// which multiplies the radiance by the albedo.
#[test]
fn furnaces() {
    for diffuse in [0.0, 0.2, 0.7, 1.0] {
        for reflective in [0.0, 0.3, 1.0] {
            let material = format!(
                "materials: {{\"m\": (diffuse: ({diffuse}, {diffuse}, {diffuse}), reflective: ({reflective}, {reflective}, {reflective}))}},"
            );
            let room = closed_room(&material);
            let albedo = albedo(diffuse, reflective) as f32;
            for bounces in 0..=6 {
                let room = render(
                    &room,
                    &room_view(),
                    &settings(monte_carlo(bounces, &[3]), 8, 6),
                );
                for pixel in room {
                    let expected = Vec3::splat(0.3 * albedo.powi(bounces as i32 + 1));
                    assert_close(pixel, expected, 1e-6);
                }
            }
        }
    }
}

/// Where the diffuse colour and the mirror's differ, a path chooses one of them at random.
#[test]
fn colored_furnace() {
    let (diffuse, reflective) = ([0.9, 0.5, 0.2], [0.1, 0.6, 0.3]);
    let room =
        closed_room("materials: {\"m\": (diffuse: (0.9, 0.5, 0.2), reflective: (0.1, 0.6, 0.3))},");
    for bounces in 1..=4 {
        let settings = settings(monte_carlo(bounces, &[16]), 8, 6);
        // Not of single pixels, many of which are equal, as the choices are stratified.
        let means: Vec<Vec<f64>> = runs(&room, &room_view(), &settings, 0..32)
            .iter()
            .map(|run| mean_pixel(run))
            .collect();
        let expected = [0, 1, 2].map(|channel| {
            let albedo = albedo(diffuse[channel], reflective[channel]);
            Estimate::exact(0.3 * albedo.powi(bounces as i32 + 1))
        });
        let agreement = Agreement::of(&estimates(&means), &expected, 31, 1e-6);
        assert!(agreement.holds(), "{bounces} bounces: {agreement:?}");
    }
}

fn mean_pixel(channels: &[f64]) -> Vec<f64> {
    let mean = |channel| {
        let values = channels.iter().skip(channel).step_by(3);
        values.sum::<f64>() * 3.0 / channels.len() as f64
    };
    [0, 1, 2].map(mean).to_vec()
}

fn closed_room(material: &str) -> Scene {
    scene(&format!(
        "Scene({material} ambient: (1, 1, 1), objects: [
            sphere(radius: 3, material: \"m\"),
            sphere(center: (0.7, -0.4, 0), radius: 0.6, material: \"m\"),
            {}
        ])",
        plate(-1.0, 1.5, "m")
    ))
}

fn room_view() -> flythrough::camera::Camera {
    camera(DVec3::new(0.0, 0.5, 2.5), DVec3::new(0.0, -0.5, 0.0), 60.0)
}

/// Under a uniform sky two bodies on a mirror are lit as they and their images without the mirror, except for light
/// that is reflected more than 12 times.
#[test]
fn a_mirror_doubles_the_scene() {
    let bodies = |y: f64| {
        format!(
            "sphere(center: (-0.4, {y}, 0), radius: 0.5, material: \"a\"),
             sphere(center: (0.5, {y}, 0.3), radius: 0.4, material: \"b\"),"
        )
    };
    let materials =
        "materials: {\"a\": (diffuse: (0.8, 0.3, 0.1)), \"b\": (diffuse: (0.1, 0.6, 0.3)),
        \"mirror\": (reflective: (1, 1, 1))},";
    let of = |objects: String, seeds| {
        let scene = scene(&format!(
            "Scene({materials} background: (1, 0.9, 0.8), objects: [{objects}])"
        ));
        let camera = camera(DVec3::new(0.0, 2.5, 2.0), DVec3::new(0.0, 0.5, 0.0), 20.0);
        let runs = runs(
            &scene,
            &camera,
            &settings(monte_carlo(12, &[32]), 16, 12),
            seeds,
        );
        estimates(&runs)
    };
    let mirrored = of(bodies(0.55) + &plate(0.0, 50.0, "mirror"), 0..32);
    let doubled = of(bodies(0.55) + &bodies(-0.55), 32..64);
    let agreement = Agreement::of(&mirrored, &doubled, 31, 1e-6);
    assert!(agreement.holds(), "{agreement:?}");
    let single = Agreement::of(&mirrored, &of(bodies(0.55), 32..64), 31, 1e-6);
    assert!(!single.holds(), "{single:?}");
}
