//! Image textures: sRGB texels, filtered bilinearly in linear RGB.

use crate::math::color::srgb_to_linear;
use glam::{DVec3, Vec2, Vec3};
use std::sync::LazyLock;

static LINEAR_OF_CODE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0)));

/// A colour image of 8-bit sRGB texels that repeats over the plane.
#[derive(Clone, Debug)]
pub struct Texture {
    width: usize,
    height: usize,
    texels: Vec<[u8; 3]>,
}

impl Texture {
    /// A texture of `texels`: rows from the top of the image, each from the left. None if their number is 0 or not
    /// `width * height`.
    pub fn new(width: usize, height: usize, texels: Vec<[u8; 3]>) -> Option<Texture> {
        (!texels.is_empty() && Some(texels.len()) == width.checked_mul(height)).then_some(Texture {
            width,
            height,
            texels,
        })
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The memory that the texels take, in bytes.
    pub fn memory(&self) -> usize {
        self.texels.len() * size_of::<[u8; 3]>()
    }

    /// The linear colour at `uv`: (0, 0) is the lower left corner of the image, (1, 1) the upper right one, and it
    /// repeats beyond. Texel centres lie at half-integers; between them the decoded colours are interpolated
    /// bilinearly. A coordinate that is not finite counts as 0.
    #[inline(always)]
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        let (x0, x1, fx) = neighbours(uv.x, self.width);
        let (y0, y1, fy) = neighbours(-uv.y, self.height);
        let table = &*LINEAR_OF_CODE;
        let texel = |x: usize, y: usize| {
            let [r, g, b] = self.texels[y * self.width + x];
            Vec3::new(table[r as usize], table[g as usize], table[b as usize])
        };
        let top = texel(x0, y0).lerp(texel(x1, y0), fx);
        let bottom = texel(x0, y1).lerp(texel(x1, y1), fx);
        top.lerp(bottom, fy)
    }

    /// The mean of its linear colours.
    pub fn mean(&self) -> DVec3 {
        let colors = self
            .texels
            .iter()
            .map(|texel| texel.map(|code| LINEAR_OF_CODE[code as usize]));
        let sum: DVec3 = colors.map(|color| Vec3::from_array(color).as_dvec3()).sum();
        sum / self.texels.len() as f64
    }
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
    // Wrapping first keeps all of the fraction's bits for far tiles.
    let wrapped = u - floor(u);
    let wrapped = if wrapped.is_finite() { wrapped } else { 0.0 };
    // In 0.5..=count + 0.5, so that truncation is floor. `after` may be `count`, which wraps to 0.
    let position = wrapped * count as f32 + 0.5;
    let after = position as usize;
    let second = if after >= count { after - count } else { after };
    let first = if after == 0 { count - 1 } else { after - 1 };
    (first, second, position - after as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarters() -> Texture {
        // Top row: red, green. Bottom row: blue, white.
        let texels = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        Texture::new(2, 2, texels).expect("four texels")
    }

    #[test]
    fn lower_left_corner_is_the_origin_and_centres_are_exact() {
        let t = quarters();
        assert_eq!(t.sample(Vec2::new(0.25, 0.25)), Vec3::Z);
        assert_eq!(t.sample(Vec2::new(0.75, 0.25)), Vec3::ONE);
        assert_eq!(t.sample(Vec2::new(0.25, 0.75)), Vec3::X);
        assert_eq!(t.sample(Vec2::new(0.75, 0.75)), Vec3::Y);
    }

    #[test]
    fn repeats_with_negative_and_far_coordinates_and_across_the_seam() {
        let t = quarters();
        for tile in [-3.0, -1.0, 1.0, 1024.0] {
            let moved = Vec2::new(0.25 + tile, 0.75 - tile);
            assert_eq!(t.sample(moved), Vec3::X, "{tile}");
        }
        // Halfway over the seam: left and right columns in equal parts.
        let seam = t.sample(Vec2::new(0.0, 0.75));
        assert!((seam - Vec3::new(0.5, 0.5, 0.0)).length() < 1e-6);
        assert_eq!(seam, t.sample(Vec2::new(1.0, 0.75)));
        assert!(t.sample(Vec2::new(f32::NAN, f32::INFINITY)).is_finite());
    }
}
