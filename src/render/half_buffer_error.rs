//! The error of a picture by the differences of its half buffers: of all that is random from sample to sample.

use super::block::Block;
use super::error_estimate::ErrorEstimate;
use super::picture::{Picture, mean_of};
use crate::film::Film;
use glam::{DVec3, Vec3};
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
            let root = DVec3::from(picture.inverse_normaliser(pixel).to_array().map(f64::sqrt));
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

    /// The error of the picture.
    ///
    /// With half buffers r + a and r + b the error of the picture is (a + b) / 2, and half their difference is
    /// (a - b) / 2: the squares have the same expectation, and differ by a b. The variance of the sum of a b over the
    /// channels is the sum of the squares of the covariance matrix of a, of which a pixel and its neighbour give two
    /// independent estimates. That underestimates where errors vary from pixel to pixel, as they do at edges. The fourth
    /// power of a pixel's own difference is three times the square of its variance if noise is normal, and more where
    /// noise has outliers. Of noise the mean of both is taken, of edges the larger one.
    pub(super) fn estimate(&self) -> ErrorEstimate {
        let Picture {
            spacing, is_noisy, ..
        } = *self.picture;
        let values = &self.relative;
        let count = values.len() as f64;
        let squares: f64 = values.iter().map(|d| f64::from(d.length_squared())).sum();
        let neighbours = values.iter().zip(values.iter().cycle().skip(spacing));
        let products: f64 = neighbours.map(|(d, e)| f64::from(d.dot(*e)).powi(2)).sum();
        let fourths = values.iter().map(|d| f64::from(d.length_squared()).powi(2));
        let thirds = fourths.sum::<f64>() / 3.0;
        let covariances = if is_noisy {
            0.5 * (products + thirds)
        } else {
            products.max(thirds)
        };
        // Pixels that share corner samples share noise: the correlation with the four adjacent pixels is 1/2, with
        // the four diagonal ones 1/4. The variance grows by the sum of the squares, 1 + 4/4 + 4/16.
        let shared = if spacing == 1 { 1.0 } else { 2.25 };
        ErrorEstimate {
            rel_mse: squares / count / 3.0,
            standard_error: (4.0 * shared * covariances).sqrt() / count / 3.0,
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
