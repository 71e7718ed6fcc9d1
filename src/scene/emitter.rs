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
    Triangle(Triangle),
    /// A sphere, or the ball of a point light.
    Sphere { center: DVec3, radius: f64 },
}

/// A triangle that emits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    vertices: [Vec3; 3],
    /// The unit normal of the side that emits, or of either.
    pub(super) front: Vec3,
    /// The normal of its winding, as long as twice the area.
    cross: DVec3,
    /// The square of the longest edge.
    longest_squared: f64,
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

/// The square of the longest edge of a triangle, relative to that of the distance, below which it is sampled by area. The
/// solid angle, which has less variance where it is large, takes many times the time.
const SMALL: f64 = 0.3;

impl Shape {
    /// Samples a direction from `origin` by two numbers in [0, 1); none where the shape turns no side to it.
    pub(super) fn sample(&self, origin: Vec3, [u, v]: [f32; 2]) -> Option<Towards> {
        match self {
            Shape::Triangle(triangle) => triangle.sample(origin, [u, v]),
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
            Shape::Triangle(triangle) => triangle.pdf(origin, direction, distance),
            Shape::Sphere { center, radius } => sphere_pdf(*center - origin.as_dvec3(), *radius),
        }
    }

    /// The smallest box around it.
    pub(super) fn bounds(&self) -> Aabb {
        match self {
            Shape::Triangle(triangle) => Aabb::of(triangle.vertices),
            Shape::Sphere { center, radius } => Sphere::new(*center, *radius).bounds(),
        }
    }

    /// The area, in m².
    pub(super) fn area(&self) -> f64 {
        match self {
            Shape::Triangle(triangle) => 0.5 * triangle.cross.length(),
            Shape::Sphere { radius, .. } => 4.0 * std::f64::consts::PI * radius * radius,
        }
    }
}

impl Triangle {
    pub(super) fn new(vertices: [Vec3; 3], front: Vec3) -> Triangle {
        let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
        let edges = [b - a, c - b, a - c].map(DVec3::length_squared);
        Triangle {
            vertices,
            front,
            cross: (b - a).cross(c - a),
            longest_squared: edges[0].max(edges[1]).max(edges[2]),
        }
    }

    /// See [`Shape::sample`].
    fn sample(&self, origin: Vec3, [u, v]: [f32; 2]) -> Option<Towards> {
        let corners = self.corners(origin);
        let (direction, pdf) = if self.is_small(corners) {
            let [a, b, c] = corners;
            let [s, t] = uniform_triangle(u.into(), v.into());
            ((a + s * (b - a) + t * (c - a)).normalize(), None)
        } else {
            let triangle = SphericalTriangle::new(corners)?;
            let pdf = (1.0 / triangle.solid_angle()) as f32;
            (triangle.sample(u, v), Some(pdf))
        };
        // As the ray goes, whose direction is rounded.
        let direction = direction.as_vec3();
        let distance = corners[0].dot(self.cross) / direction.as_dvec3().dot(self.cross);
        let towards = Towards {
            direction,
            distance,
            pdf: pdf.unwrap_or_else(|| self.area_pdf(direction, distance)),
        };
        (distance > 0.0 && distance.is_finite() && towards.pdf > 0.0).then_some(towards)
    }

    /// See [`Shape::pdf`].
    fn pdf(&self, origin: Vec3, direction: Vec3, distance: f64) -> f32 {
        let corners = self.corners(origin);
        if !self.is_small(corners) {
            let triangle = SphericalTriangle::new(corners);
            return triangle.map_or(0.0, |triangle| (1.0 / triangle.solid_angle()) as f32);
        }
        self.area_pdf(direction, distance)
    }

    /// The pdf, over solid angle, where it is sampled by area.
    fn area_pdf(&self, direction: Vec3, distance: f64) -> f32 {
        // The area times the cosine.
        let projected = 0.5 * self.cross.dot(direction.as_dvec3()).abs();
        if projected > 0.0 {
            (distance * distance / projected) as f32
        } else {
            0.0
        }
    }

    /// Whether it is sampled by area.
    fn is_small(&self, [a, b, c]: [DVec3; 3]) -> bool {
        self.longest_squared < SMALL / 9.0 * (a + b + c).length_squared()
    }

    /// The corners as seen from a point.
    fn corners(&self, origin: Vec3) -> [DVec3; 3] {
        self.vertices
            .map(|vertex| vertex.as_dvec3() - origin.as_dvec3())
    }
}

/// Barycentric coordinates uniform over a triangle (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
fn uniform_triangle(u: f64, v: f64) -> [f64; 2] {
    if u < v {
        [0.5 * u, v - 0.5 * u]
    } else {
        [u - 0.5 * v, 0.5 * v]
    }
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
