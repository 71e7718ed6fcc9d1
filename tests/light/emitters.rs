//! Direct light of surfaces that emit, of balls and suns, against closed forms.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::integrator::IntegratorSettings;
use flythrough::render::RenderSettings;
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// The albedo of the receiver.
const ALBEDO: f64 = 0.8;

/// A floor of 20 m, y = 0, and what shines on its middle.
fn floor_scene(lights: &str, objects: &str, half: f64) -> Scene {
    scene(&format!(
        "Scene(
            materials: {{
                \"floor\": (diffuse: ({ALBEDO}, {ALBEDO}, {ALBEDO})),
                \"black\": (),
                \"lamp\": (emission: (1, 2, 4)),
                \"panel\": (emission: (1, 2, 4), two_sided: true),
            }},
            lights: [{lights}],
            objects: [{}{objects}],
        )",
        plate(0.0, half, "floor")
    ))
}

/// Ray traced, and as direct light of path tracing. Paths find emitters, too, unless they are so small that too few do.
fn ways(solid_angle: f64) -> Vec<IntegratorSettings> {
    let mut ways = vec![ray_tracing(), monte_carlo(0, &[1])];
    if solid_angle > 0.1 {
        ways.push(monte_carlo(1, &[256]));
    }
    ways
}

/// What shines on a point of the floor.
struct Shining {
    scene: Scene,
    point: DVec3,
    /// Of the eye above the point.
    height: f64,
    /// About that of what shines.
    solid_angle: f64,
}

impl Shining {
    /// On the middle of a floor of 10 cm.
    fn on_floor(lights: &str, objects: &str, solid_angle: f64) -> Shining {
        Shining {
            scene: floor_scene(lights, objects, 0.05),
            point: DVec3::ZERO,
            height: 1e-5,
            solid_angle,
        }
    }

    /// Sixteen estimates of the irradiance.
    fn irradiances(&self, integrator: IntegratorSettings) -> Vec<Vec<f64>> {
        let eye = self.point + DVec3::new(0.4, 0.3, 0.1) * self.height;
        let settings = RenderSettings {
            shadow_rays: 256,
            ..settings(integrator, 4, 4)
        };
        let camera = camera(eye, self.point, 1e-6);
        let irradiance = |pixel: Vec3| {
            let radiance = channels(&[pixel]).into_iter();
            radiance.map(|radiance| radiance * PI / ALBEDO).collect()
        };
        let pixels = render(&self.scene, &camera, &settings);
        pixels.into_iter().map(irradiance).collect()
    }

    /// Checks the irradiance, for a radiance of (1, 2, 4), in all ways.
    fn check(&self, expected: f64, precision: f64, what: &str) {
        for integrator in ways(self.solid_angle) {
            let seen = estimates(&self.irradiances(integrator.clone()));
            if expected == 0.0 {
                assert!(seen.iter().all(|seen| seen.mean == 0.0), "{what}: {seen:?}");
                continue;
            }
            let all = [1.0, 2.0, 4.0].map(|radiance| Estimate::exact(radiance * expected));
            let agreement = Agreement::of(&seen, &all, 15, 1e-5);
            assert!(
                agreement.holds() && seen[0].error <= precision * expected,
                "{what}, {integrator:?}: {seen:?} {expected} {agreement:?}"
            );
        }
    }
}

/// The irradiance of a polygon of radiance 1 at a point with a normal, all of it above the horizon (Lambert 1760,
/// "Photometria").
fn lambert(corners: &[DVec3], point: DVec3, normal: DVec3) -> f64 {
    let directions: Vec<DVec3> = corners.iter().map(|c| (*c - point).normalize()).collect();
    let edge = |i: usize| {
        let (a, b) = (directions[i], directions[(i + 1) % directions.len()]);
        let cross = a.cross(b);
        let angle = cross.length().atan2(a.dot(b));
        0.5 * angle * cross.normalize().dot(normal)
    };
    (0..directions.len()).map(edge).sum::<f64>().abs()
}

