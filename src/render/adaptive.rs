//! Adaptive sampling: which pixels get more samples (Neyman 1934, "On the Two Different Aspects of the Representative
//! Method").

use super::accumulator::SampleAccumulator;
use super::sampler::Moments;
use crate::metrics::RADIANCE_FLOOR;
use rayon::prelude::*;

/// Lower bound of a variance, as a fraction of the mean variance: a few samples may all have missed what makes a region
/// noisy, and its error would stay however many samples other pixels get.
const MIN_RELATIVE_VARIANCE: f32 = 1e-4;

/// What the samples of a frame say about its error.
///
/// The variance of a pixel's samples is estimated from the ring of twelve quadrants of its neighbours that face it, between
/// them as well as within: edges show between pixels first, and a quadrant tells whether an edge of its pixel comes near.
/// No pixel's values decide how many samples it has: its mean is unbiased, and its half buffers are independent.
pub(super) struct Survey {
    /// The estimated variance of one sample of each pixel, relative to the square of the radiance.
    variances: Vec<f32>,
    /// Errors fall with this power of the number of samples: 1 of noise, 2 of stratified samples of straight edges.
    convergence: i32,
    /// The expected relMSE of the frame; up to a factor.
    pub(super) expected_error: f64,
}

/// What a pixel has, and what more samples of it promise.
struct Prospect {
    /// Its expected error.
    error: f32,
    /// What is left of it with twice the samples.
    left: f32,
    /// By how much each of these samples reduces it.
    gain: f32,
}

impl Survey {
    /// Of the samples of pixels in rows of `width`, in two half buffers; the second may be empty. `is_noisy` says that
    /// there is Monte Carlo noise.
    pub(super) fn new(
        samples: &SampleAccumulator,
        width: usize,
        display_white: f32,
        is_noisy: bool,
    ) -> Survey {
        let SampleAccumulator {
            quadrants, counts, ..
        } = samples;
        let floor = (RADIANCE_FLOOR * display_white).powi(2);
        let variance = |row: usize, column: usize| {
            let Moments { mean, square, .. } = moments_around(quadrants, width, row, column);
            let square_of_mean = mean.length_squared() / 3.0;
            (square - square_of_mean).max(0.0) / (square_of_mean + floor)
        };
        let mut variances = vec![0.0; quadrants.len()];
        let rows = variances.par_chunks_exact_mut(width).enumerate();
        rows.for_each(|(row, variances)| {
            for (column, value) in variances.iter_mut().enumerate() {
                *value = variance(row, column);
            }
        });
        let least = MIN_RELATIVE_VARIANCE * mean(&variances) as f32;
        variances.par_iter_mut().for_each(|v| *v = v.max(least));
        let mut survey = Survey {
            variances,
            convergence: if is_noisy { 1 } else { 2 },
            expected_error: 0.0,
        };
        survey.expected_error = mean(&survey.expected_errors(counts));
        survey
    }

    /// The expected relative squared error of each pixel, whose half buffers have so many samples; up to a factor.
    pub(super) fn expected_errors(&self, counts: &[u32]) -> Vec<f32> {
        let pixels = (0..self.variances.len()).into_par_iter();
        pixels
            .map(|pixel| self.prospect(pixel, counts).error)
            .collect()
    }

    /// The expected error of those pixels that have a single sample; up to a factor.
    pub(super) fn error_of_singles(&self, counts: &[u32]) -> f64 {
        let singles = self.variances.iter().zip(counts.chunks_exact(2));
        let singles = singles.filter(|(_, counts)| counts[1] == 0);
        let sum: f64 = singles.map(|(variance, _)| f64::from(*variance)).sum();
        sum / self.variances.len() as f64
    }

    fn prospect(&self, pixel: usize, counts: &[u32]) -> Prospect {
        let variance = self.variances[pixel];
        match &counts[2 * pixel..][..2] {
            [_, 0] => Prospect {
                error: variance,
                left: 0.5 * variance,
                gain: 0.5 * variance,
            },
            halves => {
                let error = 0.5 * variance / (halves[0] as f32).powi(self.convergence);
                let left = error * 0.5_f32.powi(self.convergence);
                Prospect {
                    error,
                    left,
                    gain: (error - left) / (2 * halves[0]) as f32,
                }
            }
        }
    }

