//! The picture of a frame, its half buffers, and what errors of it are relative to.

use super::block::Block;
use crate::film::Film;
use crate::metrics::{RADIANCE_FLOOR, local_mean, neighbours};
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

    /// The inverse of a pixel's [`normaliser`](crate::metrics::normaliser) in the converged picture, and its standard
    /// deviation where half buffers do not correct it.
    ///
    /// Noise of the mean around the pixel makes the inverse too large on average, which is corrected in first order (the
    /// jackknife, Quenouille 1956): by half buffers or, without, by what is expected of a pixel of `count` samples.
    pub(super) fn inverse_normaliser(&self, pixel: usize, count: u32) -> [DVec3; 2] {
        let mean = self.around(&self.film, pixel);
        let plain = self.inverse(mean.as_dvec3());
        let deviation = match &self.half_difference {
            Some(half_difference) => self.around(half_difference, pixel),
            None => self.deviation_around(pixel, mean, count),
        };
        if deviation == Vec3::ZERO {
            return [plain, DVec3::ZERO];
        }
        let both = [mean + deviation, mean - deviation];
        let [a, b] = both.map(|mean| self.inverse(mean.as_dvec3()));
        let corrected = 2.0 * plain - 0.5 * (a + b);
        let deviation = match self.half_difference {
            Some(_) => DVec3::ZERO,
            None => 0.5 * (a - b).abs(),
        };
        [corrected.max(0.5 * plain), deviation]
    }

    /// The mean around a pixel of a film.
    fn around(&self, film: &Film, pixel: usize) -> Vec3 {
        let mean = local_mean(film.pixels(), self.width(), pixel, self.spacing);
        mean.unwrap_or(film.pixels()[pixel])
    }

    /// How far the `mean` around a pixel is expected to be from that of the converged picture.
    ///
    /// Where an edge passes, three of eight neighbours are random by it, with a variance of 1/6 on average, where the
    /// others are 0 or 1: about a quarter of the variance between all. It falls at least as the number of their samples.
    fn deviation_around(&self, pixel: usize, mean: Vec3, count: u32) -> Vec3 {
        const RANDOM_PART: f32 = 0.25;
        let neighbours = neighbours(self.film.pixels(), self.width(), pixel, self.spacing);
        let (squares, neighbours) = neighbours
            .fold((Vec3::ZERO, 0.0_f32), |(sum, number), value| {
                (sum + (value - mean) * (value - mean), number + 1.0)
            });
        let variance = RANDOM_PART * squares / (neighbours * neighbours).max(1.0);
        (variance / count as f32).map(f32::sqrt)
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
