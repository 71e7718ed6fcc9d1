//! The picture of a frame, its half buffers, and what errors of it are relative to.

use super::block::Block;
use crate::film::Film;
use crate::metrics::{RADIANCE_FLOOR, local_mean};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A picture, as far as it is sampled.
#[derive(Debug)]
pub(super) struct Picture {
    pub(super) film: Film,
    /// Half the difference of its half buffers, if it has any.
    pub(super) half_difference: Option<Film>,
    /// The distance to the nearest pixels in a row that share no noise.
    pub(super) spacing: usize,
    /// Whether it has Monte Carlo noise.
    pub(super) is_noisy: bool,
    /// The radiance that is displayed as white.
    pub(super) display_white: f32,
}

impl Picture {
    pub(super) fn width(&self) -> usize {
        self.film.width() as usize
    }

    pub(super) fn height(&self) -> usize {
        self.film.height() as usize
    }

    /// The value of a pixel.
    pub(super) fn value(&self, pixel: usize) -> DVec3 {
        self.film.pixels()[pixel].as_dvec3()
    }

    /// The inverse of a pixel's [`normaliser`](crate::metrics::normaliser) in the converged picture.
    ///
    /// Noise of the mean around the pixel makes the inverse too large on average; half buffers correct it in first order
    /// (the jackknife, Quenouille 1956).
    pub(super) fn inverse_normaliser(&self, pixel: usize) -> DVec3 {
        let around = |film: &Film| {
            let (pixels, width) = (film.pixels(), film.width() as usize);
            let mean = local_mean(pixels, width, pixel, self.spacing);
            mean.unwrap_or(pixels[pixel])
        };
        let mean = around(&self.film);
        let plain = self.inverse(mean.as_dvec3());
        self.half_difference.as_ref().map_or(plain, |film| {
            let difference = around(film);
            if difference == Vec3::ZERO {
                return plain;
            }
            let halves = [mean + difference, mean - difference];
            let [a, b] = halves.map(|mean| self.inverse(mean.as_dvec3()));
            (2.0 * plain - 0.5 * (a + b)).max(0.5 * plain)
        })
    }

    /// The same of a block's mean.
    pub(super) fn inverse_normaliser_of(&self, block: &Block) -> DVec3 {
        self.inverse(mean_of(&self.film, block))
    }

    fn inverse(&self, mean: DVec3) -> DVec3 {
        let floor = f64::from(RADIANCE_FLOOR * self.display_white);
        (mean * mean + floor * floor).recip()
    }

    /// The expected relative squared error of each pixel, up to a factor, if it has no more samples than its neighbours:
    /// by the contrast to those beside it, above and below.
    pub(super) fn contrasts(&self) -> Vec<f32> {
        let width = self.width();
        let floor = (RADIANCE_FLOOR * self.display_white).powi(2);
        let rows: Vec<&[Vec3]> = self.film.pixels().chunks_exact(width).collect();
        let contrast = |row: usize, column: usize| {
            let pixel = rows[row][column];
            let neighbours = [
                rows[row.saturating_sub(1)][column],
                rows[row][column.saturating_sub(1)],
                rows[row][(column + 1).min(width - 1)],
                rows[(row + 1).min(rows.len() - 1)][column],
            ];
            let squares = neighbours.map(|other| other.distance_squared(pixel));
            let mean = 0.25 * neighbours.into_iter().sum::<Vec3>();
            0.25 * squares.into_iter().sum::<f32>() / (mean.length_squared() / 3.0 + floor)
        };
        let mut contrasts = vec![0.0; self.film.pixels().len()];
        let rows = contrasts.par_chunks_exact_mut(width).enumerate();
        rows.for_each(|(row, contrasts)| {
            for (column, value) in contrasts.iter_mut().enumerate() {
                *value = contrast(row, column);
            }
        });
        contrasts
    }
}

/// The mean over a block of a film.
pub(super) fn mean_of(film: &Film, block: &Block) -> DVec3 {
    let pixels = block.pixels().map(|pixel| film.pixels()[pixel].as_dvec3());
    pixels.sum::<DVec3>() / block.len() as f64
}