    /// How many samples each half buffer shall have in the next pass, with the goal that `fraction`, in 0..1, of the
    /// expected error is left, and no more than `most`; none if none needs more.
    ///
    /// For a given cost the error is least where the gains of all samples are equal. Pixels above a threshold get twice
    /// the samples. It is where one pass is enough, if it can be, and else where all would be after as many passes as
    /// each of them needs.
    pub(super) fn next_counts(&self, counts: &[u32], fraction: f64, most: u32) -> Option<Vec<u32>> {
        /// Bins of gains, by exponent and the first three bits of the fraction.
        const BINS: usize = 1 << 11;
        const SHIFT: u32 = 20;
        const CHUNK: usize = 1 << 16;
        let pixels = self.variances.len();
        let chunks = (0..pixels.div_ceil(CHUNK)).into_par_iter().map(|chunk| {
            let mut bins = vec![[0.0; 2]; BINS];
            for pixel in chunk * CHUNK..((chunk + 1) * CHUNK).min(pixels) {
                let prospect = self.prospect(pixel, counts);
                let bin = &mut bins[(prospect.gain.to_bits() >> SHIFT) as usize % BINS];
                bin[0] += f64::from(prospect.error);
                bin[1] += f64::from(prospect.left);
            }
            bins
        });
        let chunks: Vec<Vec<[f64; 2]>> = chunks.collect();
        let sum = |bin: usize, of: usize| chunks.iter().map(|bins| bins[bin][of]).sum::<f64>();
        let all = self.expected_error * pixels as f64;
        let goal = fraction * all;
        // The squares of very bright radiance overflow.
        if !goal.is_finite() || all == 0.0 {
            return None;
        }
        // Of n samples the gain is as n to the -(convergence + 1).
        let exponent = f64::from(self.convergence) / f64::from(self.convergence + 1);
        let (mut after_one, mut below, mut scaled) = (all, all, 0.0);
        let mut threshold = None;
        for bin in (1..BINS).rev() {
            let [error, left] = [0, 1].map(|of| sum(bin, of));
            if error == 0.0 {
                continue;
            }
            let gain = f32::from_bits((bin as u32) << SHIFT);
            let power = f64::from(gain).powf(exponent);
            threshold = Some(gain);
            after_one += left - error;
            below -= error;
            scaled += error / power;
            if after_one <= goal || below + scaled * power <= goal {
                break;
            }
        }
        let threshold = threshold?;
        let next = counts
            .par_chunks_exact(2)
            .enumerate()
            .flat_map_iter(|(pixel, halves)| {
                let count = match self.prospect(pixel, counts).gain < threshold {
                    true => return [halves[0], halves[1]],
                    false if halves[1] == 0 => 1,
                    false => (2 * halves[0]).min(most),
                };
                [count; 2]
            });
        let next: Vec<u32> = next.collect();
        (next != counts).then_some(next)
    }
}

/// The mean of the moments of the up to twelve quadrants around a pixel; of the pixel itself where it has no neighbours.
fn moments_around(quadrants: &[[Moments; 4]], width: usize, row: usize, column: usize) -> Moments {
    let mut around = Moments::default();
    // Each counts as one sample.
    let mut add = |moments: &Moments| {
        around.add(&Moments {
            count: 1,
            ..*moments
        })
    };
    for near_row in row.saturating_sub(1)..(row + 2).min(quadrants.len() / width) {
        for near_column in column.saturating_sub(1)..(column + 2).min(width) {
            if (near_row, near_column) == (row, column) {
                continue;
            }
            let pixel = &quadrants[near_row * width + near_column];
            for (quadrant, moments) in pixel.iter().enumerate() {
                let is_lower = quadrant / 2 == 1;
                let is_right = quadrant % 2 == 1;
                let faces = (near_row == row || is_lower == (near_row < row))
                    && (near_column == column || is_right == (near_column < column));
                match (faces, moments.count) {
                    (false, _) => {}
                    (true, 0) => add(&of_pixel(pixel)),
                    (true, _) => add(moments),
                }
            }
        }
    }
    match around.count {
        0 => of_pixel(&quadrants[row * width + column]),
        _ => around,
    }
}

/// The moments of a whole pixel.
fn of_pixel(quadrants: &[Moments; 4]) -> Moments {
    let mut whole = Moments::default();
    quadrants.iter().for_each(|quadrant| whole.add(quadrant));
    whole
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&value| f64::from(value)).sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A wall covers the left of a picture, up to `edge`: pixels of one sample in the middle of each quadrant.
    fn picture(width: usize, edge: f32) -> Vec<[Moments; 4]> {
        let quadrant = |column: usize, quadrant: usize| {
            let x = column as f32 + 0.25 + 0.5 * (quadrant % 2) as f32;
            let value = if x < edge { 0.0 } else { 1.0 };
            Moments {
                mean: Vec3::splat(value),
                square: value,
                count: 1,
            }
        };
        let pixel = |index: usize| [0, 1, 2, 3].map(|number| quadrant(index % width, number));
        (0..3 * width).map(pixel).collect()
    }

    #[test]
    fn an_edge_within_a_pixel_shows_around_that_pixel_alone() {
        let picture = picture(7, 3.5);
        let variances = (0..7).map(|column| {
            let Moments { mean, square, .. } = moments_around(&picture, 7, 1, column);
            square - mean.length_squared() / 3.0
        });
        let variances: Vec<f32> = variances.collect();
        // In column 3 the ring has 4 dark quadrants at the left, 4 bright ones at the right, and one of each kind in
        // each of the pixels above and below.
        let expected = [0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0];
        for (variance, expected) in variances.iter().zip(expected) {
            assert!((variance - expected).abs() < 1e-6, "{variances:?}");
        }
    }

    #[test]
    fn quadrants_without_samples_are_like_their_pixel() {
        let mut picture = picture(3, 1.5);
        for pixel in &mut picture {
            let whole = of_pixel(pixel);
            *pixel = Default::default();
            pixel[2] = Moments { count: 4, ..whole };
        }
        let around = moments_around(&picture, 3, 1, 1);
        // Of twelve, five are bright, and two are of pixels that are half bright.
        assert!((around.mean.x - 0.5).abs() < 1e-6, "{around:?}");
        assert!((around.square - 0.5).abs() < 1e-6, "{around:?}");
        let alone = moments_around(&picture[1..2], 1, 0, 0);
        assert_eq!(alone.mean, of_pixel(&picture[1]).mean);
    }
}
