//! Light with known answers: analytic cases, symmetries, and means of another renderer.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use flythrough::integrator::Integrator;
use flythrough::render::PixelSampling;
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use support::*;

/// A square [-1, 1] in x and z at height y, of one material.
fn plate(y: f64, half: f64, material: &str) -> String {
    format!(
        "triangle(vertices: [(-{half}, {y}, {half}), ({half}, {y}, {half}), ({half}, {y}, -{half})], material: \"{material}\"),
         triangle(vertices: [(-{half}, {y}, {half}), ({half}, {y}, -{half}), (-{half}, {y}, -{half})], material: \"{material}\"),"
    )
}

fn light(position: &str, intensity: f64) -> String {
    format!("(position: {position}, intensity: ({intensity}, {intensity}, {intensity})),")
}

const GREY: &str = "materials: {\"grey\": (diffuse: (0.5, 0.5, 0.5))},";

/// nori pa1: two parallel plates, camera between them, looking straight at the lower one. Radiance
/// is albedo / pi I cos / d^2, with I = power / 4 pi.
#[test]
fn direct_light_on_a_plate() {
    let inside = light("(0, 0, 0)", 78.956 / (4.0 * PI));
    let aside = light("(0.5, 0.1, 0)", 8.0 / (4.0 * PI));
    let above = light("(0.5, 2, 0)", 8.0 / (4.0 * PI));
    let cases = [
        (inside.clone(), 1.0),
        (aside.clone(), 0.063_178),
        (above.clone(), 0.0),
        (format!("{inside}{aside}{above}"), 1.063_178),
    ];
    for (lights, expected) in cases {
        let plates = plate(1.0, 1.0, "grey") + &plate(-1.0, 1.0, "grey");
        let scene = scene(&format!(
            "Scene({GREY} lights: [{lights}], objects: [{plates}])"
        ));
        // The camera looks down a little aslant, since look_at refuses the vertical.
        let seen = look(
            &scene,
            ray_tracing(),
            DVec3::ZERO,
            DVec3::new(1e-4, -1.0, 0.0),
        );
        assert_close(seen, Vec3::splat(expected), 2e-5);
    }
}

/// pbrt-v4: inside a unit sphere of albedo 1/2 a light of intensity pi gives 1/2 directly and
/// 1/2^(k+1) by its k-th bounce. So do four lights of a quarter each.
#[test]
fn light_inside_a_sphere_bounce_by_bounce() {
    let ball = "sphere(radius: 1, material: \"grey\"),";
    for lights in [
        light("(0, 0, 0)", PI),
        light("(0, 0, 0)", PI / 4.0).repeat(4),
    ] {
        let scene = scene(&format!(
            "Scene({GREY} lights: [{lights}], objects: [{ball}])"
        ));
        let target = DVec3::new(0.3, 0.2, -1.0);
        let direct = look(&scene, ray_tracing(), DVec3::ZERO, target);
        assert_close(direct, Vec3::splat(0.5), 1e-6);
        for bounces in [0, 1, 2, 3, 4, 20] {
            let expected = 1.0 - 0.5_f32.powi(bounces as i32 + 1);
            let seen = look(&scene, monte_carlo(bounces, &[4, 2]), DVec3::ZERO, target);
            assert_close(seen, Vec3::splat(expected), 5e-6);
        }
    }
}

/// Inside a sphere of radius R a light of intensity I anywhere gives the wall the indirect
/// irradiance rho^k I / R^2 by bounce k, the same everywhere.
#[test]
fn light_off_the_centre_of_a_sphere() {
    lit_alike_all_over("(5.9, -1.2, 7.4)");
}

/// The same with a light that throws a spot on the wall beside it, a hundred times as bright as the rest.
#[test]
fn light_by_the_wall_of_a_sphere() {
    assert!(!lit_alike_all_over("(6.9, -2, 7)").spots().is_empty());
}

fn lit_alike_all_over(position: &str) -> Scene {
    let ball = "sphere(center: (5, -2, 7), radius: 2, material: \"grey\"),";
    let lights = light(position, 3.0);
    let scene = scene(&format!(
        "Scene({GREY} lights: [{lights}], objects: [{ball}])"
    ));
    let eye = DVec3::new(4.5, -2.5, 6.5);
    for target in [DVec3::new(9.0, -2.0, 6.0), DVec3::new(3.0, -3.0, 9.0)] {
        let direct = look(&scene, monte_carlo(0, &[]), eye, target);
        for bounces in 1..=4_u32 {
            let indirect: f64 = (1..=bounces as i32)
                .map(|k| 0.5_f64.powi(k) * 3.0 / 4.0)
                .sum();
            let expected = direct + Vec3::splat((0.5 / PI * indirect) as f32);
            // Sixteen pixels that see the same give sixteen independent estimates.
            let settings = settings(monte_carlo(bounces, &[4096]), 4, 4);
            let pixels = render(&scene, &camera(eye, target, 1e-6), &settings);
            let mean = pixels.iter().sum::<Vec3>() / 16.0;
            let variance = pixels.iter().map(|p| (p.x - mean.x).powi(2)).sum::<f32>() / 15.0;
            // Five standard errors.
            assert_close(mean, expected, 5.0 * (variance / 16.0).sqrt() + 1e-6);
        }
    }
    scene
}

/// Mitsuba 3's PointLightIntensity scene: its own reference image has the mean 0.269208.
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
    let mut settings = settings(ray_tracing(), 128, 128);
    settings.sampling = PixelSampling::Spread(64);
    let pixels = render(&scene, &camera, &settings);
    let mean = pixels.iter().sum::<Vec3>() / pixels.len() as f32;
    assert_close(mean, Vec3::splat(0.269_208), 1.5e-4);
}

