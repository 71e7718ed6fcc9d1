//! Adaptive sampling: which pixels get more samples (Neyman 1934, "On the Two Different Aspects of the Representative
//! Method").

use super::accumulator::SampleAccumulator;
use super::sampler::Moments;
use crate::metrics::RADIANCE_FLOOR;
use glam::Vec4;
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
        let filled: Vec<[Vec4; 4]> = quadrants.par_iter().map(filled).collect();
        let variance = |row: usize, column: usize| {
            let [variance, square_of_mean] = variance_around(&filled, width, row, column);
            variance / (square_of_mean + floor)
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

/// The quadrants around a pixel that face it: columns and rows to their pixel, and which quadrant of that it is.
const RING: [(isize, isize, usize); 12] = [
    (-1, -1, 3),
    (0, -1, 2),
    (0, -1, 3),
    (1, -1, 2),
    (-1, 0, 1),
    (-1, 0, 3),
    (1, 0, 0),
    (1, 0, 2),
    (-1, 1, 1),
    (0, 1, 0),
    (0, 1, 1),
    (1, 1, 0),
];

/// The mean radiance and square of each quadrant of a pixel; of the whole pixel in quadrants without samples.
fn filled(quadrants: &[Moments; 4]) -> [Vec4; 4] {
    let values = |moments: &Moments| moments.mean.extend(moments.square);
    let whole = values(&of_pixel(quadrants));
    [0, 1, 2, 3].map(|number| match quadrants[number].count {
        0 => whole,
        _ => values(&quadrants[number]),
    })
}

/// The variance of the samples of the ring around a pixel, and the square of their mean, both the means over channels; of
/// the pixel itself where it has no neighbours.
fn variance_around(filled: &[[Vec4; 4]], width: usize, row: usize, column: usize) -> [f32; 2] {
    let height = filled.len() / width;
    let (mut sum, mut count) = (Vec4::ZERO, 0.0);
    for (columns, rows, quadrant) in RING {
        let near_row = row.wrapping_add_signed(rows);
        let near_column = column.wrapping_add_signed(columns);
        if near_row < height && near_column < width {
            sum += filled[near_row * width + near_column][quadrant];
            count += 1.0;
        }
    }
    if count == 0.0 {
        sum = filled[row * width + column].iter().sum();
        count = 4.0;
    }
    let moments = sum / count;
    let square_of_mean = moments.truncate().length_squared() / 3.0;
    [(moments.w - square_of_mean).max(0.0), square_of_mean]
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
        let filled: Vec<[Vec4; 4]> = picture.iter().map(filled).collect();
        let variances = (0..7).map(|column| variance_around(&filled, 7, 1, column)[0]);
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
        let filled: Vec<[Vec4; 4]> = picture.iter().map(filled).collect();
        let [variance, square_of_mean] = variance_around(&filled, 3, 1, 1);
        // Of twelve, five are bright, and two are of pixels that are half bright.
        assert!((square_of_mean - 0.25).abs() < 1e-6, "{square_of_mean}");
        assert!((variance - 0.25).abs() < 1e-6, "{variance}");
        // A pixel without neighbours.
        let [variance, square_of_mean] = variance_around(&filled[1..2], 1, 0, 0);
        assert_eq!([variance, square_of_mean], [0.25; 2]);
    }
}
