//! The two ray queries, closest hit and any hit, and which intersections each accepts.
//!
//! Code that serves both is generic over `ANY_HIT`, so that it is written once and costs neither query
//! anything.

use crate::geometry::Hit;
use crate::math::Ray;

/// Enlarges a distance that was rounded to single precision beyond its rounding, so that culling with it is
/// conservative.
pub(super) const DISTANCE_PADDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Offers a hit at parameter `t` to the query; returns whether the query is finished.
#[inline(always)]
pub(super) fn accept_hit<const ANY_HIT: bool>(
    ray: &Ray,
    t: f64,
    primitive: u32,
    best: &mut Hit,
) -> bool {
    if !ANY_HIT {
        update_closest(ray, t, primitive, best);
        return false;
    }
    let occludes = occludes(ray, t, primitive);
    if occludes {
        *best = Hit { t, primitive };
    }
    occludes
}

/// Takes over a primitive that the ray meets at `t` if it is nearer than `best`; at the same distance, to
/// a relative 2^-28, if its number is lower.
#[inline(always)]
fn update_closest(ray: &Ray, t: f64, primitive: u32, best: &mut Hit) {
    // The bits of positive numbers order like the numbers. Rounding moves the distances of two coplanar
    // triangles, but rarely beyond the bits that are kept here.
    let (rounded, best_rounded) = (t.to_bits() >> 24, best.t.to_bits() >> 24);
    let is_before =
        rounded < best_rounded || (rounded == best_rounded && primitive < best.primitive);
    if t > 0.0 && primitive != ray.exclude && is_before {
        *best = Hit { t, primitive };
    }
}

/// Whether a primitive that the ray meets at `t` lies in the ray's interval.
#[inline(always)]
fn occludes(ray: &Ray, t: f64, primitive: u32) -> bool {
    t > 0.0 && t < f64::from(ray.t_max) && primitive != ray.exclude
}