/// The part of a polygon above y = 0 (Sutherland and Hodgman 1974).
fn above(corners: &[DVec3]) -> Vec<DVec3> {
    let mut kept = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if a.y >= 0.0 {
            kept.push(a);
        }
        if (a.y >= 0.0) != (b.y >= 0.0) {
            kept.push(a + (b - a) * (a.y / (a.y - b.y)));
        }
    }
    kept
}

/// A quadrilateral as two triangles.
fn quadrilateral([a, b, c, d]: [DVec3; 4], material: &str) -> String {
    let triangle = |corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|p| format!("({:?}, {:?}, {:?})", p.x, p.y, p.z));
        format!("triangle(vertices: [{a}, {b}, {c}], material: \"{material}\"),")
    };
    triangle([a, b, c]) + &triangle([a, c, d])
}

/// A rectangle about `middle` with these half edges; it faces their cross product.
fn rectangle(middle: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [
        middle - u - v,
        middle + u - v,
        middle + u + v,
        middle - u + v,
    ]
}

/// Above, tilted, cut by the horizon, close, huge, tiny and far: the solid angles reach from 1e-10 to nearly the
/// hemisphere.
#[test]
fn rectangles_by_lamberts_formula() {
    let (x, z) = (DVec3::X, DVec3::Z);
    let down = |middle: DVec3, size: f64| rectangle(middle, size * x, size * z);
    for (corners, precision, what) in [
        (down(DVec3::new(0.0, 1.0, 0.0), 0.5), 6e-3, "above"),
        (down(DVec3::new(2.0, 1.0, -1.0), 0.5), 6e-3, "aside"),
        (down(DVec3::new(0.2, 0.01, 0.1), 0.5), 2e-2, "close"),
        (down(DVec3::new(0.0, 1e-4, 0.0), 5.0), 2e-2, "a lid"),
        (down(DVec3::new(0.0, 1.0, 0.0), 1e-4), 6e-3, "tiny"),
        (
            rectangle(
                DVec3::new(1.0, 1.0, 0.0),
                0.6 * (x + 0.5 * DVec3::Y),
                0.3 * z,
            ),
            6e-3,
            "tilted",
        ),
        (
            rectangle(DVec3::new(1.0, 0.2, 0.0), 0.5 * z, 0.7 * DVec3::Y),
            2e-2,
            "cut by the horizon",
        ),
    ] {
        let expected = lambert(&above(&corners), DVec3::ZERO, DVec3::Y);
        let objects = quadrilateral(corners, "panel");
        Shining::on_floor("", &objects, expected).check(expected, precision, what);
    }
    // The middle between the two is the origin of the scene: the floor is larger.
    for (corners, precision, what) in [
        (
            down(DVec3::new(3e3, 1e4, 0.0), 0.5),
            6e-3,
            "a metre at 10 km",
        ),
        (down(DVec3::new(0.0, 1e3, 0.0), 1e4), 2e-2, "20 km at 1 km"),
    ] {
        let expected = lambert(&corners, DVec3::ZERO, DVec3::Y);
        let far = Shining {
            scene: floor_scene("", &quadrilateral(corners, "panel"), 20.0),
            height: 5.0,
            ..Shining::on_floor("", "", expected)
        };
        far.check(expected, precision, what);
    }
}

/// Edge-on, from behind, of no area, of no radiance, behind a wall that is an ulp thick: nothing, exactly.
#[test]
fn what_does_not_light_is_dark() {
    let (x, z) = (DVec3::X, DVec3::Z);
    let lamp = |y: f64| quadrilateral(rectangle(DVec3::Y * y, 0.5 * x, 0.5 * z), "lamp");
    let up = quadrilateral(rectangle(DVec3::Y, 0.5 * z, 0.5 * x), "lamp");
    let below = f64::from(1.0_f32.next_down());
    let wall = quadrilateral(rectangle(DVec3::Y * below, 3.0 * x, 3.0 * z), "black");
    let edge_on = rectangle(DVec3::new(2.0, 0.0, 0.0), 0.5 * x, 0.5 * z);
    let point = "triangle(vertices: [(0, 1, 0), (0, 1, 0), (0, 1, 0)], material: \"lamp\"),";
    for (objects, is_dark, what) in [
        (lamp(1.0), false, "lamp"),
        (up, true, "from behind"),
        (lamp(1.0) + &wall, true, "behind a wall"),
        (
            lamp(below) + &wall.replace(&format!("{below:?}"), "1.0"),
            false,
            "before a wall",
        ),
        (quadrilateral(edge_on, "panel"), true, "edge-on"),
        (point.to_owned(), true, "of no area"),
    ] {
        let shining = Shining::on_floor("", &objects, 1.0);
        for integrator in ways(1.0) {
            let seen = shining.irradiances(integrator);
            let dark = seen.iter().flatten().all(|value| *value == 0.0);
            assert_eq!(dark, is_dark, "{what}: {seen:?}");
        }
    }
}

