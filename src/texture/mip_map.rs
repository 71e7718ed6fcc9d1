//! Mip maps (Williams 1983, "Pyramidal Parametrics"): an image at a half, a quarter and so on of its size, down to its
//! mean.

use super::bilinear::{Place, bilinear};
use glam::Vec4;

/// The levels of an image above the image itself, which is level 0.
///
/// Single precision keeps a constant image constant and the mean of every level that of the image, however dark; the
/// levels take 5.3 bytes for each texel of the image.
#[derive(Clone, Debug)]
pub(super) struct MipMap {
    levels: Vec<Level>,
}

/// An image of linear colours.
#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    texels: Vec<Vec4>,
}

impl MipMap {
    /// Of an image of `width * height` linear colours, at least one; `texel` gives each by its index.
    pub(super) fn new(width: usize, height: usize, texel: impl Fn(usize) -> Vec4) -> MipMap {
        let mut levels = Vec::new();
        if width * height > 1 {
            levels.push(Level::halved(width, height, texel));
        }
        while let Some(last) = levels.last().filter(|last| last.texels.len() > 1) {
            let texel = |index| last.texels[index];
            levels.push(Level::halved(last.width, last.height, texel));
        }
        MipMap { levels }
    }

    /// The memory that the texels take, in bytes.
    pub(super) fn memory(&self) -> usize {
        self.levels.iter().map(|l| size_of_val(&*l.texels)).sum()
    }

    /// The number of the last level, which has one texel.
    pub(super) fn last(&self) -> usize {
        self.levels.len()
    }

    /// The colour of a level but level 0 at a place, interpolated bilinearly.
    #[inline(always)]
    pub(super) fn sample(&self, level: usize, place: Place) -> Vec4 {
        let level = &self.levels[level - 1];
        bilinear((level.width, level.height), place, |i| level.texels[i])
    }
}

impl Level {
    /// An image at half its size, rounded up. Each texel is the mean of the area that it covers, so that the mean of
    /// the image stays.
    fn halved(width: usize, height: usize, texel: impl Fn(usize) -> Vec4) -> Level {
        let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
        let mut texels = vec![Vec4::ZERO; half_width * half_height];
        for (y, row) in texels.chunks_exact_mut(half_width).enumerate() {
            for (source_y, weight_y) in covered(y, half_height, height) {
                for (x, sum) in row.iter_mut().enumerate() {
                    for (source_x, weight_x) in covered(x, half_width, width) {
                        *sum += weight_x * weight_y * texel(source_y * width + source_x);
                    }
                }
            }
        }
        Level {
            width: half_width,
            height: half_height,
            texels,
        }
    }
}

/// The texels of a row of `sources` that texel `index` of the same row with `count` texels covers, and the fraction
/// that each is of it.
fn covered(index: usize, count: usize, sources: usize) -> impl Iterator<Item = (usize, f32)> {
    // In units in which the row has length count * sources.
    let (from, to) = (index * sources, (index + 1) * sources);
    (from / count..to.div_ceil(count)).map(move |source| {
        let overlap = to.min((source + 1) * count) - from.max(source * count);
        (source, overlap as f32 / sources as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;
    use glam::DVec4;

    fn mean(texels: &[Vec4]) -> DVec4 {
        texels.iter().map(|texel| texel.as_dvec4()).sum::<DVec4>() / texels.len() as f64
    }

    #[test]
    fn levels_halve_and_keep_the_mean() {
        let mut random = Random::new(8);
        for (width, height) in [(1, 1), (2, 2), (16, 4), (7, 5), (1, 13), (100, 33)] {
            let image: Vec<Vec4> = (0..width * height)
                .map(|_| Vec4::new(random.unit(), random.unit(), random.unit(), 0.0))
                .collect();
            let mip_map = MipMap::new(width, height, |index| image[index]);
            let mut size = (width, height);
            for level in &mip_map.levels {
                size = (size.0.div_ceil(2), size.1.div_ceil(2));
                assert_eq!((level.width, level.height), size);
                assert!((mean(&level.texels) - mean(&image)).length() < 1e-6);
            }
            assert_eq!(size, (1, 1));
        }
    }

    #[test]
    fn texels_of_odd_sizes_are_weighted_by_area() {
        let half = Level::halved(3, 1, |index| [Vec4::X, Vec4::Y, Vec4::Z][index]);
        let third = 1.0 / 3.0;
        let first = Vec4::new(2.0 * third, third, 0.0, 0.0);
        let second = Vec4::new(0.0, third, 2.0 * third, 0.0);
        assert!((half.texels[0] - first).length() < 1e-6);
        assert!((half.texels[1] - second).length() < 1e-6);
    }
}
