//! The error of a picture against the converged one, from held-out pixels.
//!
//! Two independent estimates A and B of a held-out pixel make (c - A)(c - B) an unbiased estimate of the squared error of
//! its value c, whatever that comes from: edges, textures, highlights, mirrors or noise. Pixels are held out with known
//! probabilities, high where error is likely, and each counts by the inverse of its own (Hansen and Hurwitz 1943, "On
//! the Theory of Sampling from Finite Populations"; systematically, Madow 1949).
//!
//! Where half buffers know all but what filters of textures change on average, that alone is estimated, from two
//! independent sets of samples that are shaded both unfiltered and filtered: the product of the differences is the
//! square of the change, without the noise of edges.

use super::block::Block;
use super::error_estimate::{ErrorEstimate, FrameErrorEstimate};
use super::half_buffer_error::HalfBufferError;
use super::picture::Picture;
use super::sampler::{QuadrantSums, SampleRun, Sampler, Sequence, Work};
use crate::metrics::{Estimate, mean};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// How many blocks are looked at for the worst, ...
const WORST_BLOCKS: usize = 2;

/// ... and the least number of samples of each estimate of their pixels: the largest of noisy errors is too large.
const LEAST_SAMPLES_OF_WORST: u32 = 4;

/// The least number of samples of each estimate of what filters of textures change: the product of the noise of two is
/// larger than the square of the change where they are few.
const LEAST_SAMPLES_OF_FILTER: u32 = 8;

/// The part of a picture's samples that held-out pixels take beside, ...
const FRACTION: f64 = 0.012;

/// ... and the least number of theirs.
const LEAST_SAMPLES: f64 = 2048.0;

/// The part of the held-out pixels that is taken from all with equal probabilities: error may be where none is expected.
const EQUAL_PART: f64 = 0.2;

/// Pixels that are sampled together.
const CHUNK: usize = 32;

/// Estimates the error of a picture, by what is known of it.
pub(super) struct ErrorEstimator<'a> {
    pub(super) picture: &'a Picture,
    /// The expected squared error of each pixel, relative to the square of the radiance; up to a factor.
    pub(super) expected_errors: Vec<f32>,
    pub(super) samples: PixelSamples<'a>,
    /// Whether samples lie at fixed places, so that their mean differs from that of the whole pixel.
    pub(super) has_fixed_positions: bool,
    /// Whether samples filter textures, so that their mean may differ from the unfiltered one.
    pub(super) has_textures: bool,
}

/// How many samples the pixels of a picture have.
#[derive(Clone, Copy)]
pub(super) enum PixelSamples<'a> {
    /// So many each.
    Even(u32),
    /// As many as are listed, half buffer by half buffer.
    Listed(&'a [u32]),
}

impl PixelSamples<'_> {
    fn of(self, pixel: usize) -> u32 {
        match self {
            PixelSamples::Even(count) => count,
            PixelSamples::Listed(counts) => counts[2 * pixel] + counts[2 * pixel + 1],
        }
    }

    /// Whether a pixel has one half buffer alone.
    fn is_single(self, pixel: usize) -> bool {
        match self {
            PixelSamples::Even(_) => false,
            PixelSamples::Listed(counts) => counts[2 * pixel + 1] == 0,
        }
    }
}

/// What the half buffers of a pixel do not know of its error.
#[derive(Clone, Copy, PartialEq)]
enum Unknown {
    Nothing,
    /// What the filters of textures change on average.
    Filter,
    /// Its error, less what they know.
    All,
}

/// A pixel that is held out.
struct HeldOutPixel {
    pixel: usize,
    /// The probability of this pixel, times the number of pixels.
    density: f64,
    /// How often it was chosen before.
    repeat: u32,
    /// Another pixel of its block, for errors that neighbours share; none where half buffers tell these.
    partner: Option<usize>,
}

/// What of a pixel's error two estimates, of these samples each, shall tell.
struct Question {
    pixel: usize,
    samples: Range<u32>,
    unknown: Unknown,
}