/// A sphere of radius r lights as pi L (r / d)^2 cos, wherever all of it is above the horizon; the ball of a point light as
/// the point.
#[test]
fn spheres_and_balls_light_as_points() {
    for (center, radius) in [
        (DVec3::new(0.0, 1.0, 0.0), 0.999),
        (DVec3::new(1.0, 1.0, 0.5), 0.5),
        (DVec3::new(0.0, 1e-3, 0.0), 1e-4),
        (DVec3::new(3e3, 1e4, 0.0), 100.0),
        (DVec3::new(1.0, 2.0, 0.0), 1e-4),
    ] {
        let [x, y, z] = center.to_array();
        let distance = center.length();
        let expected = PI * (radius / distance).powi(2) * y / distance;
        let sphere =
            format!("sphere(center: ({x}, {y}, {z}), radius: {radius}, material: \"lamp\"),");
        let what = format!("{center} {radius}");
        Shining::on_floor("", &sphere, expected).check(expected, 2e-2, &what);
        let [red, green, blue] = [1.0, 2.0, 4.0].map(|radiance| radiance * PI * radius * radius);
        let ball = format!(
            "(position: ({x}, {y}, {z}), intensity: ({red:e}, {green:e}, {blue:e}), radius: {radius}),"
        );
        Shining::on_floor(&ball, "", expected).check(expected, 2e-2, &format!("ball {what}"));
    }
}

/// One emitter cut into triangles, many of them far smaller than others.
#[test]
fn cut_emitters_light_as_the_whole() {
    let (middle, half) = (DVec3::new(0.3, 1.0, 0.2), 0.5);
    let corners = rectangle(middle, half * DVec3::X, half * DVec3::Z);
    let expected = lambert(&corners, DVec3::ZERO, DVec3::Y);
    for columns in [1, 7, 70] {
        // Unequal: the widths grow as squares.
        let at = |i: usize| 2.0 * half * (i as f64 / columns as f64).powi(2) - half;
        let mut objects = String::new();
        for i in 0..columns {
            for j in 0..columns {
                let corner = |i, j| middle + DVec3::new(at(i), 0.0, at(j));
                let cell = [
                    corner(i, j),
                    corner(i + 1, j),
                    corner(i + 1, j + 1),
                    corner(i, j + 1),
                ];
                objects += &quadrilateral(cell, "lamp");
            }
        }
        let what = format!("{} triangles", 2 * columns * columns);
        Shining::on_floor("", &objects, expected).check(expected, 4e-2, &what);
    }
}

/// A cone falls off as glTF defines it, a ball's as a point's.
#[test]
fn spotlights_fall_off_from_inner_to_outer_angle() {
    for radius in [0.0, 0.01] {
        for degrees in [0.0, 15.0, 25.0, 35.0_f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let light = format!(
                "(position: (0, 2, 0), intensity: (4, 8, 16), radius: {radius},
                  spot: (direction: ({sin}, -{cos}, 0), inner: 20, outer: 30)),"
            );
            let [inner, outer] = [20.0, 30.0_f64].map(|angle| angle.to_radians().cos());
            let expected = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
            let what = format!("{degrees} degrees, radius {radius}");
            Shining::on_floor(&light, "", 0.0).check(expected, 2e-2, &what);
        }
    }
}

