use crate::metrics::{falls_to, mean_around, normaliser};
use glam::Vec3;
use rayon::prelude::*;

/// No variance is believed to be less than this share of the mean: few samples may all have missed what makes a
/// place noisy, and there the error would stay, however many samples the others took.
const LEAST_VARIANCE: f32 = 0.1;

/// How many passes the points of a frame should take, in proportion to each other.
///
/// The mean square error of a frame is least for its cost if samples are in proportion to the square root
/// of their variance (Neyman 1934, "On the Two Different Aspects of the Representative Method"). What a
/// point needs is told by its neighbours' first passes alone: no point's number of samples depends on what
/// these samples are, so every mean stays unbiased.
pub(super) struct SampleAllocation {
    /// The variance of one pass at each point, in proportion to the square of the light.
    variances: Vec<f32>,
}

impl SampleAllocation {
    /// For points in rows of `width`, by the values and half the differences of the halves of one pass each.
    pub(super) fn new(
        values: &[Vec3],
        deviations: &[Vec3],
        width: usize,
        white: f32,
    ) -> SampleAllocation {
        let squares: Vec<Vec3> = deviations.iter().map(|d| d * d).collect();
        let around = |number: usize| {
            let rings = [1, 2].map(|reach| mean_around(&squares, width, number, reach));
            let rings = rings.into_iter().flatten();
            let (sum, count) = rings.fold((Vec3::ZERO, 0), |(sum, n), ring| (sum + ring, n + 1));
            // A frame of one point knows nothing else.
            let square = if count == 0 {
                squares[number]
            } else {
                sum / count as f32
            };
            // The light around the point, too, is the neighbours' alone: had theirs been used, it would hold
            // the point's own value.
            let relative = square / normaliser(values, width, number, 1, white);
            relative.element_sum() / 3.0
        };
        let mut variances: Vec<f32> = (0..squares.len()).into_par_iter().map(around).collect();
        let mean = variances.iter().map(|v| f64::from(*v)).sum::<f64>() / variances.len() as f64;
        for variance in &mut variances {
            *variance = variance.max(LEAST_VARIANCE * mean as f32);
        }
        SampleAllocation { variances }
    }

    /// The passes of each point by which the frame's square error comes down to `share`, of 0 to 1, of what
    /// it is after `taken` passes, if it falls as 1 / n. No point takes fewer than it has taken, nor more than
    /// `most`.
    pub(super) fn passes(&self, taken: &[u32], share: f64, most: u32) -> Vec<u32> {
        let passes = |number: usize, scale: f64| {
            let wanted = (scale * f64::from(self.variances[number].sqrt())).round();
            (wanted.min(f64::from(most)) as u32).max(taken[number])
        };
        let points = 0..taken.len();
        let error = |scale: f64| -> f64 {
            let variances = points.clone().zip(&self.variances);
            let errors = variances.map(|(i, v)| f64::from(*v) / f64::from(passes(i, scale)));
            errors.sum()
        };
        let goal = share * error(0.0);
        // Light beyond the squares of single precision: nothing can be planned.
        if !goal.is_finite() {
            return taken.to_vec();
        }
        let deviations: f64 = self.variances.iter().map(|v| f64::from(v.sqrt())).sum();
        // Without rounding, and without those that have taken more already, this scale would do.
        let enough = 2.0 * deviations / goal.max(f64::MIN_POSITIVE);
        let scale = falls_to(goal, enough, 32, error);
        points.clone().map(|number| passes(number, scale)).collect()
    }
}
