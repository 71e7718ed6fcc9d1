//! Bounds of the rounding errors of box and triangle tests (Ize 2013, "Robust BVH Ray Traversal", JCGT 2(2)).
//!
//! They are relative to the coordinates of the ray's origin and of the shape itself: the size of the rest of
//! the scene does not count.

use crate::math::Aabb;

/// Boxes are padded by this, relative to the largest coordinates of ray and box: more than triangles are
/// ([`TRIANGLE_PADDING`]), by at least twice the rounding of the box test itself (three operations for each
/// plane).
///
/// The boxes of a tree are kept [`padded`] by their own part; the ray's part is added when they are tested.
pub(super) const BOX_PADDING: f32 = 16.0 * f32::EPSILON;

/// How far beside a triangle a ray may pass that hits it, relative to the largest coordinates of both.
///
/// Rounding may move a vertex, in the ray's space, by 3 epsilon, and an edge by as much as 2 more. The edges
/// of distant slivers may move much farther, but that opens no gap: it is a miss.
pub(super) const TRIANGLE_PADDING: f64 = 8.0 * f32::EPSILON as f64;

/// A box, padded relative to its own coordinates; the empty one stays empty.
pub(super) fn padded(bounds: Aabb) -> Aabb {
    if bounds == Aabb::EMPTY {
        return bounds;
    }
    let padding = BOX_PADDING * bounds.min.abs().max(bounds.max.abs()).max_element();
    Aabb {
        min: bounds.min - padding,
        max: bounds.max + padding,
    }
}
