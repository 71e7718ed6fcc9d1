//! The error of a frame, estimated from the difference of its A/B half buffers.

use crate::metrics::normaliser;
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The estimated error of a frame: its Monte Carlo noise and the error of its irradiance cache.
///
/// The error is the relMSE: the mean over pixels and channels of (x - r)^2 / (m^2 + (display white / 10)^2), of this
/// very frame x, where r is the frame without noise, and m the mean of x around the pixel: see [`normaliser`]. It
/// knows nothing of light that no sample has found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorEstimate {
    /// An unbiased estimate of the frame's relMSE; at least 0.
    pub rel_mse: f64,
    /// The standard deviation of the difference between error and estimate.
    pub standard_error: f64,
}

impl ErrorEstimate {
    /// The 95 % confidence interval of the frame's error.
    pub fn interval(&self) -> [f64; 2] {
        let half_width = 1.96 * self.standard_error;
        let (low, high) = (self.rel_mse - half_width, self.rel_mse + half_width);
        [low.max(0.0), high]
    }

    /// The sum of two independent parts of an error.
    pub(super) fn plus(self, other: ErrorEstimate) -> ErrorEstimate {
        ErrorEstimate {
            rel_mse: self.rel_mse + other.rel_mse,
            standard_error: self.standard_error.hypot(other.standard_error),
        }
    }

    /// The noise of an image, from half the differences of its half buffers.
    ///
    /// With half buffers r + a and r + b the error of the image is (a + b) / 2, and half their difference is
    /// (a - b) / 2: the squares have the same expectation, and differ by a b. The variance of the sum of a b
    /// over the channels is the sum of the squares of the covariance matrix of a, of which a pixel and its neighbour
    /// give two independent estimates. That underestimates where noise varies from pixel to pixel. The fourth power
    /// of a pixel's own difference, three times the square of its variance if noise is normal, overestimates where it
    /// is not. Their mean is taken.
    pub(super) fn of(differences: &RelativeHalfDifferences) -> ErrorEstimate {
        let RelativeHalfDifferences { values, spacing } = differences;
        let count = values.len() as f64;
        let squares: f64 = values.iter().map(|d| f64::from(d.length_squared())).sum();
        let neighbours = values.iter().zip(values.iter().cycle().skip(*spacing));
        let products: f64 = neighbours.map(|(d, e)| f64::from(d.dot(*e)).powi(2)).sum();
        let fourths: f64 = values
            .iter()
            .map(|d| f64::from(d.length_squared()).powi(2))
            .sum();
        let covariances = 4.0 * 0.5 * (products + fourths / 3.0);
        // Pixels that share corner samples share noise: the correlation with the four adjacent pixels is 1/2, with
        // the four diagonal ones 1/4. The variance grows by the sum of the squares, 1 + 4/4 + 4/16.
        let shared = if *spacing == 1 { 1.0 } else { 2.25 };
        ErrorEstimate {
            rel_mse: squares / count / 3.0,
            standard_error: (shared * covariances).sqrt() / count / 3.0,
        }
    }
}

/// Half the difference of the A/B half buffers at each pixel, relative to the radiance.
pub(super) struct RelativeHalfDifferences {
    values: Vec<Vec3>,
    /// The distance to the nearest pixels in a row that share no samples.
    spacing: usize,
}

impl RelativeHalfDifferences {
    /// Of rows of `width` pixels.
    pub(super) fn new(
        pixels: &[Vec3],
        half_differences: &[Vec3],
        width: usize,
        display_white: f32,
        shared_corners: bool,
    ) -> RelativeHalfDifferences {
        let spacing = if shared_corners { 2 } else { 1 };
        let relative = |index: usize| {
            let square = normaliser(pixels, width, index, spacing, display_white);
            half_differences[index] / square.map(f32::sqrt)
        };
        RelativeHalfDifferences {
            values: (0..pixels.len()).into_par_iter().map(relative).collect(),
            spacing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::synthetic::Noise;

    const WIDTH: usize = 64;
    const COUNT: usize = WIDTH * 48;

    /// The estimated and the true error of an image of constant radiance 0.5, whose half buffers have noise of this
    /// variance: grey, or independent in each channel.
    fn estimated_and_true(noise: &mut Noise, variance: f32, grey: bool) -> (ErrorEstimate, f64) {
        let mut half = || -> Vec<Vec3> {
            let mut value = |_| {
                let sigma = f64::from(variance).sqrt();
                match grey {
                    true => Vec3::splat(0.5 + (sigma * noise.normal()) as f32),
                    false => noise.light(Vec3::splat(0.5), sigma),
                }
            };
            (0..COUNT).map(&mut value).collect()
        };
        let (a, b) = (half(), half());
        let both = || a.iter().zip(&b);
        let image: Vec<Vec3> = both().map(|(a, b)| 0.5 * (a + b)).collect();
        let half_differences: Vec<Vec3> = both().map(|(a, b)| 0.5 * (a - b)).collect();
        let relative = RelativeHalfDifferences::new(&image, &half_differences, WIDTH, 1.0, false);
        let error = |(index, x): (usize, &Vec3)| {
            let square = normaliser(&image, WIDTH, index, 1, 1.0);
            ((x - 0.5).powf(2.0) / square).element_sum()
        };
        let sum: f32 = image.iter().enumerate().map(error).sum();
        (
            ErrorEstimate::of(&relative),
            f64::from(sum) / COUNT as f64 / 3.0,
        )
    }

    #[test]
    fn noise_of_known_variance() {
        let mut noise = Noise::new(1);
        for grey in [true, false] {
            let variance = 0.0016;
            let runs: Vec<_> = (0..100)
                .map(|_| estimated_and_true(&mut noise, variance, grey))
                .collect();
            let mean = runs
                .iter()
                .map(|(estimated, _)| estimated.rel_mse)
                .sum::<f64>()
                / 100.0;
            // The variance of the mean of two half buffers, over the squares of the radiance and of a tenth of white.
            let expected = f64::from(variance) / 2.0 / 0.26;
            assert!((mean / expected - 1.0).abs() < 0.01, "{mean} {expected}");
            let z = runs.iter().map(|(estimated, error)| {
                let off = (estimated.rel_mse - error) / estimated.standard_error;
                off * off
            });
            let mean_square = z.sum::<f64>() / 100.0;
            // The fourth power overestimates the variance of independent channels.
            let least = if grey { 0.6 } else { 0.4 };
            assert!((least..1.4).contains(&mean_square), "{grey} {mean_square}");
        }
    }

    #[test]
    fn no_noise_is_no_error() {
        let image = vec![Vec3::ONE; 12];
        let none = vec![Vec3::ZERO; 12];
        let relative = RelativeHalfDifferences::new(&image, &none, 4, 1.0, true);
        assert_eq!(ErrorEstimate::of(&relative).interval(), [0.0, 0.0]);
    }
}