/// A sun gives a facing surface its irradiance, and of that the visible part of its disc behind the edge of a wall: the
/// penumbra is as wide as the disc.
#[test]
fn suns_and_their_penumbras() {
    let sun = |angle: f64, slope: f64| {
        format!("sun(direction: (0, -1, {slope}), irradiance: (1, 2, 4), angle: {angle}),")
    };
    for angle in [0.0, 0.5, 20.0, 60.0] {
        let expected = 1.0 / 1.25_f64.sqrt();
        let shining = Shining::on_floor(&sun(angle, 0.5), "", 0.0);
        shining.check(expected, 2e-2, &format!("{angle} degrees"));
    }
    // A wall above covers x > 0. At x the sun's disc, of radius tan(angle / 2) on the wall's plane, is cut at a distance of
    // -x from its middle.
    let angle = 2.0_f64;
    let radius = (0.5 * angle).to_radians().tan();
    for part in [-1.5, -0.9, -0.5, 0.0, 0.3, 0.8, 1.2_f64] {
        let wall = rectangle(DVec3::new(10.0, 1.0, 0.0), 10.0 * DVec3::X, 10.0 * DVec3::Z);
        let mut shining = Shining {
            scene: floor_scene(&sun(angle, 0.0), &quadrilateral(wall, "black"), 1.0),
            ..Shining::on_floor("", "", 0.0)
        };
        let cut = part.clamp(-1.0, 1.0);
        let expected = (cut.acos() - cut * (1.0 - cut * cut).sqrt()) / PI;
        shining.point.x = part * radius;
        for integrator in ways(shining.solid_angle) {
            let seen = estimates(&shining.irradiances(integrator));
            let error = (seen[0].mean - expected).abs();
            // The disc is small: its cosine hardly changes over it.
            assert!(
                error < 5.0 * seen[0].error + 1e-3,
                "{part}: {seen:?} {expected}"
            );
        }
    }
    // Of an angle of 0, the edge is hard.
    let wall = rectangle(DVec3::new(10.0, 1.0, 0.0), 10.0 * DVec3::X, 10.0 * DVec3::Z);
    let mut shining = Shining {
        scene: floor_scene(&sun(0.0, 0.0), &quadrilateral(wall, "black"), 1.0),
        height: 1e-6,
        ..Shining::on_floor("", "", 0.0)
    };
    for (x, expected) in [(-1e-5, 1.0), (1e-5, 0.0)] {
        shining.point.x = x;
        let seen = shining.irradiances(ray_tracing());
        assert!(
            seen.iter().all(|pixel| (pixel[0] - expected).abs() < 1e-5),
            "{seen:?}"
        );
    }
}

/// Inside a sphere that emits 1 and reflects rho, each bounce adds the next power of rho.
#[test]
fn a_furnace_that_lights_itself() {
    for (albedo, reflective) in [(0.5, 0.0_f64), (1.0, 0.0), (0.6, 0.4)] {
        let scene = scene(&format!(
            "Scene(
                materials: {{\"m\": (diffuse: ({albedo}, {albedo}, {albedo}), emission: (1, 1, 1), two_sided: true,
                    reflective: ({reflective}, {reflective}, {reflective}))}},
                objects: [sphere(center: (5, -2, 7), radius: 2, material: \"m\")],
            )"
        ));
        let view = camera(DVec3::new(4.5, -2.5, 6.5), DVec3::new(9.0, -2.0, 6.0), 60.0);
        let rho: f64 = albedo * (1.0 - reflective) + reflective;
        for bounces in 0..4 {
            let settings = settings(monte_carlo(bounces, &[scaled(16, 16, 64)]), 8, 6);
            let means: Vec<Vec<f64>> = runs(&scene, &view, &settings, 0..32)
                .iter()
                .map(|run| vec![run.iter().sum::<f64>() / run.len() as f64])
                .collect();
            // The last bounce has direct light by the diffuse part alone: a mirror would take one more.
            let powers: f64 = (0..=bounces as i32).map(|k| rho.powi(k)).sum();
            let last = rho.powi(bounces as i32) * albedo * (1.0 - reflective);
            let expected = [Estimate::exact(powers + last)];
            let agreement = Agreement::of(&estimates(&means), &expected, 31, 1e-5);
            assert!(
                agreement.holds(),
                "{bounces} bounces: {agreement:?} {expected:?}"
            );
        }
    }
}

