//! LDR-FLIP: how different two displayed images look to somebody who alternates between them.
//!
//! Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images". Colours are compared after the
//! filters of the eye's contrast sensitivity, and differences count for more where edges or points differ, too.
//! All filters are Gaussians or their derivatives, and are convolved by rows and by columns.

use super::mean;
use super::opponent_color::{from_opponent, hunt_lab, opponent, rgb_to_xyz};
use super::plane::{Plane, gaussian, normalised, radius};
use crate::math::color::srgb_to_linear;
use glam::DVec3;
use std::f64::consts::{PI, SQRT_2};

/// A display 0.7 m wide, of 3840 columns, from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// The contrast sensitivity of luminance, red-green and blue-yellow, in the paper's table 1: sums of
/// a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees, as pairs of a and b.
const SENSITIVITY: [&[[f64; 2]]; 3] = [
    &[[1.0, 0.0047]],
    &[[1.0, 0.0053]],
    &[[34.1, 0.04], [13.5, 0.025]],
];

/// The exponent of colour differences.
const COLOR_EXPONENT: f64 = 0.7;

/// Colour differences up to this fraction of the largest one...
const KNEE: f64 = 0.4;

/// ...are spread over the range from 0 to this.
const KNEE_VALUE: f64 = 0.95;

/// The width of the detector of edges and points, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// The exponent of feature differences.
const FEATURE_EXPONENT: f64 = 0.5;

/// The mean FLIP of two displayed images over all pixels, as the authors recommend: 0 if nothing is seen, 1 for
/// the largest difference.
///
/// The images are of the same size, columns and rows, and are sRGB codes as
/// [`Film::to_srgb8`](crate::film::Film::to_srgb8) gives them. They are seen at 67 pixels for each degree.
///
/// # Panics
///
/// If an image has fewer or more pixels than its size says.
pub fn flip([width, height]: [u32; 2], reference: &[u8], image: &[u8]) -> f64 {
    let [width, height] = [width, height].map(|size| size as usize);
    let both = [reference, image].map(|codes| {
        assert_eq!(codes.len(), 3 * width * height, "pixels of another size");
        OpponentColors::of(codes, width)
    });
    let colors = both.each_ref().map(OpponentColors::perceived);
    let features = both.each_ref().map(OpponentColors::features);
    let largest = largest_color_difference();
    let error = |i: usize| {
        let color = color_difference(colors[0][i], colors[1][i]);
        let [edge, point] = [0, 1].map(|kind| (features[0][i][kind] - features[1][i][kind]).abs());
        let feature = libm::pow(edge.max(point) / SQRT_2, FEATURE_EXPONENT);
        libm::pow(redistributed(color, largest), 1.0 - feature)
    };
    mean(&(0..width * height).map(error).collect::<Vec<f64>>())
}

/// An image in the linear opponent colour space YCxCz, in which the filters are applied.
struct OpponentColors {
    /// Luminance, red-green and blue-yellow.
    channels: [Plane; 3],
}

