//! Flicker, or temporal noise: how the error at a point of the scene changes from one frame to the next.

use super::{Reprojection, reprojection};
use crate::film::Film;
use crate::metrics::{RADIANCE_FLOOR, channel_mean};

const TILE: usize = reprojection::TILE as usize;

/// How much an image's noise changes, at the same points of the scene, from one frame to the next.
///
/// The residual R of a sequence is the radiance of a frame less that of the same points in the frame before. Not
/// all of it is noise: mirrors and highlights move on their own, and interpolation blurs the frame before.
/// But that is the same in the image x and in unbiased references a and b of it, and cancels in Rx - Ra. The mean of
/// its square would still include the noise of the reference; since the noise of a and b is
/// independent, the product (Rx - Ra)(Rx - Rb) is on average the square of the image's part alone.
///
/// Noise that is new in each frame, of a relative variance v that neighbours share, gives v (1 + w), where w,
/// 1/4..1, is the mean of the sum of the squared weights of interpolation. Noise that is fixed to surfaces gives
/// next to none, and noise that is fixed to the film none while the camera stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flicker {
    /// The root of `square`; 0 where noise makes that negative.
    pub relative: f64,
    /// The mean of (Rx - Ra)(Rx - Rb) / (r^2 + (display white / 10)^2) over the channels of all matches, where r is
    /// the mean of the references in the later frame; 0 if there is no match.
    pub square: f64,
    /// The standard error of `square`, by noise of the image and of the references. Unreliable below some hundred
    /// matches, and 0 if there is none.
    pub standard_error: f64,
    /// The fraction of the pixels that is matched, 0..1.
    pub matched: f64,
}

impl Reprojection {
    /// The flicker of an image, given two unbiased references that are independent of it and of
    /// each other. All are the earlier and the later frame, linear, of the reprojection's size;
    /// `display_white` is above 0.
    ///
    /// Noise of the references only increases the standard error. But r has part of their noise:
    /// if its variance is a fraction v of the normaliser, the square has a relative bias of about v, and v^2.
    pub fn flicker(
        &self,
        image: [&Film; 2],
        reference_a: [&Film; 2],
        reference_b: [&Film; 2],
        display_white: f32,
    ) -> Flicker {
        let residuals = [image, reference_a, reference_b].map(|films| self.residual(films));
        let floor = f64::from(RADIANCE_FLOOR * display_white).powi(2);
        let later = [reference_a[1], reference_b[1]];
        let product = |i: usize| {
            let [x, a, b] = residuals.each_ref().map(|of| of[i].as_dvec3());
            let [of_a, of_b] = later.map(|film| film.pixels()[self.matches()[i].pixel]);
            let r = 0.5 * (of_a.as_dvec3() + of_b.as_dvec3());
            channel_mean((x - a) * (x - b) / (r * r + floor))
        };
        let products: Vec<f64> = (0..self.matches().len()).map(product).collect();
        let count = products.len().max(1) as f64;
        let square = products.iter().sum::<f64>() / count;
        Flicker {
            relative: square.max(0.0).sqrt(),
            square,
            standard_error: self.error_of_sum(&products, square) / count,
            matched: self.matched(),
        }
    }

    /// The standard error of a sum over the matches, given their mean.
    ///
    /// Neighbouring pixels may share samples, and so may the pixels that they are interpolated from; quarters of tiles
    /// share little. The noise is estimated from the difference between the two quarters on one diagonal of a tile and
    /// the two on the other: linear changes over the tile cancel, and changes across the image do not matter.
    fn error_of_sum(&self, values: &[f64], mean: f64) -> f64 {
        let width = self.width() as usize;
        let tiles_per_row = width.div_ceil(TILE);
        let tiles = tiles_per_row * (self.height() as usize).div_ceil(TILE);
        let mut differences = vec![0.0; tiles];
        for (of, value) in self.matches().iter().zip(values) {
            let (x, y) = (of.pixel % width, of.pixel / width);
            let is_on_diagonal = (x % TILE < TILE / 2) == (y % TILE < TILE / 2);
            let sign = if is_on_diagonal { 1.0 } else { -1.0 };
            differences[y / TILE * tiles_per_row + x / TILE] += sign * (value - mean);
        }
        differences.iter().map(|d| d * d).sum::<f64>().sqrt()
    }
}
