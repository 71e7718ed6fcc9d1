//! The error of a picture by the differences of its half buffers: of all that is random from sample to sample.

use super::block::Block;
use super::error_estimate::ErrorEstimate;
use super::picture::{Picture, mean_of};
use crate::film::Film;
use glam::Vec3;
use rayon::prelude::*;

/// Half the difference of the half buffers at each pixel, relative to the radiance.
pub(super) struct HalfBufferError<'a> {
    picture: &'a Picture,
    half_difference: &'a Film,
    relative: Vec<Vec3>,
}

impl<'a> HalfBufferError<'a> {
    /// None of a picture without half buffers.
    pub(super) fn of(picture: &'a Picture) -> Option<HalfBufferError<'a>> {
        let half_difference = picture.half_difference.as_ref()?;
        let differences = half_difference.pixels().par_iter().enumerate();
        let relative = differences.map(|(pixel, difference)| {
            // Of a single sample, or where no error shows.
            if *difference == Vec3::ZERO {
                return Vec3::ZERO;
            }
            let [inverse, _] = picture.inverse_normaliser(pixel, 1);
            let root = inverse.map(f64::sqrt);
            (difference.as_dvec3() * root).as_vec3()
        });
        Some(HalfBufferError {
            picture,
            half_difference,
            relative: relative.collect(),
        })
    }

    /// The estimated relative squared error of a pixel.
    pub(super) fn square(&self, pixel: usize) -> f64 {
        f64::from(self.relative[pixel].length_squared()) / 3.0
    }

    /// The error of the picture, whose pixels share no noise.
    ///
    /// With half buffers r + a and r + b the error of the picture is (a + b) / 2, and half their difference is
    /// (a - b) / 2: the squares have the same expectation, and differ by a b. The variance of the sum of a b over the
    /// channels is the sum of the squares of the covariance matrix of a, of which a pixel and its neighbour give two
    /// independent estimates. That underestimates where errors vary from pixel to pixel, as they do at edges. The fourth
    /// power of a pixel's own difference is three times the square of its variance if noise is normal, and more where
    /// noise has outliers. The mean of both is taken.
    pub(super) fn estimate(&self) -> ErrorEstimate {
        let values = &self.relative;
        let count = values.len() as f64;
        let squares: f64 = values.iter().map(|d| f64::from(d.length_squared())).sum();
        let neighbours = values.iter().zip(values.iter().cycle().skip(1));
        let products: f64 = neighbours.map(|(d, e)| f64::from(d.dot(*e)).powi(2)).sum();
        let fourths = values.iter().map(|d| f64::from(d.length_squared()).powi(2));
        let thirds = fourths.sum::<f64>() / 3.0;
        let covariances = 0.5 * (products + thirds);
        ErrorEstimate {
            rel_mse: squares / count / 3.0,
            standard_error: (4.0 * covariances).sqrt() / count / 3.0,
        }
    }

    /// The relMSE after each block is replaced by its mean.
    pub(super) fn blurred(&self) -> f64 {
        let (width, height) = (self.picture.width(), self.picture.height());
        let squares = Block::all(width, height).map(|block| {
            let error = mean_of(self.half_difference, &block);
            let square = error * error * self.picture.inverse_normaliser_of(&block);
            block.len() as f64 * square.element_sum() / 3.0
        });
        squares.sum::<f64>() / (width * height) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::normaliser;
    use crate::metrics::synthetic::Noise;

    const WIDTH: usize = 64;
    const COUNT: usize = WIDTH * 48;

    /// The estimated and the true error of a picture of constant radiance 0.5, whose half buffers have noise of this
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
        let film = |pixels: Vec<Vec3>| Film::from_pixels(WIDTH as u32, 48, pixels);
        let both = || a.iter().zip(&b);
        let picture = Picture {
            film: film(both().map(|(a, b)| 0.5 * (a + b)).collect()),
            half_difference: Some(film(both().map(|(a, b)| 0.5 * (a - b)).collect())),
            spacing: 1,
            display_white: 1.0,
        };
        let truth = vec![Vec3::splat(0.5); COUNT];
        let error = |(index, x): (usize, &Vec3)| {
            let square = normaliser(&truth, WIDTH, index, 1, 1.0);
            ((x - 0.5).powf(2.0) / square).element_sum()
        };
        let sum: f32 = picture.film.pixels().iter().enumerate().map(error).sum();
        let estimate = HalfBufferError::of(&picture)
            .expect("half buffers")
            .estimate();
        (estimate, f64::from(sum) / COUNT as f64 / 3.0)
    }

    #[test]
    fn noise_of_known_variance() {
        let mut noise = Noise::new(1);
        // The larger one makes the inverse normaliser 5 % too large, but for its correction, which is of first order.
        for (variance, grey, most) in [
            (0.0016, true, 0.01),
            (0.0016, false, 0.01),
            (0.09, true, 0.03),
        ] {
            let runs: Vec<_> = (0..100)
                .map(|_| estimated_and_true(&mut noise, variance, grey))
                .collect();
            let mean =
                |of: fn(&(ErrorEstimate, f64)) -> f64| runs.iter().map(of).sum::<f64>() / 100.0;
            let estimated = mean(|(estimated, _)| estimated.rel_mse);
            // The variance of the mean of two half buffers, over the squares of the radiance and of a tenth of white.
            let expected = f64::from(variance) / 2.0 / 0.26;
            assert!(
                (estimated / expected - 1.0).abs() < most,
                "{estimated} {expected}"
            );
            let z = runs.iter().map(|(estimated, error)| {
                let off = (estimated.rel_mse - error) / estimated.standard_error;
                off * off
            });
            let mean_square = z.sum::<f64>() / 100.0;
            // The fourth power overestimates the variance of independent channels; what the jackknife leaves of a bias
            // comes to the larger noise.
            let least = if grey { 0.6 } else { 0.4 };
            assert!((least..1.7).contains(&mean_square), "{grey} {mean_square}");
        }
    }
}
