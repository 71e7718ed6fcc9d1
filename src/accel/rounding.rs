//! How far rounding may move what rays and shapes are said to be.

use crate::math::Ray;

/// Boxes are grown by this share of the largest coordinates that rays and boxes have: more than
/// triangles are ([`TRIANGLE_GROWTH`]), by at least twice the rounding of the box test itself (three
/// operations for each plane, after Ize 2013, "Robust BVH Ray Traversal", JCGT 2(2)).
pub(super) const GROWTH: f32 = 16.0 * f32::EPSILON;

/// How far beside a triangle a ray may pass that hits it, as a share of the largest coordinates that
/// rays and triangles have. Rounding may move a corner, as the ray sees it, by 3 epsilon, and an edge
/// by as much as 2 more. The edges of slivers, seen from afar, may move much farther, but that closes
/// no gap: it is no hit.
const TRIANGLE_GROWTH: f32 = 8.0 * f32::EPSILON;

/// [`TRIANGLE_GROWTH`] of the largest coordinates.
#[inline(always)]
pub(super) fn triangle_growth(reach: f32) -> f64 {
    f64::from(TRIANGLE_GROWTH) * f64::from(reach)
}

/// The largest coordinates of a ray, added to those of the scene.
#[inline(always)]
pub(super) fn reach(ray: &Ray, magnitude: f32) -> f32 {
    magnitude + ray.origin.abs().max_element()
}
