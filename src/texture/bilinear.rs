//! Bilinear interpolation of texels that repeat over the plane.

use glam::{Vec2, Vec3};

/// The colour at `uv`, interpolated between the centres of four of `size` texels; `texel` gives each by its index. A
/// coordinate that is not finite counts as 0.
#[inline(always)]
pub(super) fn bilinear(
    (width, height): (usize, usize),
    uv: Vec2,
    texel: impl Fn(usize) -> Vec3,
) -> Vec3 {
    let (x0, x1, fx) = neighbours(uv.x, width);
    let (y0, y1, fy) = neighbours(-uv.y, height);
    let top = texel(y0 * width + x0).lerp(texel(y0 * width + x1), fx);
    let bottom = texel(y1 * width + x0).lerp(texel(y1 * width + x1), fx);
    top.lerp(bottom, fy)
}

/// The part of a coordinate that counts: its distance from the integer below. 0 if it is not finite.
#[inline(always)]
pub(super) fn wrapped(u: f32) -> f32 {
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

/// The two texels around coordinate `u` in a row of `count`, and the weight of the second.
#[inline(always)]
fn neighbours(u: f32, count: usize) -> (usize, usize, f32) {
    // Wrapping first keeps all of the fraction's bits for far tiles. The position is in 0.5..=count + 0.5, so that
    // truncation is floor. `after` may be `count`, which wraps to 0.
    let position = wrapped(u) * count as f32 + 0.5;
    let after = position as usize;
    let second = if after >= count { after - count } else { after };
    let first = if after == 0 { count - 1 } else { after - 1 };
    (first, second, position - after as f32)
}
