//! One emitter as a light: directions from a point to it, sampled by solid angle, and their pdf (Shirley, Wang and
//! Zimmerman 1996, "Monte Carlo Techniques for Direct Lighting Calculations"; triangles by Arvo 1995).

use crate::geometry::Sphere;
use crate::math::{Aabb, to_world};
use crate::sampling::{SphericalTriangle, uniform_cone, uniform_cone_pdf, uniform_sphere};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// What emits.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// A triangle, or a part of one.
    Triangle {
        vertices: [Vec3; 3],
        /// The unit normal of the side that emits, or of either.
        front: Vec3,
    },
    /// A sphere, or the ball of a point light.
    Sphere { center: DVec3, radius: f64 },
}

/// A direction towards an emitter, sampled from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Towards {
    /// Of unit length.
    pub(super) direction: Vec3,
    /// The distance to the emitter.
    pub(super) distance: f64,
    /// Over solid angle.
    pub(super) pdf: f32,
}

/// The square of the longest edge of a triangle, relative to that of the distance, below which it is sampled by area: the
/// solid angle of equal areas then differs by less than a half. Above, the solid angle is sampled, which takes more time.
const SMALL: f64 = 0.02;

impl Shape {
    /// Samples a direction from `origin` by two numbers in [0, 1); none where the shape turns no side to it.
    pub(super) fn sample(&self, origin: Vec3, [u, v]: [f32; 2]) -> Option<Towards> {
        match self {
            Shape::Triangle { vertices, .. } => {
                let corners = corners(vertices, origin);
                let direction = if is_small(corners) {
                    let [a, b, c] = corners;
                    let [s, t] = uniform_triangle(u.into(), v.into());
                    a + s * (b - a) + t * (c - a)
                } else {
                    SphericalTriangle::new(corners)?.sample(u, v)
                };
                // As the ray goes, whose direction is rounded.
                let direction = direction.normalize().as_vec3();
                let distance = plane_distance(corners, direction)?;
                let pdf = triangle_pdf(corners, distance, direction)?;
                Some(Towards {
                    direction,
                    distance,
                    pdf,
                })
            }
            Shape::Sphere { center, radius } => {
                let to_center = *center - origin.as_dvec3();
                let direction = match seen_cone(to_center, *radius) {
                    Some(one_minus_cos) => {
                        let axis = to_center.normalize().as_vec3();
                        to_world(axis, uniform_cone(u, v, one_minus_cos))
                    }
                    None => uniform_sphere(u, v),
                };
                Some(Towards {
                    direction,
                    distance: sphere_distance(to_center, *radius, direction.as_dvec3()),
                    pdf: sphere_pdf(to_center, *radius),
                })
            }
        }
    }

    /// The pdf, over solid angle, of a direction from `origin` that meets the shape at `distance`.
    pub(super) fn pdf(&self, origin: Vec3, direction: Vec3, distance: f64) -> f32 {
        match self {
            Shape::Triangle { vertices, .. } => {
                triangle_pdf(corners(vertices, origin), distance, direction).unwrap_or(0.0)
            }
            Shape::Sphere { center, radius } => sphere_pdf(*center - origin.as_dvec3(), *radius),
        }
    }

    /// The smallest box around it.
    pub(super) fn bounds(&self) -> Aabb {
        match self {
            Shape::Triangle { vertices, .. } => Aabb::of(*vertices),
            Shape::Sphere { center, radius } => Sphere::new(*center, *radius).bounds(),
        }
    }

    /// The area, in m².
    pub(super) fn area(&self) -> f64 {
        match self {
            Shape::Triangle { vertices, .. } => {
                let [a, b, c] = corners(vertices, Vec3::ZERO);
                0.5 * (b - a).cross(c - a).length()
            }
            Shape::Sphere { radius, .. } => 4.0 * std::f64::consts::PI * radius * radius,
        }
    }
}

/// The corners of a triangle as seen from a point.
fn corners(vertices: &[Vec3; 3], origin: Vec3) -> [DVec3; 3] {
    vertices.map(|vertex| vertex.as_dvec3() - origin.as_dvec3())
}

/// Barycentric coordinates uniform over a triangle (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
fn uniform_triangle(u: f64, v: f64) -> [f64; 2] {
    if u < v {
        [0.5 * u, v - 0.5 * u]
    } else {
        [u - 0.5 * v, 0.5 * v]
    }
}

fn is_small([a, b, c]: [DVec3; 3]) -> bool {
    let edges = [b - a, c - b, a - c].map(DVec3::length_squared);
    let longest = edges[0].max(edges[1]).max(edges[2]);
    longest < SMALL * (a + b + c).length_squared() / 9.0
}

/// How far a direction goes to the plane of the corners; none if it never gets there.
fn plane_distance([a, b, c]: [DVec3; 3], direction: Vec3) -> Option<f64> {
    let normal = (b - a).cross(c - a);
    let distance = normal.dot(a) / normal.dot(direction.as_dvec3());
    (distance > 0.0 && distance.is_finite()).then_some(distance)
}

fn triangle_pdf(corners: [DVec3; 3], distance: f64, direction: Vec3) -> Option<f32> {
    if !is_small(corners) {
        return Some((1.0 / SphericalTriangle::new(corners)?.solid_angle()) as f32);
    }
    let [a, b, c] = corners;
    // The area times the cosine.
    let projected = 0.5 * (b - a).cross(c - a).dot(direction.as_dvec3()).abs();
    let pdf = distance * distance / projected;
    (projected > 0.0).then_some(pdf as f32)
}

/// 1 less the cosine of the half angle of a sphere as seen from outside; none from inside.
fn seen_cone(to_center: DVec3, radius: f64) -> Option<f32> {
    let sin_squared = radius * radius / to_center.length_squared();
    (sin_squared < 1.0).then(|| (sin_squared / (1.0 + (1.0 - sin_squared).sqrt())) as f32)
}

fn sphere_pdf(to_center: DVec3, radius: f64) -> f32 {
    seen_cone(to_center, radius).map_or(0.25 / PI, uniform_cone_pdf)
}

/// The distance to a sphere along a unit direction; where that just misses, as it is rounded, to the closest point.
fn sphere_distance(to_center: DVec3, radius: f64, direction: DVec3) -> f64 {
    let along = to_center.dot(direction);
    let across = (to_center - along * direction).length_squared();
    let half_chord = (radius * radius - across).max(0.0).sqrt();
    if to_center.length_squared() > radius * radius {
        along - half_chord
    } else {
        along + half_chord
    }
}
