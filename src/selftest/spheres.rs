//! Sphere intersections against exact integer arithmetic.

use super::fixtures::{DIRECT, camera_at, lamp, renderer, worse};
use crate::accel::{Bvh, QueryState};
use crate::camera::Camera;
use crate::geometry::Sphere;
use crate::material::Material;
use crate::math::Ray;
use crate::render::RenderSettings;
use crate::sampling::Random;
use crate::scene::SceneBuilder;
use crate::simd::Kernel;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::PI;

/// A line with integer coordinates, relative to the centre of a sphere.
#[derive(Clone, Copy)]
struct IntegerLine {
    from: [i64; 3],
    direction: [i64; 3],
}

impl IntegerLine {
    /// Where the line intersects a sphere of integer radius, in lengths of its direction. Whether it does is exact;
    /// distances are rounded in their last steps only.
    fn intersect(&self, radius: i64) -> Option<[f64; 2]> {
        let dot = |u: [i64; 3], v: [i64; 3]| -> i128 {
            (0..3).map(|i| i128::from(u[i]) * i128::from(v[i])).sum()
        };
        let a = dot(self.direction, self.direction);
        let half_b = dot(self.from, self.direction);
        let c = dot(self.from, self.from) - i128::from(radius) * i128::from(radius);
        let discriminant = half_b * half_b - a * c;
        if discriminant < 0 {
            return None;
        }
        let root = (discriminant as f64).sqrt();
        let (a, half_b, c) = (a as f64, half_b as f64, c as f64);
        let q = -half_b - root.copysign(half_b);
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        Some([t0.min(t1), t0.max(t1)])
    }

    /// The nearest intersection in front of its start.
    fn first(&self, radius: i64) -> Option<f64> {
        self.intersect(radius)?.into_iter().find(|t| *t > 0.0)
    }

    /// The ray along the line, moved by the centre of the sphere, all scaled by `scale`.
    fn ray(&self, center: [i64; 3], scale: f64) -> Ray {
        let at = |i: usize| ((self.from[i] + center[i]) as f64 * scale) as f32;
        let direction = self.direction.map(|x| x as f32);
        Ray::new(Vec3::new(at(0), at(1), at(2)), Vec3::from_array(direction))
    }
}

fn point(integers: [i64; 3]) -> DVec3 {
    DVec3::from_array(integers.map(|x| x as f64))
}

/// Wrong hits and misses, and the largest error of a distance in radii, of rays to spheres: from inside, from the
/// surface itself, and from 1 to 1e6 radii away; of 4e-6 to 1e12 m; one sphere alone, and in a BVH with others.
fn against_exact(kernel: Kernel) -> (usize, f64) {
    let mut random = Random::new(1);
    let mut query_state = QueryState::default();
    let (mut wrong, mut worst) = (0, 0.0_f64);
    for ratio in [0, 1, 2, 10, 1000, 10_000, 1_000_000] {
        let radius = (4_000_000 / ratio.max(1)).min(700_000);
        let center = [0; 3].map(|_| random.whole(1_000_000));
        // Scaling by a power of two keeps integers exact.
        for exponent in [-20, -10, 0, 10, 20] {
            let scale = 2.0_f64.powi(exponent);
            let sphere = Sphere::new(point(center) * scale, radius as f64 * scale);
            let far = |i: i32| Sphere::new(DVec3::splat(1e8 * f64::from(i) * scale), sphere.radius);
            for spheres in [vec![sphere], vec![sphere, far(1), far(2), far(3)]] {
                let bvh = Bvh::new(&[], spheres, kernel);
                for _ in 0..4000 {
                    let mut integers = |size: i64| [0; 3].map(|_| random.whole(size));
                    let from = match ratio {
                        0 => integers(radius / 2),
                        // 2^2 + 3^2 + 6^2 = 7^2.
                        1 => [2, -3, 6].map(|part| radius / 7 * part),
                        _ => (point(integers(1000)).normalize_or(DVec3::X)
                            * (ratio * radius) as f64)
                            .to_array()
                            .map(|x| x as i64),
                    };
                    let target = integers(radius + radius / 4);
                    let direction = std::array::from_fn(|i| target[i] - from[i]);
                    if direction == [0; 3] {
                        continue;
                    }
                    let line = IntegerLine { from, direction };
                    let found = bvh.closest(&line.ray(center, scale), &mut query_state);
                    let found = found.map(|hit| hit.t / scale);
                    match (found, line.first(radius)) {
                        (Some(t), Some(exact)) => {
                            let error = (t - exact).abs() * point(direction).length();
                            worst = worse(worst, error / radius as f64);
                        }
                        (found, exact) => wrong += usize::from(found.is_some() != exact.is_some()),
                    }
                }
            }
        }
    }
    (wrong, worst)
}

