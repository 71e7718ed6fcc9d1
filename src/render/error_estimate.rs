use crate::metrics::normaliser;
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How far a frame is from what it would be with endless samples, by the frame alone and by what is known of
/// the light that it looks up.
///
/// The error is relMSE: the mean over pixels and channels of (x - r)^2 / (m^2 + (white / 10)^2), of this very
/// frame x, where r is the frame without noise, and m the mean of x around the pixel: see [`normaliser`]. What
/// no sample has met is not known to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorEstimate {
    /// An unbiased estimate of the frame's relMSE; at least 0.
    pub relative_square_error: f64,
    /// How much the error may differ from the estimate: the standard deviation of their difference.
    pub standard_error: f64,
}

impl ErrorEstimate {
    /// What holds the frame's error 19 times of 20.
    pub fn interval(&self) -> [f64; 2] {
        let reach = 1.96 * self.standard_error;
        let (low, high) = (
            self.relative_square_error - reach,
            self.relative_square_error + reach,
        );
        [low.max(0.0), high]
    }

    /// Of two parts of an error that have nothing to do with each other.
    pub(super) fn plus(self, other: ErrorEstimate) -> ErrorEstimate {
        ErrorEstimate {
            relative_square_error: self.relative_square_error + other.relative_square_error,
            standard_error: self.standard_error.hypot(other.standard_error),
        }
    }

    /// The error of a picture, given how far half the difference of its halves is from 0, see
    /// [`RelativeDeviations`].
    ///
    /// With halves r + a and r + b the picture is off by (a + b) / 2, and half their difference is
    /// (a - b) / 2: the squares have the same expectation, and differ by a b. The variance of the sum of a b
    /// over the channels is that of the squares of the covariance matrix of a, which neighbours estimate
    /// twice, independently. That is too little where noise changes from pixel to pixel, and the fourth power
    /// of a pixel's own difference, three times the square of its variance if noise is normal, is too much
    /// where it is not: their mean is taken.
    pub(super) fn of(deviations: &RelativeDeviations) -> ErrorEstimate {
        let RelativeDeviations { values, reach } = deviations;
        let count = values.len() as f64;
        let squares: f64 = values.iter().map(|d| f64::from(d.length_squared())).sum();
        let neighbours = values.iter().zip(values.iter().cycle().skip(*reach));
        let products: f64 = neighbours.map(|(d, e)| f64::from(d.dot(*e)).powi(2)).sum();
        let fourths: f64 = values
            .iter()
            .map(|d| f64::from(d.length_squared()).powi(2))
            .sum();
        let covariances = 4.0 * 0.5 * (products + fourths / 3.0);
        // Pixels that share corners share noise: a pixel's correlation with the four beside it is 1/2,
        // with the four across a corner 1/4. The sum of the squares is what the variance grows by.
        let shared = if *reach == 1 { 1.0 } else { 2.25 };
        ErrorEstimate {
            relative_square_error: squares / count / 3.0,
            standard_error: (shared * covariances).sqrt() / count / 3.0,
        }
    }
}

/// Half the difference of the halves of each pixel, in proportion to the light there.
pub(super) struct RelativeDeviations {
    values: Vec<Vec3>,
    /// From a pixel to the nearest ones to either side that share no samples with it.
    reach: usize,
}

impl RelativeDeviations {
    /// Of rows of `width` pixels.
    pub(super) fn new(
        pixels: &[Vec3],
        deviations: &[Vec3],
        width: usize,
        white: f32,
        shared_corners: bool,
    ) -> RelativeDeviations {
        let reach = if shared_corners { 2 } else { 1 };
        let relative = |number: usize| {
            let square = normaliser(pixels, width, number, reach, white);
            deviations[number] / square.map(f32::sqrt)
        };
        RelativeDeviations {
            values: (0..pixels.len()).into_par_iter().map(relative).collect(),
            reach,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::synthetic::Noise;

    const WIDTH: usize = 64;
    const COUNT: usize = WIDTH * 48;

    /// What is said and what is true of an even picture of light 0.5, whose noise has the variance `variance`
    /// in its halves; grey, or in each channel its own.
    fn said_and_true(noise: &mut Noise, variance: f32, grey: bool) -> (ErrorEstimate, f64) {
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
        let picture: Vec<Vec3> = both().map(|(a, b)| 0.5 * (a + b)).collect();
        let deviations: Vec<Vec3> = both().map(|(a, b)| 0.5 * (a - b)).collect();
        let relative = RelativeDeviations::new(&picture, &deviations, WIDTH, 1.0, false);
        let error = |(number, x): (usize, &Vec3)| {
            let square = normaliser(&picture, WIDTH, number, 1, 1.0);
            ((x - 0.5).powf(2.0) / square).element_sum()
        };
        let sum: f32 = picture.iter().enumerate().map(error).sum();
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
                .map(|_| said_and_true(&mut noise, variance, grey))
                .collect();
            let mean = runs
                .iter()
                .map(|(said, _)| said.relative_square_error)
                .sum::<f64>()
                / 100.0;
            // The variance of the mean of two halves, over the square of the light and of a tenth of white.
            let expected = f64::from(variance) / 2.0 / 0.26;
            assert!((mean / expected - 1.0).abs() < 0.01, "{mean} {expected}");
            let z = runs.iter().map(|(said, is)| {
                let off = (said.relative_square_error - is) / said.standard_error;
                off * off
            });
            let mean_square = z.sum::<f64>() / 100.0;
            // Without grey, the fourth power overestimates the variance: see above.
            let least = if grey { 0.6 } else { 0.4 };
            assert!((least..1.4).contains(&mean_square), "{grey} {mean_square}");
        }
    }

    #[test]
    fn no_noise_is_no_error() {
        let picture = vec![Vec3::ONE; 12];
        let none = vec![Vec3::ZERO; 12];
        let relative = RelativeDeviations::new(&picture, &none, 4, 1.0, true);
        assert_eq!(ErrorEstimate::of(&relative).interval(), [0.0, 0.0]);
    }
}
