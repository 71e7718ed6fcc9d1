//! What all shapes, one after the other, say of a ray: triangles in another way and in double precision.

use crate::geometry::{Hit, Sphere};
use crate::math::Ray;
use glam::Vec3;

/// Within so much of an edge, as a barycentric weight, single precision may see a triangle or not.
const MARGIN: f64 = 1e-4;

/// Distances that differ by no more than this share count as the same, and a number decides: 2^-28 and what
/// rounding adds.
pub const SAME_DISTANCE: f64 = 4e-9;

/// Where a line meets the plane of a triangle, by Cramer's rule in double precision, and the weights of
/// its second and third corner there.
fn meet_triangle(ray: &Ray, corners: [Vec3; 3]) -> Option<(f64, [f64; 2])> {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let d = ray.direction.as_dvec3();
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = ray.origin.as_dvec3() - a;
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = d.dot(q) / det;
    Some((e2.dot(q) / det, [u, v]))
}

/// How far a point is inside a triangle, as the least weight of a corner; below 0 outside.
fn margin([u, v]: [f64; 2]) -> f64 {
    u.min(v).min(1.0 - u - v)
}

/// How a hit differs from what testing every shape in double precision gives; none if it agrees.
///
/// A triangle that is passed well inside its edges must be hit or be behind the hit; what was hit must
/// really be there.
pub fn disagreement(
    triangles: &[[Vec3; 3]],
    spheres: &[Sphere],
    ray: &Ray,
    hit: Option<Hit>,
) -> Option<String> {
    let certain = triangles.iter().filter_map(|corners| {
        let (t, weights) = meet_triangle(ray, *corners)?;
        (t > 0.0 && margin(weights) > MARGIN).then_some(t)
    });
    let of_spheres = spheres.iter().filter_map(|sphere| sphere.intersect(ray));
    let nearest = certain.chain(of_spheres).reduce(f64::min);
    let Some(hit) = hit else {
        return nearest.map(|t| format!("missed a hit at {t}: {ray:?}"));
    };
    let t = hit.t;
    if let Some(nearest) = nearest.filter(|nearest| t > nearest * (1.0 + SAME_DISTANCE)) {
        return Some(format!("{t} behind {nearest}: {ray:?}"));
    }
    let is_there = match triangles.get(hit.primitive as usize) {
        Some(corners) => meet_triangle(ray, *corners).is_some_and(|(expected, weights)| {
            // Both are worked out from coordinates, whose size counts where the distance is little.
            let coordinates = corners.iter().fold(ray.origin.abs(), |a, b| a.max(b.abs()));
            let size = coordinates.max_element() / ray.direction.length();
            let error = (t - expected).abs();
            margin(weights) > -MARGIN && error <= 1e-9 * expected + 1e-12 * f64::from(size)
        }),
        None => {
            let sphere = spheres[hit.primitive as usize - triangles.len()];
            sphere.intersect(ray) == Some(t)
        }
    };
    (!is_there).then(|| format!("nothing of {} at {t}: {ray:?}", hit.primitive))
}

/// The nearest triangle that a ray passes through, where, and the weights of its second and third corner.
pub fn nearest_triangle(ray: &Ray, triangles: &[[Vec3; 3]]) -> Option<(usize, f64, [f64; 2])> {
    let met = triangles
        .iter()
        .enumerate()
        .filter_map(|(number, corners)| {
            let (t, [u, v]) = meet_triangle(ray, *corners)?;
            (t > 0.0 && margin([u, v]) >= 0.0).then_some((number, t, [u, v]))
        });
    met.min_by(|a, b| a.1.total_cmp(&b.1))
}
