//! Bilinear interpolation of texels that repeat over the plane.

use glam::{Vec2, Vec4};

/// Where a lookup is: the distances from the upper left corner of the tile that it lies in, in tiles.
#[derive(Clone, Copy)]
pub(super) struct Place(Vec2);

impl Place {
    /// Of texture coordinates. One that is not finite counts as 0.
    #[inline(always)]
    pub(super) fn of(uv: Vec2) -> Place {
        // Wrapping first keeps all of the fraction's bits for far tiles.
        Place(Vec2::new(wrapped(uv.x), wrapped(-uv.y)))
    }

    /// Elsewhere by a change of texture coordinates.
    #[inline(always)]
    pub(super) fn moved(self, change: Vec2) -> Place {
        Place(Vec2::new(
            wrapped(self.0.x + change.x),
            wrapped(self.0.y - change.y),
        ))
    }
}

/// The colour at a place, interpolated between the centres of four of `size` texels; `texel` gives each by its index.
///
/// Colours are vectors of four lanes, the last unused, for the sake of the processor's own.
#[inline(always)]
pub(super) fn bilinear(
    (width, height): (usize, usize),
    Place(place): Place,
    texel: impl Fn(usize) -> Vec4,
) -> Vec4 {
    let (x0, x1, fx) = neighbours(place.x, width);
    let (y0, y1, fy) = neighbours(place.y, height);
    let top = texel(y0 * width + x0).lerp(texel(y0 * width + x1), fx);
    let bottom = texel(y1 * width + x0).lerp(texel(y1 * width + x1), fx);
    top.lerp(bottom, fy)
}

/// The part of a coordinate that counts: its distance from the integer below. 0 if it is not finite.
#[inline(always)]
fn wrapped(u: f32) -> f32 {
    let wrapped = u - floor(u);
    if wrapped.is_finite() { wrapped } else { 0.0 }
}

/// The largest integer not above `x`. Every float beyond 2^31 is an integer.
#[inline(always)]
fn floor(x: f32) -> f32 {
    let truncated = x as i32 as f32;
    if x.abs() >= 2_147_483_648.0 {
        x
    } else if truncated > x {
        truncated - 1.0
    } else {
        truncated
    }
}

/// The two texels around a distance, in 0..=1, in a row of `count`, and the weight of the second.
#[inline(always)]
fn neighbours(distance: f32, count: usize) -> (usize, usize, f32) {
    // The position is in 0.5..=count + 0.5, so that truncation is floor. `after` may be `count`, which wraps to 0.
    let position = distance * count as f32 + 0.5;
    let after = position as usize;
    let second = if after >= count { after - count } else { after };
    let first = if after == 0 { count - 1 } else { after - 1 };
    (first, second, position - after as f32)
}
