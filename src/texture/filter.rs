//! Anisotropic filtering: taps from a mip map along the major axis of the footprint (McCormack et al. 1999, "Feline:
//! Fast Elliptical Lines for Anisotropic Texture Mapping").

use super::Texture;
use super::bilinear::Place;
use glam::{Vec2, Vec3, Vec4};

/// The most taps of a lookup. A footprint that is longer, compared with its width, is widened.
///
/// Measured on a checked floor up to the horizon: more taps do not reduce the error of a frame of one sample in the middle
/// of each pixel, 4 have 1.5 times the error.
const MAX_TAPS: f32 = 8.0;

/// The square of the shortest footprint that is filtered, in texels: over less, even the mean around the corner that
/// interpolation has at a white texel among black ones is within 1/64 of the sample.
const MIN_LENGTH_SQUARED: f32 = 1.0 / 256.0;

/// The smallest weight of a coarser level: less changes the colour by less than half an 8-bit code.
const MIN_WEIGHT: f32 = 1.0 / 512.0;

impl Texture {
    /// The mean linear colour over a parallelogram around `uv`, spanned by the two changes of texture coordinates of
    /// `footprint`. [`Texture::sample`] if they are zero or far below a texel; the mean of all texels if they are not finite.
    ///
    /// The filter has the variance of the parallelogram: along its minor axis by the choice of the mip map's level, along
    /// the major axis by the distance of the taps.
    #[inline(always)]
    pub fn filtered(&self, uv: Vec2, footprint: [Vec2; 2]) -> Vec3 {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let axes = Axes::of(footprint.map(|change| change * size));
        if axes.major_squared < MIN_LENGTH_SQUARED {
            return self.sample(uv);
        }
        if !axes.major_squared.is_finite() {
            return self.level(self.mip_map.last(), Place::of(uv)).truncate();
        }
        // Interpolated texels of size s have a variance of s^2 / 4 - 1/12 around those of level 0, which have 1/6; the
        // mean over a width of w adds w^2 / 12. So s^2 = 1 + w^2 / 3.
        let texel_squared = (1.0 + axes.minor_squared / 3.0)
            .max((axes.major_squared + 3.0) / (MAX_TAPS * MAX_TAPS + 3.0));
        let length_squared = (axes.major_squared + 3.0 - 3.0 * texel_squared).max(0.0);
        // A line that hardly widens the filter needs a single tap.
        if length_squared < 0.25 * texel_squared {
            return self.trilinear(texel_squared, Place::of(uv)).truncate();
        }
        let taps = (length_squared / texel_squared).sqrt().ceil();
        let taps = taps.clamp(2.0, MAX_TAPS);
        // So many points at equal distances have the variance of a line that is sqrt(taps^2 - 1) distances long.
        let step = axes.direction() * (length_squared / (taps * taps - 1.0)).sqrt() / size;
        let first = Place::of(uv).moved(-0.5 * (taps - 1.0) * step);
        let mut sum = Vec4::ZERO;
        for tap in 0..taps as u32 {
            sum += self.trilinear(texel_squared, first.moved(tap as f32 * step));
        }
        sum.truncate() / taps
    }

    /// The colour from the levels whose texels are smaller and larger than the square root of `texel_squared`, in texels
    /// of level 0, weighted so that the filter's variance is that of texels of this size.
    #[inline(always)]
    fn trilinear(&self, texel_squared: f32, place: Place) -> Vec4 {
        // The power of 4 below it.
        let level = (texel_squared.to_bits() >> 23).saturating_sub(127) / 2;
        if level as usize >= self.mip_map.last() {
            return self.level(self.mip_map.last(), place);
        }
        let below = f32::from_bits((127 + 2 * level) << 23);
        let weight = (texel_squared / below - 1.0) / 3.0;
        let finer = self.level(level as usize, place);
        if weight < MIN_WEIGHT {
            return finer;
        }
        finer.lerp(self.level(level as usize + 1, place), weight)
    }

    /// The colour of a level at a place, interpolated bilinearly.
    #[inline(always)]
    fn level(&self, level: usize, place: Place) -> Vec4 {
        if level == 0 {
            self.at(place)
        } else {
            self.mip_map.sample(level, place)
        }
    }
}

/// The axes of the ellipse that the unit circle becomes: the singular values and the first singular vector of a
/// matrix (Heckbert 1989, "Fundamentals of Texture Mapping and Image Warping").
struct Axes {
    major_squared: f32,
    minor_squared: f32,
    /// Along the major axis; of any length.
    along: Vec2,
}

impl Axes {
    /// Of the matrix with these columns.
    #[inline(always)]
    fn of([a, b]: [Vec2; 2]) -> Axes {
        // The matrix times its transpose: [[xx, xy], [xy, yy]].
        let (xx, yy) = (a.x * a.x + b.x * b.x, a.y * a.y + b.y * b.y);
        let xy = a.x * a.y + b.x * b.y;
        let half = 0.5 * (xx - yy);
        let root = (half * half + xy * xy).sqrt();
        let major_squared = 0.5 * (xx + yy) + root;
        let determinant = (a.x * b.y - a.y * b.x).abs();
        // Of two forms of the eigenvector, the one without cancellation.
        let along = if half >= 0.0 {
            Vec2::new(root + half, xy)
        } else {
            Vec2::new(xy, root - half)
        };
        Axes {
            major_squared,
            minor_squared: determinant * (determinant / major_squared),
            along,
        }
    }

