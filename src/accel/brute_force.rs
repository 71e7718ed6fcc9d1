//! Reference answers by brute force: every shape is tested, triangles in double precision by another method
//! than the tree's (Moeller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection").

use crate::geometry::{Hit, Sphere};
use crate::math::Ray;
use glam::Vec3;

/// Closer to an edge than this, as a barycentric weight, single precision may hit a triangle or miss it.
const MARGIN: f64 = 1e-4;

/// Distances within this relative difference count as equal, and the lowest number decides: 2^-28 and
/// rounding.
pub const DISTANCE_TOLERANCE: f64 = 4e-9;

/// Where a line meets the plane of a triangle, by Cramer's rule in double precision, and the weights of
/// its second and third vertex there.
fn intersect_triangle(ray: &Ray, vertices: [Vec3; 3]) -> Option<(f64, [f64; 2])> {
    let [a, b, c] = vertices.map(|p| p.as_dvec3());
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

/// How far a point is inside a triangle, as the least weight of a vertex; below 0 outside.
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
    let certain = triangles.iter().filter_map(|vertices| {
        let (t, weights) = intersect_triangle(ray, *vertices)?;
        (t > 0.0 && margin(weights) > MARGIN).then_some(t)
    });
    let of_spheres = spheres.iter().filter_map(|sphere| sphere.intersect(ray));
    let nearest = certain.chain(of_spheres).reduce(f64::min);
    let Some(hit) = hit else {
        return nearest.map(|t| format!("missed a hit at {t}: {ray:?}"));
    };
    let t = hit.t;
    if let Some(nearest) = nearest.filter(|nearest| t > nearest * (1.0 + DISTANCE_TOLERANCE)) {
        return Some(format!("{t} behind {nearest}: {ray:?}"));
    }
    let is_there = match triangles.get(hit.primitive as usize) {
        Some(vertices) => intersect_triangle(ray, *vertices).is_some_and(|(expected, weights)| {
            // Both are computed from coordinates, whose size counts where the distance is little.
            let coordinates = vertices
                .iter()
                .fold(ray.origin.abs(), |a, b| a.max(b.abs()));
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

/// The nearest triangle that a ray passes through, where, and the weights of its second and third vertex.
pub fn nearest_triangle(ray: &Ray, triangles: &[[Vec3; 3]]) -> Option<(usize, f64, [f64; 2])> {
    let met = triangles
        .iter()
        .enumerate()
        .filter_map(|(number, vertices)| {
            let (t, [u, v]) = intersect_triangle(ray, *vertices)?;
            (t > 0.0 && margin([u, v]) >= 0.0).then_some((number, t, [u, v]))
        });
    met.min_by(|a, b| a.1.total_cmp(&b.1))
}