impl OpponentColors {
    /// Of sRGB codes.
    fn of(codes: &[u8], width: usize) -> OpponentColors {
        let to_xyz = rgb_to_xyz();
        let white = to_xyz * DVec3::ONE;
        let linear: [f64; 256] =
            std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0).into());
        let pixels = codes.as_chunks().0.iter().map(|rgb: &[u8; 3]| {
            let rgb = DVec3::from_array(rgb.map(|code| linear[code as usize]));
            opponent(to_xyz * rgb / white)
        });
        let pixels: Vec<DVec3> = pixels.collect();
        let channels = [0, 1, 2].map(|channel| Plane {
            width,
            values: pixels.iter().map(|pixel| pixel[channel]).collect(),
        });
        OpponentColors { channels }
    }

    /// What the eye resolves of each pixel, in CIELAB; a and b in proportion to the lightness (the Hunt effect).
    fn perceived(&self) -> Vec<DVec3> {
        let to_xyz = rgb_to_xyz();
        let (to_rgb, white) = (to_xyz.inverse(), to_xyz * DVec3::ONE);
        let sigma = |b: f64| (b / 2.0).sqrt() / PI * PIXELS_PER_DEGREE;
        let widest = SENSITIVITY.concat().into_iter().map(|[_, b]| sigma(b));
        let radius = radius(widest.fold(0.0, f64::max));
        let filtered = [0, 1, 2].map(|channel| {
            let gaussians = SENSITIVITY[channel].iter().map(|&[a, b]| {
                let weights = gaussian(sigma(b), radius);
                let sum: f64 = weights.iter().sum();
                (a / b.sqrt() * sum * sum, normalised(weights))
            });
            let gaussians: Vec<(f64, Vec<f64>)> = gaussians.collect();
            let total: f64 = gaussians.iter().map(|(weight, _)| weight).sum();
            let mut filtered = vec![0.0; self.channels[channel].values.len()];
            for (weight, filter) in gaussians {
                let blurred = self.channels[channel].convolved(&filter, &filter);
                for (sum, value) in filtered.iter_mut().zip(blurred.values) {
                    *sum += weight / total * value;
                }
            }
            filtered
        });
        let pixel = |i: usize| {
            let color = DVec3::from_array([0, 1, 2].map(|channel| filtered[channel][i]));
            let rgb = to_rgb * (from_opponent(color) * white);
            hunt_lab(to_xyz * rgb.clamp(DVec3::ZERO, DVec3::ONE) / white)
        };
        (0..filtered[0].len()).map(pixel).collect()
    }

    /// How much of an edge and how much of a point each pixel's luminance is.
    fn features(&self) -> Vec<[f64; 2]> {
        let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = radius(sigma);
        let weights = gaussian(sigma, radius);
        let offsets = || (-(radius as i32)..=radius as i32).map(f64::from);
        let derivative = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let weights = offsets().zip(&weights).map(|(x, weight)| of(x) * weight);
            let weights: Vec<f64> = weights.collect();
            let sum = |sign: f64| -> f64 { weights.iter().map(|w| (sign * w).max(0.0)).sum() };
            let [positive, negative] = [sum(1.0), sum(-1.0)];
            let scale = |w: f64| if w > 0.0 { w / positive } else { w / negative };
            weights.iter().copied().map(scale).collect()
        };
        let edge = derivative(&|x| -x);
        let point = derivative(&|x| (x / sigma).powi(2) - 1.0);
        let smooth = normalised(weights.clone());
        let luminance = Plane {
            values: self.channels[0]
                .values
                .iter()
                .map(|y| (y + 16.0) / 116.0)
                .collect(),
            ..self.channels[0]
        };
        let magnitude = |filter: &[f64]| -> Vec<f64> {
            let x = luminance.convolved(filter, &smooth).values;
            let y = luminance.convolved(&smooth, filter).values;
            x.iter().zip(y).map(|(x, y)| x.hypot(y)).collect()
        };
        let both = magnitude(&edge).into_iter().zip(magnitude(&point));
        both.map(|(edge, point)| [edge, point]).collect()
    }
}

/// HyAB: city-block in lightness, Euclidean in a and b; raised to the exponent of colour differences.
fn color_difference(a: DVec3, b: DVec3) -> f64 {
    let difference = a - b;
    let distance = difference.x.abs() + difference.y.hypot(difference.z);
    libm::pow(distance, COLOR_EXPONENT)
}

/// Between the green and the blue of sRGB.
fn largest_color_difference() -> f64 {
    let to_xyz = rgb_to_xyz();
    let lab = |rgb: DVec3| hunt_lab(to_xyz * rgb / (to_xyz * DVec3::ONE));
    color_difference(lab(DVec3::Y), lab(DVec3::Z))
}

