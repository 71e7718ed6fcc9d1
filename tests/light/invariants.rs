//! Invariants of light transport, which hold in any scene.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::accel::QueryState;
use flythrough::camera::Camera;
use flythrough::integrator::{CameraSample, Integrator, LightSampler};
use flythrough::light::PointLight;
use flythrough::math::Ray;
use flythrough::sampling::{SobolSequence, uniform_sphere};
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

const SIZE: [u32; 2] = [16, 12];

fn room() -> (Scene, Camera) {
    (
        shipped_scene("test3.ron"),
        shipped_path("test3.ron").camera(0),
    )
}

/// A power of two changes no digit of any product or sum.
#[test]
fn twice_the_intensity_is_twice_the_light() {
    let (mut scene, camera) = room();
    let settings = spread(monte_carlo(4, &[4, 2]), SIZE, 2);
    let before = render(&scene, &camera, &settings);
    for light in &mut scene.lights {
        light.intensity *= 2.0;
    }
    let after = render(&scene, &camera, &settings);
    assert!(before.iter().any(|pixel| pixel.x > 0.1));
    let twice: Vec<Vec3> = before.iter().map(|pixel| 2.0 * pixel).collect();
    assert_eq!(after, twice);
}

/// Scenes with the first light, with the second, and with both.
fn lit_by_first_second_both(lowered: f32) -> ([Scene; 3], Camera) {
    let scenes = [0..1, 1..2, 0..2].map(|lights| {
        let (mut scene, _) = room();
        scene.lights = scene.lights[lights].to_vec();
        for light in &mut scene.lights {
            light.position.y -= lowered;
        }
        scene
    });
    (scenes, room().1)
}

/// Lights far from walls guide no paths, so that paths are the same with one light and with both.
#[test]
fn radiance_of_two_lights_is_the_sum_for_the_same_paths() {
    let (scenes, camera) = lit_by_first_second_both(0.5);
    assert!(LightSampler::new(&scenes[2]).is_empty());
    let settings = spread(monte_carlo(4, &[4, 2]), SIZE, 2);
    let [first, second, both] = scenes.map(|scene| render(&scene, &camera, &settings));
    for ((first, second), both) in first.iter().zip(&second).zip(&both) {
        assert_close(*both, first + second, 2e-6 * both.max_element());
    }
}

/// Lights near walls guide paths, so that paths depend on the lights of the scene.
#[test]
fn radiance_of_two_lights_is_the_sum_on_average() {
    let (scenes, camera) = lit_by_first_second_both(0.0);
    assert!(
        scenes
            .iter()
            .all(|scene| !LightSampler::new(scene).is_empty())
    );
    let seeds = [0..32, 32..64, 64..96];
    let of = |i: usize| {
        let settings = settings(monte_carlo(4, &[32]), SIZE[0], SIZE[1]);
        estimates(&runs(&scenes[i], &camera, &settings, seeds[i].clone()))
    };
    let [first, second, both] = [0, 1, 2].map(of);
    let sum = first.iter().zip(&second).map(|(first, second)| Estimate {
        mean: first.mean + second.mean,
        error: first.error.hypot(second.error),
    });
    let agreement = Agreement::of(&both, &sum.collect::<Vec<_>>(), 31, 0.0);
    assert!(agreement.holds(), "{agreement:?}");
    let first_only = Agreement::of(&both, &first, 31, 0.0);
    assert!(!first_only.holds(), "{first_only:?}");
}