impl ErrorEstimator<'_> {
    /// The error against what `sampler` converges to, and the work. The `round` tells independent estimates of one frame
    /// apart.
    pub(super) fn estimate(&self, sampler: &Sampler, round: u32) -> (FrameErrorEstimate, Work) {
        let half_buffers = HalfBufferError::of(self.picture);
        let held_out = self.hold_out(sampler, round);
        let worst_blocks = self.worst_blocks(half_buffers.as_ref());
        let mut pixels = Vec::new();
        let all_of = |pixel: usize, count: u32| Question {
            pixel,
            samples: 0..count,
            unknown: Unknown::All,
        };
        for chosen in &held_out {
            let count = self.samples_of_estimate(chosen.pixel);
            let first = chosen.repeat * count;
            pixels.push(Question {
                pixel: chosen.pixel,
                samples: first..first + count,
                unknown: self.unknown(chosen.pixel),
            });
            let partner = chosen.partner;
            pixels.extend(partner.map(|pixel| all_of(pixel, self.samples_of_estimate(pixel))));
        }
        pixels.extend(worst_blocks.iter().flat_map(Block::pixels).map(|pixel| {
            let count = self.samples_of_estimate(pixel);
            all_of(pixel, count.max(LEAST_SAMPLES_OF_WORST))
        }));
        let (errors, work) = self.errors(&pixels, sampler, round);
        let mut errors = errors.into_iter();
        let mut next = || errors.next().expect("one for each pixel");
        let relative = |pixel: usize, [a, b]: [DVec3; 2]| {
            (a * b * self.picture.inverse_normaliser(pixel)).element_sum() / 3.0
        };
        let (mut of_pixels, mut of_blocks) = (Vec::new(), Vec::new());
        for chosen in &held_out {
            let [a, b] = next();
            // What half buffers know is no news.
            let known = match (&half_buffers, self.unknown(chosen.pixel)) {
                (Some(half_buffers), Unknown::All) => half_buffers.square(chosen.pixel),
                _ => 0.0,
            };
            of_pixels.push((relative(chosen.pixel, [a, b]) - known) / chosen.density);
            if chosen.partner.is_some() {
                let [c, d] = next();
                let block = self.block(chosen.pixel);
                let count = block.len() as f64;
                let sum = a * b + (count - 1.0) * 0.5 * (a * d + b * c);
                let square = sum * self.picture.inverse_normaliser_of(&block);
                of_blocks.push(square.element_sum() / 3.0 / count / chosen.density);
            }
        }
        let of_worst = worst_blocks.iter().map(|block| {
            let squares = block.pixels().map(|pixel| relative(pixel, next()));
            mean(&squares.collect::<Vec<f64>>())
        });
        let worst_block = of_worst.fold(0.0, f64::max);
        let of_pixels = match of_pixels.is_empty() {
            true => Estimate::exact(0.0),
            false => Estimate::of(&of_pixels),
        };
        let of_half_buffers = half_buffers.as_ref().map(HalfBufferError::estimate);
        let known = of_half_buffers.map_or(Estimate::exact(0.0), |error| Estimate {
            mean: error.rel_mse,
            error: error.standard_error,
        });
        let estimate = FrameErrorEstimate {
            whole: ErrorEstimate {
                rel_mse: (known.mean + of_pixels.mean).max(0.0),
                standard_error: known.error.hypot(of_pixels.error),
            },
            worst_block,
            blurred: match &half_buffers {
                // The errors of other pixels are independent of each other.
                Some(half_buffers) => half_buffers.blurred() + of_pixels.mean.max(0.0) / 64.0,
                None => mean(&of_blocks).max(0.0),
            },
        };
        (estimate, work)
    }

    /// Chooses pixels for about the part of the samples that they may take.
    fn hold_out(&self, sampler: &Sampler, round: u32) -> Vec<HeldOutPixel> {
        let has_halves = self.picture.half_difference.is_some();
        let is_known = |pixel: usize| self.unknown(pixel) == Unknown::Nothing;
        let count = self.expected_errors.len();
        // Of the least error for a given cost.
        let weight =
            |pixel: usize| f64::from(self.expected_errors[pixel]) / self.cost(pixel).sqrt();
        let (mut unknown, mut expected, mut samples) = (0, 0.0, 0.0);
        for pixel in 0..count {
            samples += f64::from(self.samples.of(pixel));
            if !is_known(pixel) {
                unknown += 1;
                expected += weight(pixel);
            }
        }
        if unknown == 0 {
            return Vec::new();
        }
        let of_all = count as f64 / f64::from(unknown);
        let density = |pixel: usize| {
            if is_known(pixel) {
                0.0
            } else if expected.is_normal() {
                let part = weight(pixel) / expected * count as f64;
                (1.0 - EQUAL_PART) * part + EQUAL_PART * of_all
            } else {
                of_all
            }
        };
        let of_choice = |pixel: usize| density(pixel) * self.cost(pixel);
        // What filters change is shaded twice.
        let pictures = match has_halves && self.has_textures {
            true => 2.0,
            false => 1.0,
        };
        let partners = if has_halves { 1.0 } else { 2.0 };
        let per_choice = partners * (0..count).map(of_choice).sum::<f64>() / count as f64;
        let samples = (FRACTION * samples).max(LEAST_SAMPLES) * pictures;
        let choices = (samples / per_choice).ceil();
        let step = count as f64 / choices;
        let random = sampler.frame_sequence(round);
        let mut next = f64::from(random.sample_1d(0, 0)) * step;
        let mut held_out = Vec::new();
        let mut sum = 0.0;
        for pixel in 0..count {
            let density = density(pixel);
            sum += density;
            for repeat in 0.. {
                if next >= sum {
                    break;
                }
                next += step;
                let other = random.sample_1d(held_out.len() as u32, 1);
                held_out.push(HeldOutPixel {
                    pixel,
                    density,
                    repeat,
                    partner: (!has_halves).then(|| self.block(pixel).other(pixel, other)),
                });
            }
        }
        held_out
    }

    /// The blocks whose error is expected to be largest: by half buffers, if there are any.
    fn worst_blocks(&self, half_buffers: Option<&HalfBufferError>) -> Vec<Block> {
        let expected = |pixel: usize| match half_buffers {
            Some(half_buffers) => half_buffers.square(pixel),
            None => f64::from(self.expected_errors[pixel]),
        };
        let mut worst: Vec<(f64, Block)> = Vec::new();
        for block in Block::all(self.picture.width(), self.picture.height()) {
            let expected = block.pixels().map(expected).sum::<f64>() / block.len() as f64;
            let place = worst.partition_point(|(other, _)| *other >= expected);
            if place < WORST_BLOCKS {
                worst.insert(place, (expected, block));
                worst.truncate(WORST_BLOCKS);
            }
        }
        worst.into_iter().map(|(_, block)| block).collect()
    }

    /// How many samples it takes to hold out a pixel.
    fn cost(&self, pixel: usize) -> f64 {
        let runs = match self.unknown(pixel) {
            Unknown::Filter => 4,
            _ => 2,
        };
        f64::from(runs * self.samples_of_estimate(pixel))
    }

    /// How many samples each of the two estimates of a pixel has: both together about as many as the pixel, or more.
    fn samples_of_estimate(&self, pixel: usize) -> u32 {
        let least = match self.unknown(pixel) {
            Unknown::Filter => LEAST_SAMPLES_OF_FILTER,
            _ => 1,
        };
        (self.samples.of(pixel) / 2).max(least)
    }

    /// Two independent estimates of what is unknown of the error of each pixel, not squared.
    fn errors(
        &self,
        pixels: &[Question],
        sampler: &Sampler,
        round: u32,
    ) -> (Vec<[DVec3; 2]>, Work) {
        let width = self.picture.width();
        let chunks = pixels.par_chunks(CHUNK).map(|pixels| {
            let run = |of: &Question, estimate: u32, filtered_as: u32| SampleRun {
                point: ((of.pixel % width) as u32, (of.pixel / width) as u32),
                sequence: Sequence::HeldOut {
                    estimate,
                    round,
                    filtered_as,
                },
                first: of.samples.start,
                end: of.samples.end,
            };
            let runs = pixels.iter().flat_map(|of| {
                let both = |filtered_as| [0, 1].map(|estimate| run(of, estimate, filtered_as));
                // The same samples, unfiltered and filtered: what else is random cancels.
                let filtered =
                    (of.unknown == Unknown::Filter).then(|| both(self.samples.of(of.pixel) / 2));
                both(0).into_iter().chain(filtered.into_iter().flatten())
            });
            let runs: Vec<SampleRun> = runs.collect();
            let mut work = Work::default();
            let sums = sampler.sums(&runs, &mut work);
            let mut means = sums.iter().map(QuadrantSums::mean);
            let mut next = || [0, 1].map(|_| means.next().expect("one for each run"));
            let errors = pixels.iter().map(|of| {
                let unfiltered = next();
                let picture = match of.unknown {
                    Unknown::Filter => next(),
                    _ => [self.picture.value(of.pixel); 2],
                };
                [0, 1].map(|i| picture[i] - unfiltered[i])
            });
            (errors.collect::<Vec<_>>(), work)
        });
        let chunks: Vec<_> = chunks.collect();
        let mut all = Work::default();
        let mut errors = Vec::with_capacity(pixels.len());
        for (of_chunk, work) in chunks {
            all.query_state.rays += work.query_state.rays;
            all.non_finite += work.non_finite;
            errors.extend(of_chunk);
        }
        (errors, all)
    }

    fn unknown(&self, pixel: usize) -> Unknown {
        let has_halves = self.picture.half_difference.is_some();
        if !has_halves || self.has_fixed_positions || self.samples.is_single(pixel) {
            Unknown::All
        } else if self.has_textures {
            Unknown::Filter
        } else {
            Unknown::Nothing
        }
    }

    fn block(&self, pixel: usize) -> Block {
        Block::of(pixel, self.picture.width(), self.picture.height())
    }
}
