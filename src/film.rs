//! A rendered frame in linear RGB, and its encoding to sRGB (IEC 61966-2-1).

use crate::math::color::{linear_to_srgb, srgb_to_linear};
use glam::Vec3;

/// A frame: linear RGB radiance with sRGB primaries, rows from the top, each from the left. [`Film::expose`] scales it
/// to units of display white.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Vec3>,
}

impl Film {
    /// A black frame.
    pub fn new(width: u32, height: u32) -> Film {
        Film {
            width,
            height,
            pixels: vec![Vec3::ZERO; width as usize * height as usize],
        }
    }

    /// A frame of given pixels, row by row from the top left.
    ///
    /// # Panics
    ///
    /// If their number is not `width * height`.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<Vec3>) -> Film {
        assert_eq!(pixels.len(), width as usize * height as usize);
        Film {
            width,
            height,
            pixels,
        }
    }

    /// The number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top left.
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// The pixels, row by row from the top left, to write to.
    pub fn pixels_mut(&mut self) -> &mut [Vec3] {
        &mut self.pixels
    }

    /// `weight` times this frame plus `other_weight` times another of the same size.
    ///
    /// # Panics
    ///
    /// If their sizes differ.
    pub fn weighted_sum(&self, weight: f32, other: &Film, other_weight: f32) -> Film {
        self.assert_same_size(other);
        let pixels = self.pixels.iter().zip(&other.pixels);
        Film {
            pixels: pixels.map(|(a, b)| weight * a + other_weight * b).collect(),
            ..*self
        }
    }

    /// Asserts that two frames can be compared pixel by pixel.
    ///
    /// # Panics
    ///
    /// If their sizes differ.
    pub fn assert_same_size(&self, other: &Film) {
        let sizes = [self, other].map(|film| (film.width, film.height));
        assert_eq!(sizes[0], sizes[1], "frames of different sizes");
    }

    /// Multiplies every pixel by 2^`ev`: exposure by `ev` stops.
    pub fn expose(&mut self, ev: f32) {
        let factor = libm::exp2f(ev);
        for pixel in &mut self.pixels {
            *pixel *= factor;
        }
    }

    /// sRGB codes of 8 bits, rounded, values beyond 0 to 1 clipped: R, G, B of every pixel.
    pub fn to_srgb8(&self) -> Vec<u8> {
        let codes = SrgbCodes::new();
        let mut bytes = Vec::with_capacity(3 * self.pixels.len());
        for pixel in &self.pixels {
            bytes.extend(pixel.to_array().map(|channel| codes.code(channel)));
        }
        bytes
    }

    /// sRGB codes of 16 bits, rounded and clipped, in big-endian byte order as in PNG: R, G, B of every pixel.
    pub fn to_srgb16_be(&self) -> Vec<u8> {
        let code = |channel: f32| (linear_to_srgb(channel) * 65535.0).round() as u16;
        self.channels()
            .flat_map(|c| code(c).to_be_bytes())
            .collect()
    }

    fn channels(&self) -> impl Iterator<Item = f32> + '_ {
        self.pixels.iter().flat_map(|p| p.to_array())
    }
}

/// The 8-bit sRGB codes of linear values. A power costs far more than one look-up and one comparison.
struct SrgbCodes {
    /// The linear values from which on the code is above 0, above 1, ...; none is above 255.
    steps: [f32; 256],
    /// The code of the least value of each bin: of values that share sign, exponent and the first seven bits of the
    /// fraction. There is at most one step in a bin.
    first: [u8; SrgbCodes::BINS],
}

impl SrgbCodes {
    /// Below the first step.
    const LEAST: f32 = 1.0 / 8192.0;
    const BINS: usize = Self::bin(1.0) + 1;

    const fn bin(value: f32) -> usize {
        ((value.to_bits() - Self::LEAST.to_bits()) >> 16) as usize
    }

    fn new() -> SrgbCodes {
        let step = |i: usize| match i {
            255 => f32::INFINITY,
            _ => srgb_to_linear((i as f32 + 0.5) / 255.0),
        };
        let steps: [f32; 256] = std::array::from_fn(step);
        let first = |bin: usize| {
            let least = f32::from_bits(Self::LEAST.to_bits() + ((bin as u32) << 16));
            steps.partition_point(|&step| step <= least) as u8
        };
        SrgbCodes {
            first: std::array::from_fn(first),
            steps,
        }
    }

    /// The code of a value, clipped; 0 for NaN.
    #[inline]
    #[expect(clippy::manual_clamp, reason = "NaN becomes the least value")]
    fn code(&self, value: f32) -> u8 {
        let value = value.max(Self::LEAST).min(1.0);
        let first = self.first[Self::bin(value)];
        first + u8::from(self.steps[usize::from(first)] <= value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_count_the_steps_up_to_a_value() {
        let codes = SrgbCodes::new();
        let steps = &codes.steps[..255];
        assert!(steps[0] > SrgbCodes::LEAST && steps[254] < 1.0);
        let around = steps.iter().flat_map(|&x| [x.next_down(), x, x.next_up()]);
        let all = (0..1_000_000).map(|i| i as f32 * 1.1e-6);
        let outside = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-40, 1.0];
        for value in around.chain(all).chain(outside) {
            let below = steps.iter().filter(|&&step| step <= value).count();
            assert_eq!(usize::from(codes.code(value)), below, "{value}");
        }
    }

    #[test]
    fn exposes_encodes_and_rounds() {
        let mut film = Film::new(2, 1);
        film.pixels_mut()
            .copy_from_slice(&[Vec3::new(0.25, 0.11, 1.0), Vec3::new(0.0, -1.0, 9.0)]);
        film.expose(1.0);
        // 0.5 -> 0.735357 * 255 = 187.52 -> 188; 0.22 -> 0.506391 * 255 = 129.13 -> 129.
        assert_eq!(film.to_srgb8(), [188, 129, 255, 0, 0, 255]);
        let codes = film.to_srgb16_be();
        assert_eq!(codes[..2], 48192_u16.to_be_bytes());
        assert_eq!(codes[6..], [0, 0, 0, 0, 255, 255]);
    }

    #[test]
    fn steps_agree_with_the_encoding() {
        let channel = |i: usize| i as f32 / 3000.0 - 0.01;
        let mut film = Film::new(1034, 1);
        for (i, pixel) in film.pixels_mut().iter_mut().enumerate() {
            *pixel = Vec3::new(channel(3 * i), channel(3 * i + 1), channel(3 * i + 2));
        }
        for (i, code) in film.to_srgb8().into_iter().enumerate() {
            let exact = linear_to_srgb(channel(i)) * 255.0;
            assert!((f32::from(code) - exact).abs() <= 0.5 + 1e-4, "{i}");
        }
    }
}
