//! The error of a picture against the converged one, from held-out pixels.
//!
//! Two independent estimates A and B of a held-out pixel make (c - A)(c - B) an unbiased estimate of the squared error of
//! its value c, whatever that comes from: edges, textures, highlights, mirrors or noise. Pixels are held out with known
//! probabilities, high where error is likely, and each counts by the inverse of its own (Hansen and Hurwitz 1943, "On
//! the Theory of Sampling from Finite Populations"; systematically, Madow 1949).

use super::block::Block;
use super::error_estimate::{ErrorEstimate, FrameErrorEstimate};
use super::half_buffer_error::HalfBufferError;
use super::picture::Picture;
use super::sampler::{SampleRun, Sampler, Sequence, Work};
use crate::metrics::{Estimate, mean};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// How many blocks are looked at for the worst, ...
const WORST_BLOCKS: usize = 2;

/// ... and the least number of samples of each estimate of their pixels: the largest of noisy errors is too large.
const LEAST_SAMPLES_OF_WORST: u32 = 4;

/// The part of a picture's samples that held-out pixels take beside, ...
const FRACTION: f64 = 0.012;

/// ... and the least number of theirs.
const LEAST_SAMPLES: f64 = 2048.0;

/// The part of the held-out pixels that is taken from all with equal probabilities: error may be where none is expected.
const EQUAL_PART: f64 = 0.1;

/// Pixels that are sampled together.
const CHUNK: usize = 32;

/// Estimates the error of a picture, by what is known of it.
pub(super) struct ErrorEstimator<'a> {
    pub(super) picture: &'a Picture,
    /// The expected squared error of each pixel, relative to the square of the radiance; up to a factor.
    pub(super) expected_errors: Vec<f32>,
    pub(super) samples: PixelSamples<'a>,
    /// Whether the mean of the samples may differ from the converged picture: they lie at fixed places, or filter
    /// textures. Half buffers do not know that.
    pub(super) is_biased: bool,
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

impl ErrorEstimator<'_> {
    /// The error against what `sampler` converges to, and the work. The `round` tells independent estimates of one frame
    /// apart.
    pub(super) fn estimate(&self, sampler: &Sampler, round: u32) -> (FrameErrorEstimate, Work) {
        let half_buffers = HalfBufferError::of(self.picture);
        let held_out = self.hold_out(sampler, round);
        let worst_blocks = self.worst_blocks(half_buffers.as_ref());
        let mut pixels = Vec::new();
        for chosen in &held_out {
            let count = self.samples_of_estimate(chosen.pixel);
            let first = chosen.repeat * count;
            pixels.push((chosen.pixel, first..first + count));
            let partner = chosen.partner;
            pixels.extend(partner.map(|pixel| (pixel, 0..self.samples_of_estimate(pixel))));
        }
        pixels.extend(worst_blocks.iter().flat_map(Block::pixels).map(|pixel| {
            let count = self.samples_of_estimate(pixel).max(LEAST_SAMPLES_OF_WORST);
            (pixel, 0..count)
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
            let known = half_buffers
                .as_ref()
                .map_or(0.0, |half| half.square(chosen.pixel));
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
        let knows_all = has_halves && !self.is_biased;
        let is_known = |pixel: usize| knows_all && !self.samples.is_single(pixel);
        let count = self.expected_errors.len();
        let (mut unknown, mut expected, mut samples) = (0, 0.0, 0.0);
        for (pixel, &error) in self.expected_errors.iter().enumerate() {
            samples += f64::from(self.samples.of(pixel));
            if !is_known(pixel) {
                unknown += 1;
                expected += f64::from(error);
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
                let part = f64::from(self.expected_errors[pixel]) / expected * count as f64;
                (1.0 - EQUAL_PART) * part + EQUAL_PART * of_all
            } else {
                of_all
            }
        };
        let of_choice =
            |pixel: usize| density(pixel) * f64::from(2 * self.samples_of_estimate(pixel));
        let partners = if has_halves { 1.0 } else { 2.0 };
        let per_choice = partners * (0..count).map(of_choice).sum::<f64>() / count as f64;
        let choices = ((FRACTION * samples).max(LEAST_SAMPLES) / per_choice).ceil();
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

    /// How many samples each of the two estimates of a pixel has: both together about as many as the pixel.
    fn samples_of_estimate(&self, pixel: usize) -> u32 {
        (self.samples.of(pixel) / 2).max(1)
    }

    /// The errors of pixels by two independent estimates each, of these samples.
    fn errors(
        &self,
        pixels: &[(usize, Range<u32>)],
        sampler: &Sampler,
        round: u32,
    ) -> (Vec<[DVec3; 2]>, Work) {
        let width = self.picture.width();
        let chunks = pixels.par_chunks(CHUNK).map(|pixels| {
            let runs = pixels.iter().flat_map(|(pixel, samples)| {
                [0, 1].map(|estimate| SampleRun {
                    point: ((pixel % width) as u32, (pixel / width) as u32),
                    sequence: Sequence::HeldOut { estimate, round },
                    first: samples.start,
                    end: samples.end,
                })
            });
            let runs: Vec<SampleRun> = runs.collect();
            let mut work = Work::default();
            let moments = sampler.moments(&runs, &mut work);
            let estimates = pixels.iter().zip(moments.chunks_exact(2));
            let errors = estimates.map(|((pixel, _), estimates)| {
                [0, 1].map(|i| self.picture.value(*pixel) - estimates[i].mean.as_dvec3())
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

    fn block(&self, pixel: usize) -> Block {
        Block::of(pixel, self.picture.width(), self.picture.height())
    }
}