pub(super) fn hits_and_misses(kernel: Kernel) -> f64 {
    against_exact(kernel).0 as f64
}

pub(super) fn distances(kernel: Kernel) -> f64 {
    against_exact(kernel).1
}

/// Rays whose line passes the centre at y = r (1 + k 2^-23), k from -4 to 4. Where k <= 0 they hit the sphere, half a
/// chord of sqrt(r^2 - y^2) before the middle of the chord.
pub(super) fn tangents(kernel: Kernel) -> f64 {
    let mut query_state = QueryState::default();
    let mut worst: f64 = 0.0;
    for exponent in -20..=20 {
        let radius = 2.0_f32.powi(exponent);
        let bvh = Bvh::new(&[], vec![Sphere::new(DVec3::ZERO, radius.into())], kernel);
        for ulps in -4..=4_i32 {
            let y = radius * (1.0 + ulps as f32 * f32::EPSILON);
            for away in [2.0, 1e3, 1e6] {
                let start = Vec3::new(-away * radius, y, 0.0);
                let hit = bvh.closest(&Ray::new(start, Vec3::X), &mut query_state);
                let (exact_radius, y) = (f64::from(radius), f64::from(y));
                let squared = (exact_radius - y) * (exact_radius + y);
                worst = worse(
                    worst,
                    match hit {
                        _ if squared < 0.0 => f64::from(u8::from(hit.is_some())),
                        // At 0, the tangent itself, both a hit and a miss are right.
                        None => f64::from(u8::from(squared > 0.0)),
                        Some(hit) => {
                            let exact = f64::from(away) * exact_radius - squared.sqrt();
                            ((hit.t - exact) / exact_radius).abs()
                        }
                    },
                );
            }
        }
    }
    worst
}

/// The outer one of two spheres of 10,000 and 10,001 m comes first from outside, the inner one from
/// inside, whatever their order in the scene.
pub(super) fn concentric(kernel: Kernel) -> f64 {
    const RADII: [i64; 2] = [10_000, 10_001];
    let mut random = Random::new(2);
    let mut query_state = QueryState::default();
    let mut wrong = 0;
    for outer in [0, 1] {
        let radii = [RADII[1 - outer], RADII[outer]];
        let spheres = radii.map(|radius| Sphere::new(DVec3::ZERO, radius as f64));
        let bvh = Bvh::new(&[], spheres.to_vec(), kernel);
        for i in 0..20_000 {
            let mut integers = |size: i64| [0; 3].map(|_| random.whole(size));
            let from = if i % 2 == 0 {
                let outward = point(integers(1000)).normalize_or(DVec3::X);
                (outward * 1e7).to_array().map(|x| x as i64)
            } else {
                integers(5000)
            };
            let target = integers(11_000);
            let direction = std::array::from_fn(|i| target[i] - from[i]);
            if direction == [0; 3] {
                continue;
            }
            let line = IntegerLine { from, direction };
            let exact = [line.first(radii[0]), line.first(radii[1])];
            let expected = match exact {
                [Some(t0), Some(t1)] => Some(u32::from(t1 < t0)),
                [Some(_), None] => Some(0),
                [None, Some(_)] => Some(1),
                [None, None] => None,
            };
            let found = bvh.closest(&line.ray([0; 3], 1.0), &mut query_state);
            wrong += usize::from(found.map(|hit| hit.primitive) != expected);
        }
    }
    wrong as f64
}

/// A ball of 1 m on a sphere of 1e6 m, and a lamp. Computed from the height h above the ground, without cancellation:
/// c = h (2 r + h).
struct Ground {
    radius: f64,
    lamp: DVec3,
    ball: DVec3,
}

impl Ground {
    /// The height of a point above the ground, which touches the origin from below.
    fn height(&self, p: DVec3) -> f64 {
        let from_center = p.y + self.radius;
        let across = p.x * p.x + p.z * p.z;
        // sqrt(from_center^2 + across) - radius, without their difference.
        p.y + across / ((from_center * from_center + across).sqrt() + from_center)
    }

