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

/// The most times that a pass doubles the samples of a pixel: an estimate from few samples may be far off.
const MOST_DOUBLINGS: u32 = 2;

/// Rows of pixels that are surveyed one after the other.
const STRIP: usize = 16;

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
}

impl Survey {
    /// Of the samples of pixels in rows of `width`. `is_noisy` says that there is Monte Carlo noise.
    pub(super) fn new(
        samples: &SampleAccumulator,
        width: usize,
        display_white: f32,
        is_noisy: bool,
    ) -> Survey {
        let quadrants = &samples.quadrants;
        let floor = (RADIANCE_FLOOR * display_white).powi(2);
        let mut variances = vec![0.0; quadrants.len()];
        let strips = variances.par_chunks_mut(STRIP * width).enumerate();
        strips.for_each(|(strip, variances)| {
            let mut filled = FilledRows::new(quadrants, width, strip * STRIP);
            for variances in variances.chunks_exact_mut(width) {
                for (column, value) in variances.iter_mut().enumerate() {
                    let [variance, square_of_mean] = filled.variance_around(column);
                    *value = variance / (square_of_mean + floor);
                }
                filled.advance();
            }
        });
        let sum: f64 = variances.iter().map(|&variance| f64::from(variance)).sum();
        let least = MIN_RELATIVE_VARIANCE * (sum / variances.len() as f64) as f32;
        variances.par_iter_mut().for_each(|v| *v = v.max(least));
        Survey {
            variances,
            convergence: if is_noisy { 1 } else { 2 },
        }
    }

    /// The expected relative squared error of each pixel that has so many samples; up to a factor. Those around a pixel do
    /// not know that it hit something small: its own contrast to them tells.
    pub(super) fn expected_errors(&self, counts: &[u32], contrasts: &[f32]) -> Vec<f32> {
        let pixels = self.variances.par_iter().zip(contrasts).zip(counts);
        let errors = pixels.map(|((variance, contrast), &count)| {
            self.expected_error_of(variance.max(*contrast), count)
        });
        errors.collect()
    }

    fn expected_error_of(&self, variance: f32, count: u32) -> f32 {
        variance / (count as f32).powi(self.convergence)
    }

