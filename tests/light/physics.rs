//! Direct light, materials and mirrors against closed forms.

use crate::support::*;
use flythrough::integrator::IntegratorSettings;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

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
        // The camera looks not quite straight down, since look_at refuses the vertical.
        let seen = center_radiance(
            &scene,
            ray_tracing(),
            DVec3::ZERO,
            DVec3::new(1e-4, -1.0, 0.0),
        );
        assert_close(seen, Vec3::splat(expected), 2e-5);
    }
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
    let across = center_radiance(
        &scene,
        ray_tracing(),
        DVec3::new(-3.0, 3.0, 0.0),
        DVec3::ZERO,
    );
    assert_close(across, ambient + diffuse + 0.5, 1e-5);
    let beside = center_radiance(
        &scene,
        ray_tracing(),
        DVec3::new(3.0, 3.0, 0.0),
        DVec3::ZERO,
    );
    assert_close(beside, ambient + diffuse, 1e-5);
}

#[test]
fn only_what_is_between_surface_and_light_casts_a_shadow() {
    let seen = |blocker: &str| {
        let scene = scene(&format!(
            "Scene({GREY} lights: [{}], objects: [{}{blocker}])",
            light("(0, 2, 0)", 4.0 * PI),
            plate(0.0, 9.0, "grey")
        ));
        center_radiance(
            &scene,
            ray_tracing(),
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::ZERO,
        )
        .x
    };
    let ball = |y: f64| format!("sphere(radius: 0.3, center: (0, {y}, 0), material: \"grey\"),");
    assert_eq!(seen(&ball(1.0)), 0.0);
    // A light on a surface lights what the surface faces.
    for beyond in [
        "",
        &ball(3.0),
        &plate(2.5, 1.0, "grey"),
        &plate(2.0, 1.0, "grey"),
    ] {
        assert!((seen(beyond) - 0.5).abs() < 1e-6, "{beyond}");
    }
}

/// Between two parallel mirrors of reflectance r, with ambient light A and no lights: each of the `bounces + 1`
/// surfaces adds (1 - r) 0.3 A kd, and the last mirror 0.3 A.
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
        let surfaces: f32 = (0..=bounces)
            .map(|k| r.powi(k) * (1.0 - r) * 0.3 * ambient * kd)
            .sum();
        let expected = surfaces + r.powi(bounces + 1) * 0.3 * ambient;
        let integrator = IntegratorSettings::Whitted {
            bounces: bounces as u32,
        };
        let seen = center_radiance(&scene, integrator, DVec3::ZERO, DVec3::new(1.0, 0.1, 0.05));
        assert_close(seen, Vec3::splat(expected), 1e-6);
    }
}

/// A mirror shows the mirrored scene under the mirrored light.
#[test]
fn a_mirror_shows_the_mirrored_scene() {
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
    let scene_with_mirror = scene(&format!(
        "Scene({materials} background: (0.1, 0.2, 0.3), lights: [{}],
         objects: [{}{}])",
        light("(2, 4, 3)", 40.0),
        balls(2.0),
        plate(0.0, 50.0, "mirror")
    ));
    let mirrored_scene = scene(&format!(
        "Scene({materials} background: (0.1, 0.2, 0.3), lights: [{}], objects: [{}])",
        light("(2, -4, 3)", 40.0),
        balls(-2.0)
    ));
    // From just above the mirror, looking down into it: every ray is reflected once.
    let camera = camera(DVec3::new(0.1, 0.01, 3.0), DVec3::new(0.0, -1.2, 0.0), 50.0);
    let settings = settings(ray_tracing(), 64, 48);
    let (seen, expected) = (
        render(&scene_with_mirror, &camera, &settings),
        render(&mirrored_scene, &camera, &settings),
    );
    let same = seen
        .iter()
        .zip(&expected)
        .filter(|(a, b)| (**a - **b).abs().max_element() < 2e-3);
    // Rounding may move a silhouette or a shadow's edge across a pixel's middle.
    assert!(same.count() >= seen.len() - 4);
    assert!(expected.iter().any(|p| p.x > 0.3));
}

/// The materials of vertices are mixed by the barycentric coordinates, here (1/2, 1/4, 1/4).
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
    let seen = center_radiance(
        &scene,
        ray_tracing(),
        DVec3::new(1.0, 1.0, 5.0),
        DVec3::new(1.0, 1.0, 0.0),
    );
    let diffuse = 0.3 * Vec3::new(0.5, 0.25, 0.0);
    assert_close(seen, 0.75 * diffuse + 0.25 * Vec3::new(0.0, 0.0, 4.0), 1e-5);
}

/// Barycentric coordinates are rounded, and may sum to more than 1: the diffuse part of mixed mirrors is none, not less.
#[test]
fn mixed_mirrors_have_no_light_of_their_own() {
    let scene = scene(
        "Scene(
            materials: {\"mirror\": (diffuse: (1, 1, 1), reflective: (1, 1, 1))},
            lights: [(position: (1, 1, 4), intensity: (1e6, 1e6, 1e6), falloff: constant)],
            objects: [
                triangle(
                    vertices: [(-2.7, -3.1, 0), (3.3, -2.7, 0), (0.1, 3.5, 0)],
                    vertex_materials: [\"mirror\", \"mirror\", \"mirror\"],
                ),
            ],
        )",
    );
    let camera = camera(DVec3::new(0.2, 0.1, 4.0), DVec3::ZERO, 50.0);
    for integrator in [ray_tracing(), monte_carlo(2, &[2])] {
        for pixel in render(&scene, &camera, &settings(integrator, 64, 48)) {
            assert_eq!(pixel, Vec3::ZERO);
        }
    }
}

/// Where all diffuse colours are black, indirect light adds nothing.
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
    let path_traced = render(&scene, &camera, &settings(monte_carlo(4, &[8]), 32, 24));
    assert_eq!(direct, path_traced);
}