/// A texture of what is emitted lights as the same pattern of geometry would: here one bright quarter.
#[test]
fn textured_emitters_light_by_their_texture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("quarter.png");
    // Many texels, so that the interpolation between them does not matter.
    let picture = image::RgbImage::from_fn(256, 256, |x, y| {
        image::Rgb([if x < 128 && y < 128 { 255 } else { 0 }; 3])
    });
    picture.save(&file).unwrap();
    let text = |objects: &str| {
        format!(
            "Scene(
                materials: {{
                    \"floor\": (diffuse: ({ALBEDO}, {ALBEDO}, {ALBEDO})),
                    \"lamp\": (emission: (1, 2, 4), emission_texture: {file:?}),
                }},
                objects: [{}{objects}],
            )",
            plate(0.0, 0.05, "floor")
        )
    };
    let corners = rectangle(DVec3::new(0.0, 0.5, 0.0), 0.5 * DVec3::X, 0.5 * DVec3::Z);
    let [a, b, c, d] = corners.map(|p| format!("({}, {}, {})", p.x, p.y, p.z));
    let objects = format!(
        "triangle(vertices: [{a}, {b}, {c}], uvs: [(0, 0), (1, 0), (1, 1)], material: \"lamp\"),
         triangle(vertices: [{a}, {c}, {d}], uvs: [(0, 0), (1, 1), (0, 1)], material: \"lamp\"),"
    );
    // Upper left of the picture: u below a half, v above.
    let quarter = rectangle(
        DVec3::new(-0.25, 0.5, 0.25),
        0.25 * DVec3::X,
        0.25 * DVec3::Z,
    );
    let expected = lambert(&quarter, DVec3::ZERO, DVec3::Y);
    let shining = Shining {
        scene: scene(&text(&objects)),
        ..Shining::on_floor("", "", expected)
    };
    shining.check(expected, 2e-2, "a quarter");
}

/// A mirrored object emits from the mirror image of its front: one whose front is up in its own space does so still.
#[test]
fn mirrored_surfaces_emit_from_their_front() {
    let folder = tempfile::tempdir().unwrap();
    let quad = folder.path().join("quad.obj");
    let text = "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n";
    std::fs::write(&quad, text).unwrap();
    let triangle = "triangle(vertices: [(-1, 0, 1), (1, 0, 1), (0, 0, -1)]";
    let varied = "vertex_materials: [\"lamp\", \"lamp\", \"black\"]";
    for object in [
        format!("{triangle}, material: \"lamp\""),
        format!("{triangle}, {varied}"),
        format!("model(file: {quad:?}, material: \"lamp\""),
    ] {
        // The edge whose vertices emit in all of them is at this z.
        for (scale, edge, up) in [
            ("(1, 1, 1)", 1.0, true),
            ("(-1, 1, 1)", 1.0, true),
            ("(1, -1, 1)", 1.0, false),
            ("(1, 1, -2)", -2.0, true),
            ("(-1, -1, 1)", 1.0, false),
            ("(-1, -1, -1)", -1.0, false),
        ] {
            let scene = scene(&format!(
                "Scene(
                    materials: {{\"lamp\": (emission: (1, 2, 4)), \"black\": ()}},
                    objects: [{object}, scale: {scale})],
                )"
            ));
            let target = DVec3::new(0.3, 0.0, 0.999 * edge);
            for (eye, is_above) in [(2.0, true), (-2.0, false)] {
                let eye = DVec3::new(0.1, eye, 0.0);
                let seen = center_radiance(&scene, ray_tracing(), eye, target);
                let expected = if up == is_above { 1.0 } else { 0.0 };
                assert_close(seen, expected * Vec3::new(1.0, 2.0, 4.0), 0.01);
            }
        }
    }
}