    /// How many samples each pixel shall have in the next pass, with the goal that `fraction`, in 0..1, of the expected
    /// error is left, and no more than `most`; none if none needs more.
    ///
    /// For a given cost the error is least where the gains of all samples are equal. Samples of a pixel double while what
    /// each of them gains is above a threshold. It is where one pass is enough, if it can be, and else where all would be
    /// after as many passes as each of them needs.
    pub(super) fn next_counts(&self, counts: &[u32], fraction: f64, most: u32) -> Option<Vec<u32>> {
        /// Bins of gains, by exponent and the first three bits of the fraction.
        const BINS: usize = 1 << 11;
        const SHIFT: u32 = 20;
        const CHUNK: usize = 1 << 16;
        // What of an error a doubling leaves, and what of a gain.
        let left = 0.5_f32.powi(self.convergence);
        let left_of_gain = 0.5 * left;
        let gain = |variance: f32, count: u32| {
            (1.0 - left) * self.expected_error_of(variance, count) / count as f32
        };
        let chunks = self
            .variances
            .par_chunks(CHUNK)
            .zip(counts.par_chunks(CHUNK));
        let chunks = chunks.map(|(variances, counts)| {
            // The error of pixels whose first doubling gains so much, and what all doublings take away.
            let mut bins = vec![[0.0; 2]; BINS];
            let bin = |gain: f32| (gain.to_bits() >> SHIFT) as usize % BINS;
            for (&variance, &count) in variances.iter().zip(counts) {
                let mut error = self.expected_error_of(variance, count);
                let mut gain = gain(variance, count);
                bins[bin(gain)][0] += f64::from(error);
                for _ in 0..MOST_DOUBLINGS {
                    bins[bin(gain)][1] += f64::from((1.0 - left) * error);
                    error *= left;
                    gain *= left_of_gain;
                }
            }
            bins
        });
        let chunks: Vec<Vec<[f64; 2]>> = chunks.collect();
        let sum = |bin: usize, of: usize| chunks.iter().map(|bins| bins[bin][of]).sum::<f64>();
        let all: f64 = (0..BINS).map(|bin| sum(bin, 0)).sum();
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
            let [error, taken] = [0, 1].map(|of| sum(bin, of));
            if taken == 0.0 {
                continue;
            }
            let gain = f32::from_bits((bin as u32) << SHIFT);
            let power = f64::from(gain).powf(exponent);
            threshold = Some(gain);
            after_one -= taken;
            below -= error;
            scaled += error / power;
            if after_one <= goal || below + scaled * power <= goal {
                break;
            }
        }
        let threshold = threshold?;
        let next = self.variances.par_iter().zip(counts);
        let next = next.map(|(&variance, &count)| {
            let mut gain = gain(variance, count);
            let mut next = count;
            for _ in 0..MOST_DOUBLINGS {
                if gain < threshold {
                    break;
                }
                next = (2 * next).min(most);
                gain *= left_of_gain;
            }
            next
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

/// Three rows of [`filled`] quadrants, around one row of pixels after the other: few enough for the processor's cache.
struct FilledRows<'a> {
    quadrants: &'a [[Moments; 4]],
    width: usize,
    /// The row in the middle.
    row: usize,
    /// By row modulo 3.
    rows: [Vec<[Vec4; 4]>; 3],
}

impl<'a> FilledRows<'a> {
    /// Around the pixels of `row`.
    fn new(quadrants: &'a [[Moments; 4]], width: usize, row: usize) -> FilledRows<'a> {
        let mut rows = FilledRows {
            quadrants,
            width,
            row,
            rows: [const { Vec::new() }; 3],
        };
        (row.saturating_sub(1)..row + 2).for_each(|row| rows.fill(row));
        rows
    }

    /// Goes on to the next row.
    fn advance(&mut self) {
        self.row += 1;
        self.fill(self.row + 1);
    }

    fn fill(&mut self, row: usize) {
        let pixels = self.quadrants.chunks_exact(self.width).nth(row);
        let filled = pixels.into_iter().flatten().map(filled);
        let place = &mut self.rows[row % 3];
        place.clear();
        place.extend(filled);
    }

    /// The variance of the samples of the ring around a pixel, and the square of their mean, both the means over
    /// channels; of the pixel itself where it has no neighbours.
    fn variance_around(&self, column: usize) -> [f32; 2] {
        let height = self.quadrants.len() / self.width;
        let (mut sum, mut count) = (Vec4::ZERO, 0.0);
        for (columns, rows, quadrant) in RING {
            let near_row = self.row.wrapping_add_signed(rows);
            let near_column = column.wrapping_add_signed(columns);
            if near_row < height && near_column < self.width {
                sum += self.rows[near_row % 3][near_column][quadrant];
                count += 1.0;
            }
        }
        if count == 0.0 {
            sum = self.rows[self.row % 3][column].iter().sum();
            count = 4.0;
        }
        let moments = sum / count;
        let square_of_mean = moments.truncate().length_squared() / 3.0;
        [(moments.w - square_of_mean).max(0.0), square_of_mean]
    }
}

/// The moments of a whole pixel.
fn of_pixel(quadrants: &[Moments; 4]) -> Moments {
    let mut whole = Moments::default();
    quadrants.iter().for_each(|quadrant| whole.add(quadrant));
    whole
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
        let rows = FilledRows::new(&picture, 7, 1);
        let variances = (0..7).map(|column| rows.variance_around(column)[0]);
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
        let [variance, square_of_mean] = FilledRows::new(&picture, 3, 1).variance_around(1);
        // Of twelve, five are bright, and two are of pixels that are half bright.
        assert!((square_of_mean - 0.25).abs() < 1e-6, "{square_of_mean}");
        assert!((variance - 0.25).abs() < 1e-6, "{variance}");
        // A pixel without neighbours.
        let [variance, square_of_mean] = FilledRows::new(&picture[1..2], 1, 0).variance_around(0);
        assert_eq!([variance, square_of_mean], [0.25; 2]);
    }
}
