//! How far rounding may move what rays and shapes are said to be.
//!
//! It is in proportion to the coordinates of the ray's start and of the shape itself: what else there is in
//! a scene, be it ever so large, does not count.

use crate::math::{Aabb, Ray};

/// Boxes are grown by this share of the largest coordinates that ray and box have: more than triangles
/// are ([`TRIANGLE_GROWTH`]), by at least twice the rounding of the box test itself (three operations for
/// each plane, after Ize 2013, "Robust BVH Ray Traversal", JCGT 2(2)).
///
/// A tree's boxes are kept [`grown`] by their own part, the ray's part is added when they are tested.
pub(super) const GROWTH: f32 = 16.0 * f32::EPSILON;

/// How far beside a triangle a ray may pass that hits it, as a share of the largest coordinates that
/// both have. Rounding may move a corner, as the ray sees it, by 3 epsilon, and an edge by as much as 2
/// more. The edges of slivers, seen from afar, may move much farther, but that closes no gap: it is no hit.
const TRIANGLE_GROWTH: f64 = 8.0 * f32::EPSILON as f64;

/// [`TRIANGLE_GROWTH`] of some of the coordinates.
#[inline(always)]
pub(super) fn triangle_growth(reach: f64) -> f64 {
    TRIANGLE_GROWTH * reach
}

/// The largest coordinate of a ray's start.
#[inline(always)]
pub(super) fn reach(ray: &Ray) -> f32 {
    ray.origin.abs().max_element()
}

/// A box, grown in proportion to its own coordinates; the empty one stays empty.
pub(super) fn grown(bounds: Aabb) -> Aabb {
    if bounds == Aabb::EMPTY {
        return bounds;
    }
    let growth = GROWTH * bounds.min.abs().max(bounds.max.abs()).max_element();
    Aabb {
        min: bounds.min - growth,
        max: bounds.max + growth,
    }
}