#[test]
fn constant_falloff_ambient_and_phong_by_hand() {
    let scene = scene(&format!(
        "Scene(
            ambient: (1, 0.5, 0),
            materials: {{\"m\": (diffuse: (0.5, 0.5, 0.5), specular: (0.25, 0.25, 0.25), shininess: 2)}},
            lights: [(position: (3, 3, 0), intensity: (2, 2, 2), falloff: constant)],
            objects: [{}],
        )",
        plate(0.0, 9.0, "m")
    ));
    // Eye and light both 45 degrees off the normal, on opposite sides: R.V = 1, and on the same
    // side: R.V = 0.
    let diffuse = 2.0 * 0.5 * 0.5_f32.sqrt();
    let ambient = Vec3::new(0.15, 0.075, 0.0);
    let across = look(
        &scene,
        ray_tracing(),
        DVec3::new(-3.0, 3.0, 0.0),
        DVec3::ZERO,
    );
    assert_close(across, ambient + diffuse + 0.5, 1e-5);
    let beside = look(
        &scene,
        ray_tracing(),
        DVec3::new(3.0, 3.0, 0.0),
        DVec3::ZERO,
    );
    assert_close(beside, ambient + diffuse, 1e-5);
}

#[test]
fn only_what_is_between_throws_a_shadow() {
    let seen = |blocker: &str| {
        let scene = scene(&format!(
            "Scene({GREY} lights: [{}], objects: [{}{blocker}])",
            light("(0, 2, 0)", 4.0 * PI),
            plate(0.0, 9.0, "grey")
        ));
        look(
            &scene,
            ray_tracing(),
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::ZERO,
        )
        .x
    };
    let lit = seen("");
    assert!((lit - 0.5).abs() < 1e-5);
    assert_eq!(
        seen("sphere(radius: 0.3, center: (0, 1, 0), material: \"grey\"),"),
        0.0
    );
    assert_eq!(
        seen("sphere(radius: 0.3, center: (0, 3, 0), material: \"grey\"),"),
        lit
    );
    assert_eq!(seen(&plate(2.5, 1.0, "grey")), lit);
    // A light on a surface lights the surface's side that it is on.
    assert_eq!(seen(&plate(2.0, 1.0, "grey")), lit);
}

/// Between two parallel mirrors of share r, with ambient light A and no lights: each of the
/// `bounces + 1` surfaces adds (1 - r) 0.3 A kd, and the last mirror 0.3 A.
#[test]
fn two_mirrors_face_each_other() {
    let (r, kd, ambient) = (0.75_f32, 0.5_f32, 2.0_f32);
    let scene = scene(
        "Scene(
            ambient: (2, 2, 2),
            materials: {\"m\": (diffuse: (0.5, 0.5, 0.5), reflective: (0.75, 0.75, 0.75))},
            objects: [
                triangle(vertices: [(1, -9, -9), (1, 9, -9), (1, 0, 9)], material: \"m\"),
                triangle(vertices: [(-1, -9, -9), (-1, 9, -9), (-1, 0, 9)], material: \"m\"),
            ],
        )",
    );
    for bounces in 0..=4 {
        let own: f32 = (0..=bounces)
            .map(|k| r.powi(k) * (1.0 - r) * 0.3 * ambient * kd)
            .sum();
        let expected = own + r.powi(bounces + 1) * 0.3 * ambient;
        let integrator = Integrator::RayTracing {
            bounces: bounces as u32,
        };
        let seen = look(&scene, integrator, DVec3::ZERO, DVec3::new(1.0, 0.1, 0.05));
        assert_close(seen, Vec3::splat(expected), 1e-6);
    }
}

/// What a mirror shows is what stands behind it in the twin world, lit by the twin light.
#[test]
fn a_mirror_shows_the_mirrored_world() {
    let balls = |y: f64| {
        format!(
            "sphere(center: (-0.4, {y}, -0.2), radius: 0.5, material: \"a\"),
             sphere(center: (0.5, {}, 0.3), radius: 0.3, material: \"b\"),",
            1.2 * y
        )
    };
    let materials =
        "materials: {\"a\": (diffuse: (0.8, 0.3, 0.1), specular: (0.4, 0.4, 0.4), shininess: 9),
        \"b\": (diffuse: (0.1, 0.6, 0.3)), \"mirror\": (reflective: (1, 1, 1))},";
    let world = scene(&format!(
        "Scene({materials} background: (0.1, 0.2, 0.3), lights: [{}],
         objects: [{}{}])",
        light("(2, 4, 3)", 40.0),
        balls(2.0),
        plate(0.0, 50.0, "mirror")
    ));
    let twin = scene(&format!(
        "Scene({materials} background: (0.1, 0.2, 0.3), lights: [{}], objects: [{}])",
        light("(2, -4, 3)", 40.0),
        balls(-2.0)
    ));
    // From just above the mirror, looking down into it: every ray is reflected once.
    let camera = camera(DVec3::new(0.1, 0.01, 3.0), DVec3::new(0.0, -1.2, 0.0), 50.0);
    let settings = settings(ray_tracing(), 64, 48);
    let (seen, expected) = (
        render(&world, &camera, &settings),
        render(&twin, &camera, &settings),
    );
    let same = seen
        .iter()
        .zip(&expected)
        .filter(|(a, b)| (**a - **b).abs().max_element() < 2e-3);
    // Rounding may move a silhouette or a shadow's edge across a pixel's middle.
    assert!(same.count() >= seen.len() - 4);
    assert!(expected.iter().any(|p| p.x > 0.3));
}

/// Corners of different materials: at barycentric (1/2, 1/4, 1/4) all parts are mixed so.
#[test]
fn per_vertex_materials_mix() {
    let scene = scene(
        "Scene(
            ambient: (1, 1, 1),
            background: (0, 0, 4),
            materials: {
                \"red\": (diffuse: (1, 0, 0)),
                \"green\": (diffuse: (0, 1, 0)),
                \"mirror\": (reflective: (1, 1, 1)),
            },
            objects: [
                triangle(vertices: [(0, 0, 0), (4, 0, 0), (0, 4, 0)], vertex_materials: [\"red\", \"green\", \"mirror\"]),
            ],
        )",
    );
    let seen = look(
        &scene,
        ray_tracing(),
        DVec3::new(1.0, 1.0, 5.0),
        DVec3::new(1.0, 1.0, 0.0),
    );
    let own = 0.3 * Vec3::new(0.5, 0.25, 0.0);
    assert_close(seen, 0.75 * own + 0.25 * Vec3::new(0.0, 0.0, 4.0), 1e-5);
}

/// A black room: the light gathered over the hemisphere adds nothing.
#[test]
fn without_diffuse_surfaces_montecarlo_is_direct_light() {
    let black = "materials: {\"m\": (specular: (0.5, 0.5, 0.5), shininess: 5)},";
    let scene = scene(&format!(
        "Scene({black} lights: [{}], objects: [{}])",
        light("(1, 2, 0)", 9.0),
        plate(0.0, 5.0, "m") + &plate(3.0, 5.0, "m")
    ));
    let camera = camera(DVec3::new(0.0, 1.0, 4.0), DVec3::ZERO, 60.0);
    let direct = render(&scene, &camera, &settings(ray_tracing(), 32, 24));
    let gathered = render(&scene, &camera, &settings(monte_carlo(4, &[8]), 32, 24));
    assert_eq!(direct, gathered);
}

/// In montecarlo a path without bounces left returns 0.3 ambient, and one that leaves the scene
/// the background: a white plate under an even sky of 1 is 1.
#[test]
fn skies_and_the_ends_of_paths() {
    let plate_under = |sky: f64, ambient: f64| {
        scene(&format!(
            "Scene(background: ({sky}, {sky}, {sky}), ambient: ({ambient}, {ambient}, {ambient}),
             materials: {{\"m\": (diffuse: (0.8, 0.8, 0.8))}}, objects: [{}])",
            plate(0.0, 5.0, "m")
        ))
    };
    let (eye, target) = (DVec3::new(0.0, 2.0, 1.0), DVec3::ZERO);
    let lit_by_sky = look(&plate_under(1.0, 0.0), monte_carlo(3, &[16]), eye, target);
    assert_close(lit_by_sky, Vec3::splat(0.8), 1e-6);
    let no_bounce = look(&plate_under(1.0, 2.0), monte_carlo(0, &[16]), eye, target);
    assert_close(no_bounce, Vec3::splat(0.3 * 2.0 * 0.8), 1e-6);
}

/// Every schedule of splits has the same expected value.
#[test]
fn splits_change_the_noise_and_not_the_mean() {
    let scene = shipped_scene("test3.ron");
    let camera = shipped_path("test3.ron").camera(0);
    let mean = |splits: &[u32], samples: u32| {
        let mut settings = settings(monte_carlo(3, splits), 16, 12);
        settings.sampling = PixelSampling::Spread(samples);
        let pixels = render(&scene, &camera, &settings);
        pixels.iter().sum::<Vec3>() / pixels.len() as f32
    };
    let reference = mean(&[32, 1, 1], 128);
    assert_close(mean(&[1], 2048), reference, 0.01 * reference.x);
    assert_close(mean(&[4, 4, 4], 128), reference, 0.01 * reference.x);
}

/// Means of blocks of test3 against Mitsuba 3's `path` integrator with max_depth = bounces + 2.
#[test]
fn means_agree_with_mitsuba() {
    const SEEDS: u32 = 16;
    let scene = shipped_scene("test3.ron");
    let camera = shipped_path("test3.ron").camera(0);
    let reference = include_str!("reference/test3_mitsuba.csv");
    let rows: Vec<Vec<f64>> = reference
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            line.split(',')
                .map(|number| number.parse().unwrap())
                .collect()
        })
        .collect();
    assert_eq!(rows.len(), 4 * 48);
    for bounces in [0, 1, 2, 4] {
        let runs: Vec<Vec<Vec3>> = (0..SEEDS)
            .map(|seed| {
                let mut settings = settings(monte_carlo(bounces, &[4, 1]), 80, 60);
                settings.sampling = PixelSampling::Spread(4);
                settings.seed = seed;
                block_means(&render(&scene, &camera, &settings))
            })
            .collect();
        for row in rows.iter().filter(|row| row[0] == f64::from(bounces)) {
            let block = (row[2] * 8.0 + row[1]) as usize;
            for channel in 0..3 {
                let values = runs.iter().map(|run| f64::from(run[block][channel]));
                let n = f64::from(SEEDS);
                let mean = values.clone().sum::<f64>() / n;
                let variance = values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
                let (expected, expected_error) = (row[3 + channel], row[6 + channel]);
                // 576 comparisons, Student's t with 15 degrees of freedom: 6 standard errors are
                // exceeded by chance once in a hundred runs of this test; rounding adds a little.
                let error = (variance / n + expected_error.powi(2)).sqrt();
                let limit = 6.0 * error + 1e-5;
                assert!(
                    (mean - expected).abs() <= limit,
                    "{bounces} bounces, block {block}, channel {channel}: {mean} for {expected}"
                );
            }
        }
    }
}

/// Means of the 8 x 6 blocks of 10 x 10 pixels of an 80 x 60 picture.
fn block_means(pixels: &[Vec3]) -> Vec<Vec3> {
    let block = |x: usize, y: usize| {
        let rows = pixels.chunks_exact(80).skip(10 * y).take(10);
        rows.flat_map(|row| &row[10 * x..10 * x + 10]).sum::<Vec3>() / 100.0
    };
    (0..6)
        .flat_map(|y| (0..8).map(move |x| block(x, y)))
        .collect()
}
