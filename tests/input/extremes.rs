//! Scenes with the largest and the smallest numbers that are accepted: their radiance is finite.

use crate::support::statistics::spread;
use crate::support::*;
use glam::DVec3;

/// Renders the objects and lights, seen from `eye`, in both kinds of mode; returns the brightest channel.
fn brightest(text: &str, eye: DVec3, target: DVec3, degrees: f64) -> f32 {
    let scene = scene(&format!(
        "Scene(background: (0.1, 0.2, 0.3), ambient: (1, 1, 1), materials: {{
            \"grey\": (diffuse: (0.5, 0.5, 0.5)),
            \"shiny\": (diffuse: (0.5, 0.5, 0.5), specular: (1, 1, 1), shininess: 1e6),
            \"mirror\": (reflective: (1, 1, 1)),
        }}, {text})"
    ));
    let camera = camera(eye, target, degrees);
    let mut brightest = 0.0_f32;
    for integrator in [ray_tracing(), monte_carlo(4, &[4])] {
        for pixel in render(&scene, &camera, &spread(integrator, [12, 8], 2)) {
            assert!(
                pixel.is_finite() && pixel.min_element() >= 0.0,
                "{text}: {pixel}"
            );
            brightest = brightest.max(pixel.max_element());
        }
    }
    brightest
}

/// The brightest channel of the background.
const BACKGROUND: f32 = 0.3;

#[test]
fn spheres() {
    for radius in [1e-15, 1e-12, 1e-6, 1.0, 1e6, 1e12, 1e14] {
        for material in ["grey", "shiny", "mirror"] {
            let text = format!(
                "objects: [sphere(radius: {radius:e}, material: \"{material}\")],
                 lights: [(position: (0, {}, {}), intensity: (1, 1, 1), falloff: constant)]",
                3.0 * radius,
                9.0 * radius,
            );
            let eye = DVec3::Z * 3.0 * radius;
            let seen = brightest(&text, eye, DVec3::ZERO, 40.0);
            assert!(material == "mirror" || seen > BACKGROUND, "{text}: {seen}");
            // From inside it is enough that it renders.
            brightest(&text, eye * 0.1, DVec3::ZERO, 40.0);
        }
    }
}

/// A plate of two triangles across the view.
fn plate(size: f64, material: &str) -> String {
    let triangle = |vertices: &str| {
        format!(
            "triangle(vertices: [{vertices}], scale: ({size:e}, {size:e}, {size:e}), {material})"
        )
    };
    format!(
        "{}, {}",
        triangle("(-1, -1, 0), (1, -1, 0), (1, 1, 0)"),
        triangle("(-1, -1, 0), (1, 1, 0), (-1, 1, 0)")
    )
}

#[test]
fn triangles() {
    for size in [1e-14, 1e-10, 1e-5, 1.0, 1e5, 1e10, 1e14] {
        for material in [
            "material: \"grey\"",
            "material: \"shiny\"",
            "vertex_materials: [\"grey\", \"shiny\", \"mirror\"]",
            "material: \"grey\", uvs: [(1e15, -1e15), (1e-320, 1e15), (0, 0)]",
        ] {
            let text = format!(
                "objects: [{}], lights: [(position: (0, {size:e}, {size:e}), intensity: (1, 1, 1), \
                 falloff: constant)]",
                plate(size, material)
            );
            let seen = brightest(&text, DVec3::Z * 3.0 * size, DVec3::ZERO, 30.0);
            assert!(seen > BACKGROUND, "{text}: {seen}");
        }
    }
}

#[test]
fn lights() {
    let brightest_under = |lights: &str| {
        let text = format!(
            "objects: [{}], lights: [{lights}]",
            plate(2.0, "material: \"shiny\"")
        );
        brightest(&text, DVec3::new(0.1, 0.2, 3.0), DVec3::ZERO, 40.0)
    };
    let light = |z: f64, intensity: f64| {
        format!("(position: (0.1, 0, {z:e}), intensity: ({intensity:e}, 0, 1e-300))")
    };
    // In the plate, within rounding of it, near, far, and as far as is accepted.
    for z in [0.0, 1e-300, 1e-15, 1e-8, 1e-4, 1.0, 1e8, 1e15] {
        for intensity in [0.0, 1e-300, 1e-40, 1.0, 1e15] {
            brightest_under(&light(z, intensity));
        }
    }
    assert!(brightest_under(&light(1.0, 1e15)) > 1e13);
    assert!(
        brightest_under(&[light(1e-4, 1e15), light(1.0, 1e15), light(-1e-4, 1.0)].join(", "))
            > 1e13
    );
}

#[test]
fn cameras() {
    let text = format!(
        "objects: [{}, sphere(radius: 1, material: \"mirror\")],
         lights: [(position: (0, 0, 5), intensity: (9, 9, 9))]",
        plate(2.0, "material: \"grey\"")
    );
    for eye in [
        DVec3::ZERO,
        DVec3::Z,
        DVec3::Z * (1.0 + 1e-9),
        DVec3::Z * 0.5,
        DVec3::new(0.0, 0.0, 5.0),
        DVec3::new(2.0, 0.0, 0.0),
        DVec3::new(1e7, 0.0, 1e7),
        DVec3::splat(1e15),
    ] {
        for degrees in [1e-300, 1e-9, 50.0, 179.999, 179.999_999_999_999] {
            brightest(&text, eye, DVec3::new(0.1, 0.0, -1.0), degrees);
        }
    }
}

#[test]
fn ambient_light_and_background_of_extreme_brightness() {
    for (ambient, background) in [(1e15, 1e15), (1e-320, 1e-45), (1e15, 0.0)] {
        let scene = scene(&format!(
            "Scene(ambient: ({ambient:e}, 0, 1), background: (1, {background:e}, 0),
                materials: {{\"m\": (diffuse: (1, 1, 1), specular: (1e15, 1, 1))}},
                objects: [sphere(radius: 1, material: \"m\")])"
        ));
        let camera = camera(DVec3::Z * 3.0, DVec3::ZERO, 50.0);
        for integrator in [ray_tracing(), monte_carlo(64, &[2, 2])] {
            let pixels = render(&scene, &camera, &settings(integrator, 8, 8));
            assert!(pixels.iter().all(|p| p.is_finite()));
        }
    }
}