/// A colour difference in the range from 0 to 1, of which small ones take the most.
fn redistributed(difference: f64, largest: f64) -> f64 {
    let knee = KNEE * largest;
    if difference < knee {
        KNEE_VALUE * difference / knee
    } else {
        KNEE_VALUE + (1.0 - KNEE_VALUE) * (difference - knee) / (largest - knee)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    const SIZE: [u32; 2] = [40, 30];

    /// An image of 40 x 30 pixels, by column and row.
    fn image(mut color: impl FnMut(i32, i32) -> [u8; 3]) -> Vec<u8> {
        let pixels = (0..30).flat_map(|y| (0..40).map(move |x| (x, y)));
        pixels.flat_map(|(x, y)| color(x, y)).collect()
    }

    /// A slope of greys, with its middle brighter by some codes.
    fn slope(more: u8) -> Vec<u8> {
        image(|x, y| {
            let is_middle = (10..30).contains(&x) && (10..20).contains(&y);
            [(4 * x + y) as u8 + if is_middle { more } else { 0 }; 3]
        })
    }

    /// Squares of 8 pixels, some pixels to the right.
    fn checker(shift: i32, colors: [[u8; 3]; 2]) -> Vec<u8> {
        image(|x, y| colors[((x - shift).div_euclid(8) + y / 8).rem_euclid(2) as usize])
    }

    /// Each code off by up to some codes.
    fn noisy(mut image: Vec<u8>, codes: u8) -> Vec<u8> {
        let mut random = Random::new(1);
        for code in &mut image {
            let offset = random.below(2 * usize::from(codes) + 1) as u8;
            *code = code.saturating_add(offset).saturating_sub(codes);
        }
        image
    }

    fn hues() -> Vec<u8> {
        image(|x, y| [(6 * x) as u8, (8 * y) as u8, (234 - 6 * x) as u8])
    }

    fn swapped(mut image: Vec<u8>) -> Vec<u8> {
        image.chunks_exact_mut(3).for_each(|rgb| rgb.swap(0, 2));
        image
    }

    fn line(width: i32) -> Vec<u8> {
        image(|x, _| {
            if (20..20 + width).contains(&x) {
                [255; 3]
            } else {
                [30; 3]
            }
        })
    }

    /// The means that NVIDIA's C++ code (version 1.2, through the crate nv-flip 0.1.2, at its 67.0206 pixels per
    /// degree) gives for pairs of a reference and an image.
    #[test]
    fn the_authors_code_gives_the_same() {
        let grey = [[60; 3], [190; 3]];
        let colored = [[200, 40, 40], [40, 60, 220]];
        for (number, ([reference, image], expected)) in [
            ([slope(0), slope(1)], 0.006_355),
            ([slope(0), slope(16)], 0.050_273),
            ([slope(0), slope(64)], 0.142_333),
            ([slope(0), noisy(slope(0), 8)], 0.052_387),
            ([hues(), noisy(hues(), 60)], 0.353_286),
            ([hues(), swapped(hues())], 0.739_603),
            ([checker(0, grey), checker(1, grey)], 0.214_337),
            ([checker(0, colored), checker(3, colored)], 0.280_439),
            ([line(0), line(1)], 0.120_105),
            ([line(1), line(3)], 0.139_463),
            ([vec![0; 3600], vec![255; 3600]], 0.967_392),
        ]
        .into_iter()
        .enumerate()
        {
            let flip = flip(SIZE, &reference, &image);
            assert!(
                (flip - expected).abs() < 1e-4,
                "{number}: {flip} {expected}"
            );
        }
    }

    #[test]
    fn order_does_not_matter() {
        let [a, b] = [hues(), noisy(hues(), 60)];
        assert_eq!(flip(SIZE, &a, &b), flip(SIZE, &b, &a));
    }

    /// At more than 19 pixels from a change nothing is filtered over it: the parts are the whole.
    #[test]
    fn what_does_not_change_does_not_count() {
        let dot = |is_there: bool| {
            let color = |i: usize| if is_there && i == 3 * 50 { 255 } else { 0 };
            (0..300).map(color).collect::<Vec<u8>>()
        };
        let of = |from: usize, to: usize| {
            let [a, b] = [false, true].map(|is_there| dot(is_there)[3 * from..3 * to].to_vec());
            flip([(to - from) as u32, 1], &a, &b) * (to - from) as f64
        };
        assert_eq!(of(0, 25), 0.0);
        assert!((of(0, 100) - of(25, 75)).abs() < 1e-12);
    }

    /// Green and blue are as far apart as colours are, and an even image has nothing but colour.
    #[test]
    fn the_largest_difference_is_one() {
        let even = |code: [u8; 3]| code.repeat(1200);
        let flip = flip(SIZE, &even([0, 255, 0]), &even([0, 0, 255]));
        assert!((flip - 1.0).abs() < 1e-3, "{flip}");
    }

    #[test]
    fn a_single_pixel_is_a_picture() {
        let flip = flip([1, 1], &[0, 0, 0], &[255, 255, 255]);
        assert!(flip > 0.5, "{flip}");
    }
}
