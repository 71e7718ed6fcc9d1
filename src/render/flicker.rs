use super::{Reprojection, reprojection};
use crate::film::Film;
use crate::metrics::RADIANCE_FLOOR;

const TILE: usize = reprojection::TILE as usize;

/// How much a picture's noise moves against the scene from one frame to the next.
///
/// The residual R of a sequence is what a frame shows of a point more than the frame before it showed. Not
/// all of it is noise: mirrors and highlights move on their own, and interpolation softens the frame before.
/// But that is the same in the picture x and in unbiased references a and b of it, and cancels in Rx - Ra. Of
/// the mean of its square there would still be the noise of the reference; since that of a and b is
/// independent, the product (Rx - Ra)(Rx - Rb) is on average the square of the picture's part alone.
///
/// Noise that is new in each frame, of a relative variance v that neighbours share, gives v (1 + w), where w,
/// 1/4..1, is the mean of the sum of the squared weights of interpolation. Noise that sticks to surfaces gives
/// next to none, and noise that sticks to the film none while the camera stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flicker {
    /// The root of `square`; 0 where chance makes that negative.
    pub relative: f64,
    /// The mean of (Rx - Ra)(Rx - Rb) / (r^2 + (white / 10)^2) over the channels of all matches, where r is
    /// what the references show in the later frame on average; 0 if there is no match.
    pub square: f64,
    /// Of `square`, by chance in the pixels of the picture and the references. Worth little below some
    /// hundred matches, and 0 if there is none.
    pub standard_error: f64,
    /// The share of the pixels that is matched, 0..1.
    pub matched: f64,
}

impl Reprojection {
    /// The flicker of a picture, given two references that are right on average and independent of it and of
    /// each other. All are the earlier and the later frame, in linear light, of the reprojection's size;
    /// `white`, above 0, is what is shown as white.
    ///
    /// The references may be noisy: that only makes the result less certain. But r has part of their noise:
    /// if its variance is v of what their square is divided by, the square comes out wrong by about v of
    /// itself, and by v^2.
    pub fn flicker(
        &self,
        picture: [&Film; 2],
        reference_a: [&Film; 2],
        reference_b: [&Film; 2],
        white: f32,
    ) -> Flicker {
        let residuals = [picture, reference_a, reference_b].map(|films| self.residual(films));
        let dark = f64::from(RADIANCE_FLOOR * white).powi(2);
        let later = [reference_a[1], reference_b[1]];
        let product = |i: usize| {
            let [x, a, b] = residuals.each_ref().map(|of| of[i].as_dvec3());
            let [of_a, of_b] = later.map(|film| film.pixels()[self.matches()[i].pixel]);
            let r = 0.5 * (of_a.as_dvec3() + of_b.as_dvec3());
            ((x - a) * (x - b) / (r * r + dark)).element_sum() / 3.0
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
    /// Neighbours may have samples in common, and so may the places that they are interpolated at; quarters of
    /// tiles have little in common. What chance does to them is told by the difference between those on the
    /// one diagonal and those on the other: what changes evenly over the tile is no part of that, and what
    /// is different elsewhere in the picture is none, either.
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