    /// Where a ray from a low point hits the ground, and the discriminant relative to the squared distance of the
    /// horizon: 0 at the horizon.
    fn hit_ground(&self, from: DVec3, direction: DVec3) -> (Option<f64>, f64) {
        let h = self.height(from);
        let b = DVec3::new(from.x, from.y + self.radius, from.z).dot(direction);
        let c = h * (2.0 * self.radius + h);
        let discriminant = b * b - c;
        let t = (b < 0.0 && discriminant >= 0.0).then(|| c / (-b + discriminant.sqrt()));
        (t, discriminant / c)
    }

    /// Where a ray hits the ball, and 1 - d^2, where d is the distance of the ray's line from the centre: 0 at the
    /// outline.
    fn hit_ball(&self, from: DVec3, direction: DVec3) -> (Option<f64>, f64) {
        let to_ball = self.ball - from;
        let along = to_ball.dot(direction);
        let margin = 1.0 - (to_ball - along * direction).length_squared();
        let t = along - margin.max(0.0).sqrt();
        ((margin > 0.0 && t > 0.0).then_some(t), margin)
    }

    /// The radiance of a point with a normal: albedo 1/2 under a lamp of intensity 2 pi^2.
    fn light(&self, p: DVec3, normal: DVec3) -> f64 {
        let to_lamp = self.lamp - p;
        PI * to_lamp.normalize().dot(normal).max(0.0) / to_lamp.length_squared()
    }

    /// The radiance along a ray; none where it passes within rounding of an edge.
    fn radiance(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let (ground, horizon) = self.hit_ground(from, direction);
        let (ball, margin) = self.hit_ball(from, direction);
        if horizon.abs() < 1e-5 || margin.abs() < 1e-5 {
            return None;
        }
        if let Some(t) = ball {
            let p = from + t * direction;
            let is_at_terminator = (self.lamp - p).normalize().dot(p - self.ball).abs() < 1e-5;
            return (!is_at_terminator).then(|| self.light(p, p - self.ball));
        }
        let Some(t) = ground else { return Some(0.0) };
        let p = from + t * direction;
        let normal = (p + DVec3::Y * self.radius).normalize();
        let (shadow, margin) = self.hit_ball(p, (self.lamp - p).normalize());
        match shadow {
            _ if margin.abs() < 1e-5 => None,
            Some(_) => Some(0.0),
            None => Some(self.light(p, normal)),
        }
    }
}

/// Two views of a ground of 1e6 m from 1 m above: the ball and its shadow, and the horizon with a field of view of 1
/// degree, 1.4 mrad below eye level.
pub(super) fn ground(kernel: Kernel) -> f64 {
    let ground = Ground {
        radius: 1e6,
        lamp: DVec3::new(3.0, 5.0, -2.0),
        ball: DVec3::new(0.2, 1.0, -5.0),
    };
    let builder = SceneBuilder {
        materials: vec![Material::lambert(Vec3::splat(0.5))],
        spheres: vec![
            (Sphere::new(DVec3::NEG_Y * ground.radius, ground.radius), 0),
            (Sphere::new(ground.ball, 1.0), 0),
        ],
        lights: vec![lamp(ground.lamp, (2.0 * PI * PI) as f32)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let renderer = renderer(&scene, &RenderSettings::new(DIRECT, 160, 90));
    let eye = DVec3::Y;
    let cameras: [Camera; 2] = [
        camera_at(eye, DVec3::new(0.3, 0.2, -4.0), 70.0),
        camera_at(eye, DVec3::new(-6.0, 1.0, -10.0), 1.0),
    ];
    let size = DVec2::new(160.0, 90.0);
    let mut worst: f64 = 0.0;
    for camera in cameras {
        let film = renderer.render_frame(&camera, 0).film;
        let rays = camera.rays(size, DVec3::ZERO);
        for (i, pixel) in film.pixels().iter().enumerate() {
            let middle = DVec2::new((i % 160) as f64, (i / 160) as f64) + 0.5;
            let direction = rays.through(middle).direction.as_dvec3().normalize();
            let Some(exact) = ground.radiance(eye, direction) else {
                continue;
            };
            let error = (f64::from(pixel.x) - exact).abs();
            // Relative to the exact radiance, or to a thousandth of the brightest where it is darker.
            worst = worse(worst, error / exact.max(1e-3 * PI / 25.0));
        }
    }
    worst
}
