//! Radiance with a closed form: shading terminator, mirrors, near and far lights, sphere interior, furnace.

use super::fixtures::{
    DIRECT, integrator, lamp, path_traced, perfect_mirror, radiance_along, worse,
};
use super::shapes::Polyhedron;
use crate::accel::nearest_triangle;
use crate::geometry::{Sphere, Transform};
use crate::integrator::IntegratorSettings;
use crate::light::{Falloff, PointLight, Sky};
use crate::material::Material;
use crate::math::Ray;
use crate::sampling::Random;
use crate::scene::{SceneBuilder, SourceMesh};
use crate::simd::Kernel;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Eighty triangles with the normals of a sphere, lit from the side. The mesh is convex, so nothing casts a shadow: a
/// point is lit by its interpolated normal where the lamp is in front of its triangle, and dark where it is behind.
pub(super) fn terminator(kernel: Kernel) -> f64 {
    let ball = Polyhedron::icosphere(1);
    let smooth = SourceMesh {
        normals: ball
            .vertices
            .iter()
            .map(|vertex| vertex.as_vec3())
            .collect(),
        ..ball.mesh(0)
    };
    let position = DVec3::new(30.0, 8.0, 2.0);
    // Radiance 1 at normal incidence from 30 m.
    let intensity = PI * 900.0;
    let builder = SceneBuilder {
        materials: vec![Material::lambert(Vec3::ONE)],
        meshes: vec![smooth],
        lights: vec![lamp(position, intensity as f32)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let direct = integrator(&scene, &DIRECT);
    let triangles = ball.triangles();
    let mut worst: f64 = 0.0;
    for i in 0..100 * 100 {
        let film = DVec3::new(f64::from(i % 100) - 49.5, f64::from(i / 100) - 49.5, 0.0) / 45.0;
        let (eye, direction) = (DVec3::Z * 5.0, film - DVec3::Z * 5.0);
        let ray = Ray::new(eye.as_vec3(), direction.normalize().as_vec3());
        let nearest = nearest_triangle(&ray, &triangles);
        let Some((triangle, t, [u, v])) = nearest else {
            continue;
        };
        let [a, b, c] = ball.faces[triangle].map(|vertex| ball.vertices[vertex as usize]);
        let to_lamp = position - ray.at(t);
        let geometric_cos = (b - a).cross(c - a).normalize().dot(to_lamp.normalize());
        let normal = ((1.0 - u - v) * a + u * b + v * c).normalize();
        let shading_cos = normal.dot(to_lamp.normalize());
        if u.min(v).min(1.0 - u - v) < 1e-4 || geometric_cos.abs() < 1e-5 {
            continue;
        }
        let is_lit = geometric_cos > 0.0 && shading_cos > 0.0;
        let exact = if is_lit {
            shading_cos * intensity / (PI * to_lamp.length_squared())
        } else {
            0.0
        };
        let found = radiance_along(&direct, eye, direction).x;
        worst = worse(worst, (f64::from(found) - exact).abs());
    }
    worst
}

/// A ball of 0.1 m between perfect mirrors at x = -1 and x = 1. Its n-th image stands at 2 n + 0.3 (-1)^n
/// and is seen after |n| reflections: rays a ten-thousandth inside its outline see it; others have no bounces
/// left or leave the corridor, both with the radiance 1.
pub(super) fn mirror_corridor(kernel: Kernel) -> f64 {
    let wall = |x: f64| {
        Polyhedron::quad(
            DVec3::new(x, -50.0, -50.0),
            100.0 * DVec3::Y,
            100.0 * DVec3::Z,
        )
    };
    let ball = Sphere::new(DVec3::new(0.3, 0.0, -2.0), 0.1);
    let builder = SceneBuilder {
        ambient: Vec3::splat(1.0 / 0.3),
        sky: Sky::Uniform(Vec3::ONE),
        materials: vec![perfect_mirror(), Material::lambert(Vec3::splat(0.25))],
        meshes: vec![wall(-1.0).mesh(0), wall(1.0).mesh(0)],
        spheres: vec![(ball, 1)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let mut random = Random::new(12);
    let mut worst: f64 = 0.0;
    for n in -4..=4_i32 {
        let x = 2.0 * f64::from(n) + if n % 2 == 0 { 0.3 } else { -0.3 };
        let image = DVec3::new(x, 0.0, -2.0);
        for bounces in 0..=4 {
            let whitted = integrator(&scene, &IntegratorSettings::Whitted { bounces });
            for i in 0..200 {
                let sideways = image.cross(random.point()).normalize();
                let fraction = [0.9999, 1.0001][i % 2];
                // The tangent of the image's angular radius.
                let sine = 0.1 / image.length();
                let tangent = sine / (1.0 - sine * sine).sqrt();
                let direction = image.normalize() + fraction * tangent * sideways;
                let is_seen = fraction < 1.0 && n.unsigned_abs() <= bounces;
                let exact = if is_seen { 0.25 } else { 1.0 };
                let found = radiance_along(&whitted, DVec3::ZERO, direction);
                worst = worse(worst, (f64::from(found.x) - exact).abs());
            }
        }
    }
    worst
}

/// A perfect mirror close above a bright floor, both horizontal or rotated, seen at 89.99 and 89.9999 degrees from its
/// normal: it reflects all of the background, and no ray leaks to the floor.
pub(super) fn grazing_mirror(kernel: Kernel) -> f64 {
    let mut random = Random::new(13);
    let mut worst: f64 = 0.0;
    for angle in [0.0, 0.7] {
        let rotation = Transform::new(DVec3::ONE, DVec3::splat(angle), DVec3::ZERO);
        let square = |y: f64| {
            let corner = DVec3::new(-100.0, y, 100.0);
            let level = Polyhedron::quad(corner, 200.0 * DVec3::X, -200.0 * DVec3::Z);
            level.moved(|p| rotation.point(p))
        };
        let builder = SceneBuilder {
            ambient: Vec3::splat(3.0),
            sky: Sky::Uniform(Vec3::new(0.25, 0.5, 0.75)),
            materials: vec![perfect_mirror(), Material::lambert(Vec3::ONE)],
            meshes: vec![square(0.0).mesh(0), square(-1e-3).mesh(1)],
            kernel,
            ..SceneBuilder::default()
        };
        let (scene, _) = builder.build();
        let whitted = integrator(&scene, &IntegratorSettings::Whitted { bounces: 4 });
        for i in 0..10_000 {
            let slope = [0.01_f64, 0.0001][i % 2].to_radians().tan();
            // The ray hits the mirror 20 m away.
            let eye = rotation.point(20.0 * slope * DVec3::Y);
            let (sin, cos) = (2.0 * PI * f64::from(random.unit())).sin_cos();
            let direction = rotation.point(DVec3::new(cos, -slope, sin));
            let found = radiance_along(&whitted, eye, direction);
            let error = found.distance(Vec3::new(0.25, 0.5, 0.75));
            worst = worse(worst, error.into());
        }
    }
    worst
}

/// A lamp of intensity pi d^2 at a height of d m gives a floor of albedo 1/2 the radiance 1/2, and so does a lamp of
/// constant falloff. Where d^2 underflows in single precision, and at d = 0, light may be missing, but not infinite. A
/// lamp in the plane of the floor does not light it; one in the plane of the ceiling does.
pub(super) fn near_and_far(kernel: Kernel) -> f64 {
    let square =
        |y: f64| Polyhedron::quad(DVec3::new(-2.0, y, 2.0), 4.0 * DVec3::X, -4.0 * DVec3::Z);
    let lit = |position: DVec3, intensity: f64, falloff: Falloff, ceiling: Option<f64>| {
        let light = PointLight {
            falloff,
            ..PointLight::isotropic(Vec3::ZERO, Vec3::splat(intensity as f32))
        };
        let builder = SceneBuilder {
            materials: vec![Material::lambert(Vec3::splat(0.5))],
            meshes: [Some(0.0), ceiling]
                .into_iter()
                .flatten()
                .map(|y| square(y).mesh(0))
                .collect(),
            lights: vec![(position, light)],
            kernel,
            ..SceneBuilder::default()
        };
        let (scene, _) = builder.build();
        f64::from(radiance_along(&integrator(&scene, &DIRECT), DVec3::Y, DVec3::NEG_Y).x)
    };
    let mut worst: f64 = 0.0;
    for exponent in -40..=15 {
        let d = 10.0_f64.powi(exponent);
        let squared = lit(DVec3::Y * d, PI * d * d, Falloff::InverseSquare, None);
        let constant = lit(DVec3::Y * d, 1.0, Falloff::Constant, None);
        let error = |light: f64| (light / 0.5 - 1.0).abs();
        worst = worse(
            worst,
            if exponent >= -15 {
                error(squared).max(error(constant))
            } else if squared.is_finite() && constant.is_finite() {
                0.0
            } else {
                f64::INFINITY
            },
        );
    }
    let in_the_floor = lit(0.5 * DVec3::X, 1.0, Falloff::InverseSquare, None);
    let at_the_point = lit(DVec3::ZERO, 1.0, Falloff::InverseSquare, None);
    let in_the_ceiling = lit(2.0 * DVec3::Y, 4.0 * PI, Falloff::InverseSquare, Some(2.0));
    let limits = [in_the_floor, at_the_point, (in_the_ceiling - 0.5).abs()];
    limits.into_iter().fold(worst, worse)
}

/// In a sphere of radius 1 and albedo 1/2 with a lamp of intensity pi in its middle every point has the radiance 1/2
/// from direct light, and 2^-(k + 1) from the k-th bounce, on every path.
pub(super) fn sphere_interior(kernel: Kernel) -> f64 {
    let ball = Sphere::new(DVec3::new(5.0, -2.0, 7.0), 1.0);
    let builder = SceneBuilder {
        materials: vec![Material::lambert(Vec3::splat(0.5))],
        spheres: vec![(ball, 0)],
        lights: vec![lamp(ball.center, PI as f32)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let mut random = Random::new(14);
    let mut worst: f64 = 0.0;
    for bounces in [0, 1, 2, 3, 4, 20] {
        let exact = 1.0 - 0.5_f64.powi(bounces as i32 + 1);
        let path_tracer = integrator(&scene, &path_traced(bounces, [4, 2]));
        for _ in 0..100 {
            let eye = ball.center + 0.5 * random.point();
            let found = radiance_along(&path_tracer, eye, random.point());
            worst = worse(worst, (f64::from(found.x) - exact).abs());
        }
    }
    worst
}

/// White furnace: under a sky of radiance 1 a ball of albedo a has the radiance a, a mirror 1, and a blend of
/// both the weighted mean.
pub(super) fn furnace(kernel: Kernel) -> f64 {
    let mut random = Random::new(15);
    let mut worst: f64 = 0.0;
    for albedo in [0.0_f32, 0.3, 0.8, 1.0] {
        for reflectance in [0.0_f32, 0.5, 1.0] {
            let ball = Sphere::new(DVec3::ZERO, 1.0);
            let material = Material {
                reflective: Vec3::splat(reflectance),
                ..Material::lambert(Vec3::splat(albedo))
            };
            let builder = SceneBuilder {
                sky: Sky::Uniform(Vec3::ONE),
                materials: vec![material],
                spheres: vec![(ball, 0)],
                kernel,
                ..SceneBuilder::default()
            };
            let (scene, _) = builder.build();
            let exact = f64::from((1.0 - reflectance) * albedo + reflectance);
            let path_tracer = integrator(&scene, &path_traced(2, [4, 2]));
            for _ in 0..100 {
                let eye = 5.0 * random.point().normalize_or(DVec3::X);
                let found = radiance_along(&path_tracer, eye, 0.5 * random.point() - eye);
                worst = worse(worst, (f64::from(found.x) - exact).abs());
            }
        }
    }
    worst
}