/// Under a uniform sky of 1, with paths that end in 1, materials without absorption have the radiance 1: diffuse,
/// mirror, or both. With interpolated normals light that would go into the surface may be lost, but none is added.
#[test]
fn no_light_is_added() {
    let model = root().join("scenes/models/knot.obj");
    let model = format!(
        "model(file: {model:?}, scale: (1.5, 1.5, 1.5), translation: (0.5, -1, 0), material: \"half\"),"
    );
    let of = |more: &str| {
        let floor = plate(-1.0, 2.0, "white");
        scene(&format!(
            "Scene(
                background: (1, 1, 1),
                ambient: (3.3333333, 3.3333333, 3.3333333),
                materials: {{
                    \"white\": (diffuse: (1, 1, 1)),
                    \"half\": (diffuse: (1, 1, 1), reflective: (0.5, 0.5, 0.5)),
                    \"mirror\": (diffuse: (1, 1, 1), reflective: (1, 1, 1)),
                }},
                objects: [
                    {floor}
                    sphere(center: (-0.6, -0.5, 0), radius: 0.5, material: \"half\"),
                    sphere(center: (0.1, -0.7, 0.7), radius: 0.3, material: \"mirror\"),
                    triangle(vertices: [(-2, -1, -1), (2, -1, -1), (0, 2, -1)], vertex_materials: [\"white\", \"half\", \"mirror\"]),
                    {more}
                ],
            )"
        ))
    };
    let (flat, smooth) = (of(""), of(&model));
    let camera = camera(DVec3::new(-0.5, 0.5, 3.0), DVec3::new(0.0, -0.5, 0.0), 45.0);
    for bounces in 0..=6 {
        let settings = spread(monte_carlo(bounces, &[4, 2]), [32, 24], 2);
        for pixel in render(&flat, &camera, &settings) {
            assert_close(pixel, Vec3::ONE, 2e-6);
        }
        let smooth = render(&smooth, &camera, &settings);
        let brightest = smooth
            .iter()
            .map(|pixel| pixel.max_element())
            .fold(0.0, f32::max);
        let mean = smooth.iter().sum::<Vec3>() / smooth.len() as f32;
        assert!(
            brightest <= 1.0 + 2e-6 && mean.x > 0.99,
            "{brightest}, {mean}"
        );
    }
}

/// Helmholtz reciprocity: among diffuse surfaces the mean radiance that arrives at one point from all directions, while
/// a light is at another, is the same if the two are exchanged, after each bounce. Both are so close to a wall that a
/// light there guides paths.
#[test]
fn light_and_eye_may_be_exchanged() {
    let text = std::fs::read_to_string(root().join("scenes/test3.ron")).unwrap();
    let without_mirror = text.replace(", reflective: (0.8, 0.8, 0.8)", "");
    assert!(without_mirror != text);
    let positions = [DVec3::new(0.6, 0.85, -0.3), DVec3::new(-0.8, -0.2, 0.5)];
    let around = |eye: DVec3, light: DVec3, seeds: std::ops::Range<u32>| {
        let mut scene = scene(&without_mirror);
        scene.lights = vec![PointLight::isotropic(
            (light - scene.origin).as_vec3(),
            Vec3::ONE,
        )];
        assert!(!LightSampler::new(&scene).is_empty());
        let run = |seed| {
            let of_bounces = |bounces| radiance_around(&scene, eye, bounces, seed);
            (0..=4).flat_map(of_bounces).collect()
        };
        let runs: Vec<Vec<f64>> = seeds.into_par_iter().map(run).collect();
        estimates(&runs)
    };
    let there = around(positions[0], positions[1], 0..32);
    let back = around(positions[1], positions[0], 32..64);
    assert!(there.iter().all(|there| there.mean > 50.0 * there.error));
    let agreement = Agreement::of(&there, &back, 31, 0.0);
    assert!(agreement.holds(), "{agreement:?}");
}

/// The mean radiance that arrives from all directions.
fn radiance_around(scene: &Scene, eye: DVec3, bounces: u32, seed: u32) -> Vec<f64> {
    const RAYS: u32 = 1 << 14;
    let sequence = SobolSequence::new(seed, 0, 0, 0);
    let sample = |index| {
        let [u, v] = sequence.sample_2d(index, 0);
        CameraSample {
            ray: Ray::new((eye - scene.origin).as_vec3(), uniform_sphere(u, v)),
            sequence,
            index,
        }
    };
    let samples: Vec<CameraSample> = (0..RAYS).map(sample).collect();
    let mut radiance = vec![Vec3::ZERO; samples.len()];
    let integrator = Integrator::new(scene, &monte_carlo(bounces, &[1]), None).unwrap();
    integrator.radiance(&samples, &[], &mut QueryState::default(), &mut radiance);
    channels(&[radiance.iter().sum::<Vec3>() / RAYS as f32])
}