    /// The unit direction of the major axis.
    #[inline(always)]
    fn direction(&self) -> Vec2 {
        self.along.normalize_or(Vec2::X)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    /// The variance along each texture coordinate, in texels, of where lookups take their colour from: measured by moving
    /// one white texel, as a mean over lookups all over an area of 4 x 4 texels.
    fn variance(size: usize, footprint: [Vec2; 2]) -> Vec2 {
        let (mut total, mut squares) = (0.0, Vec2::ZERO);
        for index in 0..size * size {
            let mut texels = vec![[0; 3]; size * size];
            texels[index] = [255; 3];
            let texture = Texture::new(size, size, texels).expect("as many texels as that");
            let texel = Vec2::new((index % size) as f32, (index / size) as f32) + 0.5;
            for lookup in 0..256 {
                let shift = Vec2::new((lookup % 16) as f32, (lookup / 16) as f32);
                let position = 0.5 * size as f32 + 0.125 + 0.25 * shift;
                let uv = Vec2::new(position.x, size as f32 - position.y) / size as f32;
                let weight = texture.filtered(uv, footprint).x / 256.0;
                total += weight;
                squares += weight * (texel - position) * (texel - position);
            }
        }
        assert!((total - 1.0).abs() < 1e-4, "{total}");
        squares
    }

    #[test]
    fn the_filter_has_the_variance_of_the_footprint() {
        for [width, height] in [[1.0, 1.0], [2.0, 0.5], [0.5, 3.0], [3.0, 3.0], [1.0, 6.0]] {
            let footprint = [Vec2::X * width / 32.0, Vec2::Y * height / 32.0];
            let found = variance(32, footprint);
            // That of the footprint and of bilinear interpolation.
            let exact = Vec2::new(width * width, height * height) / 12.0 + 1.0 / 6.0;
            let error = (found / exact - 1.0).abs().max_element();
            assert!(error < 0.05, "{width} {height}: {found} instead of {exact}");
        }
    }

    fn noise(width: usize, height: usize) -> Texture {
        let mut random = Random::new(3);
        let texels = (0..width * height).map(|_| [0; 3].map(|_| random.below(256) as u8));
        Texture::new(width, height, texels.collect()).expect("as many texels as that")
    }

    #[test]
    fn no_footprint_is_a_sample() {
        let texture = noise(7, 5);
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let uv = Vec2::new(random.unit(), random.unit()) * 40.0 - 20.0;
            assert_eq!(texture.filtered(uv, [Vec2::ZERO; 2]), texture.sample(uv));
        }
    }

    #[test]
    fn small_footprints_change_the_colour_little_and_steadily() {
        let texture = noise(8, 8);
        let mut random = Random::new(2);
        for _ in 0..1000 {
            let uv = Vec2::new(random.unit(), random.unit());
            let direction = Vec2::from_angle(6.3 * random.unit());
            let at = |width: f32| texture.filtered(uv, [0.125 * width * direction, Vec2::ZERO]);
            assert_eq!(at(0.06), texture.sample(uv));
            // On both sides of the threshold below which textures are not filtered.
            assert!((at(0.062) - at(0.063)).length() < 0.03);
        }
    }

    #[test]
    fn constant_textures_stay_constant() {
        for (width, height) in [(1, 1), (2, 1), (3, 5), (16, 16), (1, 9)] {
            let texture = Texture::new(width, height, vec![[1, 100, 255]; width * height]);
            let texture = texture.expect("as many texels as that");
            let color = texture.sample(Vec2::ZERO);
            let mut random = Random::new(4);
            for _ in 0..1000 {
                let mut vector = || {
                    let scale = libm::exp2f(20.0 * random.unit() - 10.0);
                    scale * (Vec2::new(random.unit(), random.unit()) - 0.5)
                };
                let found = texture.filtered(vector(), [vector(), vector()]);
                assert!((found / color - 1.0).abs().max_element() < 1e-6);
            }
        }
    }

    #[test]
    fn large_footprints_give_the_mean() {
        for (width, height) in [(16, 16), (5, 3), (1, 1), (64, 2)] {
            let texture = noise(width, height);
            let mean = texture.mean().as_vec3();
            for width in [100.0, 1e6, 1e18, 1e30, f32::INFINITY, f32::NAN] {
                let uv = Vec2::new(0.3, -12.7);
                let found = texture.filtered(uv, [width * Vec2::X, width * Vec2::ONE]);
                assert!((found - mean).length() < 1e-3, "{found} instead of {mean}");
            }
        }
    }

    #[test]
    fn all_coordinates_and_footprints_give_colors() {
        let texture = noise(5, 3);
        let numbers = [
            0.0,
            -0.3,
            1e-30,
            1e-10,
            0.5,
            1e6,
            1e19,
            -3e38,
            f32::INFINITY,
            f32::NAN,
        ];
        for index in 0..numbers.len().pow(4) {
            let [a, b, c, d] = [1, 10, 100, 1000].map(|place| numbers[index / place % 10]);
            for uv in [Vec2::new(0.2, 0.7), Vec2::new(1e20, f32::NAN)] {
                let found = texture.filtered(uv, [Vec2::new(a, b), Vec2::new(c, d)]);
                assert!(found.min_element() >= 0.0 && found.max_element() <= 1.00001);
            }
        }
    }

    #[test]
    fn axes_of_known_matrices() {
        let turned = Vec2::from_angle(0.4);
        let axes = Axes::of([3.0 * turned, -0.5 * turned.perp()]);
        assert!((axes.major_squared - 9.0).abs() < 1e-5);
        assert!((axes.minor_squared - 0.25).abs() < 1e-5);
        assert!(axes.direction().perp_dot(turned).abs() < 1e-6);
        let axes = Axes::of([Vec2::new(0.0, 2.0), Vec2::new(0.0, 2.0)]);
        assert_eq!([axes.major_squared, axes.minor_squared], [8.0, 0.0]);
        assert_eq!(axes.direction(), Vec2::Y);
    }
}
