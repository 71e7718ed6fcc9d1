//! A rendered frame in linear RGB, and its encoding to sRGB (IEC 61966-2-1).

mod dither;
mod srgb_codes;

use crate::math::color::linear_to_srgb;
use glam::Vec3;
use srgb_codes::{NearestCodes, ThresholdCodes};

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
        let codes = NearestCodes::new();
        let mut bytes = Vec::with_capacity(3 * self.pixels.len());
        for pixel in &self.pixels {
            bytes.extend(pixel.to_array().map(|channel| codes.code(channel)));
        }
        bytes
    }

    /// sRGB codes of 8 bits, dithered, values beyond 0 to 1 clipped: R, G, B of every pixel.
    ///
    /// Each code is the one at or below the value or the next one, chosen by a threshold of blue noise: where a slope
    /// is too gentle for 8 bits, rounded codes show bands, these show the slope. On average they give the value in
    /// linear light; a value that is a code's gives that code. The choice depends on the pixel's place and the number of
    /// the frame only.
    pub fn to_srgb8_dithered(&self, frame: u32) -> Vec<u8> {
        let codes = ThresholdCodes::new();
        let mut pixels = Vec::with_capacity(self.pixels.len());
        for (y, row) in self.pixels.chunks(self.width.max(1) as usize).enumerate() {
            let thresholds = dither::thresholds(frame, y);
            for columns in row.chunks(dither::SIZE) {
                pixels.extend(columns.iter().zip(&thresholds).map(|(pixel, thresholds)| {
                    [0, 1, 2].map(|i| codes.code(pixel[i], thresholds[i]))
                }));
            }
        }
        pixels.into_flattened()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::color::srgb_to_linear;

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

    /// The light of the codes of one channel.
    fn lights(codes: &[u8], channel: usize) -> impl Iterator<Item = f64> {
        let codes = codes.iter().skip(channel).step_by(3);
        codes.map(|&code| f64::from(srgb_to_linear(f32::from(code) / 255.0)))
    }

    /// Over each tile of one colour, in every channel and frame.
    #[test]
    fn dithered_codes_are_right_on_average() {
        const CELLS: usize = 64 * 64;
        let values = [
            0.0, 1e-6, 1e-4, 3e-4, 0.01, 0.2, 0.499, 0.9, 0.9999, 1.0, 7.0,
        ];
        let tiles = values.map(|value| [value * Vec3::new(1.0, 0.7, 0.3); CELLS]);
        let film = Film::from_pixels(64, 64 * values.len() as u32, tiles.concat());
        for frame in [0, 1, 17, u32::MAX] {
            let codes = film.to_srgb8_dithered(frame);
            for (tile, pixels) in codes.chunks(3 * CELLS).zip(tiles) {
                for (channel, value) in pixels[0].to_array().into_iter().enumerate() {
                    let value = f64::from(value.min(1.0));
                    let mean = lights(tile, channel).sum::<f64>() / CELLS as f64;
                    // Half of the resolution of thresholds times the largest step from a code to the next.
                    let resolution = 0.5 / CELLS as f64 * 0.0089;
                    let error = (mean - value).abs();
                    assert!(error < resolution + 1e-9, "{value}: {mean}");
                }
            }
        }
    }

    /// A wall that grows 23 codes brighter over 580 pixels.
    #[test]
    fn slopes_have_no_bands() {
        const WIDTH: usize = 580;
        let slope = |x: f32| 100.0 + 23.0 * x / WIDTH as f32;
        let pixel = |x: usize| Vec3::splat(srgb_to_linear(slope(x as f32) / 255.0));
        let row: Vec<Vec3> = (0..WIDTH).map(pixel).collect();
        let film = Film::from_pixels(WIDTH as u32, 96, row.repeat(96));
        let [rounded, dithered] = [film.to_srgb8(), film.to_srgb8_dithered(3)];
        // How far the mean of a block of 8 x 8 is from the slope, in codes of green.
        let worst = |codes: &[u8]| {
            let blocks = (0..96 - 7)
                .step_by(8)
                .flat_map(|y| (0..WIDTH - 7).map(move |x| (x, y)));
            let errors = blocks.map(|(x, y)| {
                let pixels = (0..64).map(|i| (y + i / 8) * WIDTH + x + i % 8);
                let mean = pixels.map(|i| f32::from(codes[3 * i + 1])).sum::<f32>() / 64.0;
                (mean - slope(x as f32 + 3.5)).abs()
            });
            errors.fold(0.0, f32::max)
        };
        assert!(worst(&rounded) > 0.3 && worst(&dithered) < 0.13);
        // Columns of one code from top to bottom: in dithered frames, those that have just the light of a code.
        let of_one = |codes: &[u8]| {
            let column = |x: usize| codes.iter().skip(3 * x).step_by(3 * WIDTH);
            let of_one = (0..WIDTH).filter(|&x| column(x).all(|&code| code == codes[3 * x]));
            of_one.count()
        };
        assert_eq!(of_one(&rounded), WIDTH);
        assert!(of_one(&dithered) < 40);
    }

    /// Two patterns of as many codes above as below differ in half of the pixels if they are independent.
    #[test]
    fn frames_and_channels_have_noise_of_their_own() {
        let between = srgb_to_linear(100.5 / 255.0);
        let film = Film::from_pixels(64, 64, vec![Vec3::splat(between); 64 * 64]);
        let patterns: Vec<Vec<f64>> = (0..4)
            .flat_map(|frame| {
                let codes = film.to_srgb8_dithered(frame);
                (0..3).map(move |channel| lights(&codes, channel).collect())
            })
            .collect();
        for (i, a) in patterns.iter().enumerate() {
            for b in &patterns[..i] {
                let differing = a.iter().zip(b).filter(|(a, b)| a != b).count();
                assert!((1600..2500).contains(&differing), "{i}: {differing}");
            }
        }
    }
}
