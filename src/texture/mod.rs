//! Image textures: sRGB texels, filtered in linear RGB: bilinearly where a sample stands for a point, else over its
//! footprint, from a mip map.

mod bilinear;
mod filter;
mod mip_map;

use crate::math::color::srgb_to_linear;
use bilinear::{Place, bilinear};
use glam::{DVec3, Vec2, Vec3, Vec4};
use mip_map::MipMap;
use std::sync::LazyLock;

static LINEAR_OF_CODE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0)));

/// A colour image of 8-bit sRGB texels that repeats over the plane.
#[derive(Clone, Debug)]
pub struct Texture {
    width: usize,
    height: usize,
    texels: Vec<[u8; 3]>,
    mip_map: MipMap,
}

impl Texture {
    /// A texture of `texels`: rows from the top of the image, each from the left. None if their number is 0 or not
    /// `width * height`.
    pub fn new(width: usize, height: usize, texels: Vec<[u8; 3]>) -> Option<Texture> {
        let is_whole = !texels.is_empty() && Some(texels.len()) == width.checked_mul(height);
        is_whole.then(|| Texture {
            width,
            height,
            mip_map: MipMap::new(width, height, |index| {
                linear(&LINEAR_OF_CODE, texels[index])
            }),
            texels,
        })
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The memory that the texels and the mip map take, in bytes.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.texels) + self.mip_map.memory()
    }

    /// The linear colour at `uv`: (0, 0) is the lower left corner of the image, (1, 1) the upper right one, and it
    /// repeats beyond. Texel centres lie at half-integers; between them the decoded colours are interpolated
    /// bilinearly. A coordinate that is not finite counts as 0.
    #[inline(always)]
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        self.at(Place::of(uv)).truncate()
    }

    /// [`Texture::sample`] at a place.
    #[inline(always)]
    fn at(&self, place: Place) -> Vec4 {
        let size = (self.width, self.height);
        let table = &*LINEAR_OF_CODE;
        bilinear(size, place, |index| linear(table, self.texels[index]))
    }

    /// The mean of its linear colours.
    pub fn mean(&self) -> DVec3 {
        let texels = self.texels.iter();
        let colors = texels.map(|texel| linear(&LINEAR_OF_CODE, *texel));
        let sum: DVec3 = colors.map(|color| color.truncate().as_dvec3()).sum();
        sum / self.texels.len() as f64
    }
}

/// The linear colour of a texel, from [`LINEAR_OF_CODE`].
#[inline(always)]
fn linear(table: &[f32; 256], texel: [u8; 3]) -> Vec4 {
    let [red, green, blue] = texel.map(|code| table[code as usize]);
    Vec4::new(red, green, blue, 0.0)
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
