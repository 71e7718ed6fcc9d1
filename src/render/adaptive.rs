//! Adaptive sampling: how many samples the points of a frame get (Neyman 1934, "On the Two Different Aspects of the
//! Representative Method").

use crate::metrics::{invert_decreasing, local_mean, normaliser};
use glam::Vec3;
use rayon::prelude::*;

/// Lower bound of a point's variance, as a fraction of the mean variance: a few samples may all have missed what makes
/// a region noisy, and its error would stay however many samples other points get.
const MIN_RELATIVE_VARIANCE: f32 = 0.1;

/// The relative numbers of passes at the points of a frame.
///
/// The mean square error of a frame is least for its cost if the number of samples is proportional to their standard
/// deviation. A point's variance is estimated from its neighbours' first passes alone: the number of a point's samples
/// does not depend on their values, so every mean stays unbiased.
pub(super) struct SampleAllocation {
    /// The variance of one pass at each point, relative to the square of the radiance.
    variances: Vec<f32>,
}

impl SampleAllocation {
    /// For points in rows of `width`, from the mean and half the difference of the A/B half buffers after one pass.
    pub(super) fn new(
        values: &[Vec3],
        half_differences: &[Vec3],
        width: usize,
        display_white: f32,
    ) -> SampleAllocation {
        let squares: Vec<Vec3> = half_differences.iter().map(|d| d * d).collect();
        let around = |index: usize| {
            let rings = [1, 2].map(|spacing| local_mean(&squares, width, index, spacing));
            let rings = rings.into_iter().flatten();
            let (sum, count) = rings.fold((Vec3::ZERO, 0), |(sum, n), ring| (sum + ring, n + 1));
            // A frame of one point has no neighbours.
            let square = if count == 0 {
                squares[index]
            } else {
                sum / count as f32
            };
            // The normaliser of the point excludes the point's own value; the neighbours' normalisers include it.
            let relative = square / normaliser(values, width, index, 1, display_white);
            relative.element_sum() / 3.0
        };
        let mut variances: Vec<f32> = (0..squares.len()).into_par_iter().map(around).collect();
        let mean = variances.iter().map(|v| f64::from(*v)).sum::<f64>() / variances.len() as f64;
        for variance in &mut variances {
            *variance = variance.max(MIN_RELATIVE_VARIANCE * mean as f32);
        }
        SampleAllocation { variances }
    }

    /// The passes at each point that reduce the frame's square error to `fraction`, in 0..1, of that after `taken`
    /// passes, if it falls as 1 / n. No point gets fewer than it has taken, nor more than `most`.
    pub(super) fn passes(&self, taken: &[u32], fraction: f64, most: u32) -> Vec<u32> {
        let passes = |index: usize, scale: f64| {
            let wanted = (scale * f64::from(self.variances[index].sqrt())).round();
            (wanted.min(f64::from(most)) as u32).max(taken[index])
        };
        let points = 0..taken.len();
        let error = |scale: f64| -> f64 {
            let variances = points.clone().zip(&self.variances);
            let errors = variances.map(|(i, v)| f64::from(*v) / f64::from(passes(i, scale)));
            errors.sum()
        };
        let goal = fraction * error(0.0);
        // The squares of very bright radiance overflow: nothing can be planned.
        if !goal.is_finite() {
            return taken.to_vec();
        }
        let deviations: f64 = self.variances.iter().map(|v| f64::from(v.sqrt())).sum();
        // Sufficient if no number were rounded and no point had more passes already.
        let enough = 2.0 * deviations / goal.max(f64::MIN_POSITIVE);
        let scale = invert_decreasing(goal, enough, 32, error);
        points.clone().map(|index| passes(index, scale)).collect()
    }
}
