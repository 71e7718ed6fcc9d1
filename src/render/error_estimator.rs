//! The error of a picture against the converged one, from held-out pixels.
//!
//! Two independent estimates A and B of a held-out pixel make (c - A)(c - B) an unbiased estimate of the squared error of
//! its value c, whatever that comes from: edges, textures, highlights, mirrors or noise.
//!
//! What filters of textures change on average is estimated apart, from two independent sets of samples that are shaded
//! both unfiltered and filtered: the product of the differences is the square of the change, without the noise of edges.
//! The rest is the error against filtered samples, without the noise of textures; half buffers know it.

use super::block::Block;
use super::effort::Effort;
use super::error_estimate::{ErrorEstimate, FrameErrorEstimate};
use super::half_buffer_error::HalfBufferError;
use super::held_out::{ChosenPixel, hold_out};
use super::picture::Picture;
use super::question::{Part, Question, answers};
use super::sampler::{Sampler, Work};
use super::squared_error::SquaredError;
use crate::metrics::{channel_mean, mean};
use glam::DVec3;
use rayon::prelude::*;

/// How many blocks are looked at for the worst, ...
const WORST_BLOCKS: usize = 2;

/// ... and the least number of samples of each estimate of their pixels: the largest of noisy errors is too large.
const LEAST_SAMPLES_OF_WORST: u32 = 4;

/// How often a pixel is asked for each time that it is chosen: the differences are the noise of the answers.
const ANSWERS: u32 = 2;

/// The most that another estimate of an even picture takes, as a fraction of its samples.
const MOST_OF_EVEN: f64 = 0.25;

/// Estimates the error of a picture, by what is known of it.
pub(super) struct ErrorEstimator<'a> {
    picture: &'a Picture,
    /// The expected squared error of each pixel, relative to the square of the radiance; up to a factor.
    expected_errors: &'a [f32],
    samples: PixelSamples<'a>,
    /// Whether samples lie at fixed places, so that their mean differs from that of the whole pixel.
    has_fixed_positions: bool,
    /// Whether samples filter textures, so that their mean may differ from the unfiltered one.
    has_textures: bool,
    /// What the half buffers know of the error.
    pub(super) of_half_buffers: FrameErrorEstimate,
    worst_blocks: Vec<Block>,
}

/// How many samples the pixels of a picture have, or each of its half buffers.
#[derive(Clone, Copy)]
pub(super) enum PixelSamples<'a> {
    /// So many each.
    Even(u32),
    /// As many as are listed.
    Listed(&'a [u32]),
}

impl PixelSamples<'_> {
    fn of(self, pixel: usize) -> u32 {
        match self {
            PixelSamples::Even(count) => count,
            PixelSamples::Listed(counts) => counts[pixel],
        }
    }
}

/// An estimate of a frame's error.
pub(super) struct Estimate {
    /// What the half buffers do not know, from held-out pixels: unbiased, so that it may be below 0.
    pub(super) of_held_out: FrameErrorEstimate,
    pub(super) work: Work,
    /// What makes another estimate know the error better; none if nothing does.
    pub(super) more: Option<Effort>,
}

/// The pixels that are held out for one part.
struct HeldOut {
    part: Part,
    pixels: Vec<ChosenPixel>,
    /// For each question another pixel of its block, for errors that neighbours share; empty where they share none.
    partners: Vec<usize>,
}

/// A part of the error.
struct PartOfError {
    part: Part,
    of_pixels: ErrorEstimate,
    /// Of the means of blocks.
    of_blocks: f64,
}

impl<'a> ErrorEstimator<'a> {
    /// Of a picture, as [`ErrorEstimator`]'s fields describe it.
    pub(super) fn new(
        picture: &'a Picture,
        expected_errors: &'a [f32],
        samples: PixelSamples<'a>,
        has_fixed_positions: bool,
        has_textures: bool,
    ) -> ErrorEstimator<'a> {
        // They do not know what fixed positions are off by.
        let half_buffers = match has_fixed_positions {
            true => None,
            false => HalfBufferError::of(picture),
        };
        let expected = |pixel: usize| match &half_buffers {
            Some(half_buffers) => half_buffers.square(pixel),
            None => f64::from(expected_errors[pixel]),
        };
        ErrorEstimator {
            picture,
            expected_errors,
            samples,
            has_fixed_positions,
            has_textures,
            worst_blocks: worst_blocks(picture, expected),
            of_half_buffers: half_buffers.map_or(FrameErrorEstimate::NONE, |half_buffers| {
                FrameErrorEstimate {
                    whole: half_buffers.estimate(),
                    blurred: half_buffers.blurred(),
                    ..FrameErrorEstimate::NONE
                }
            }),
        }
    }

    /// The error against what `sampler` converges to.
    pub(super) fn estimate(&self, sampler: &Sampler, effort: Effort) -> Estimate {
        let parts = self.parts().iter();
        let parts: Vec<HeldOut> = parts
            .map(|&part| self.hold_out(part, sampler, effort))
            .collect();
        let of_parts = parts.iter().flat_map(|part| self.ask(part, effort));
        let worst_pixels = self.worst_blocks.iter().flat_map(Block::pixels);
        let of_worst = worst_pixels.map(|pixel| {
            let question = self.question(Part::All, pixel, 0, effort);
            Question {
                samples: question.samples.max(LEAST_SAMPLES_OF_WORST),
                ..question
            }
        });
        let questions: Vec<Question> = of_parts.chain(of_worst).collect();
        let (answers, work) = answers(&questions, self.picture, sampler, effort.round);
        let mut answers = answers.into_iter();
        let mut next = || answers.next().expect("one for each question");
        let parts = parts
            .iter()
            .map(|held_out| self.of_part(held_out, &mut next));
        let parts: Vec<PartOfError> = parts.collect();
        let of_worst = self.worst_blocks.iter().map(|block| {
            let square = |pixel| SquaredError::of(&[next()], self.inverse_normaliser(pixel)).value;
            mean(&block.pixels().map(square).collect::<Vec<f64>>())
        });
        let of_held_out = FrameErrorEstimate {
            whole: parts
                .iter()
                .fold(ErrorEstimate::NONE, |sum, part| sum.plus(part.of_pixels)),
            worst_block: of_worst.fold(0.0, f64::max),
            blurred: parts.iter().map(|part| part.of_blocks).sum(),
        };
        let vaguest = parts.iter().max_by(|a, b| {
            let [a, b] = [a, b].map(|part| part.of_pixels.standard_error);
            a.total_cmp(&b)
        });
        let known = self.of_half_buffers.whole.standard_error;
        let vaguest = vaguest.filter(|part| part.of_pixels.standard_error > known);
        Estimate {
            of_held_out,
            work,
            more: vaguest.and_then(|part| self.more(part.part, effort)),
        }
    }

    /// The effort that knows more of a part; none where that takes too much.
    fn more(&self, part: Part, effort: Effort) -> Option<Effort> {
        let more = effort.with_more(part)?;
        let is_worth_it = match self.samples {
            PixelSamples::Even(_) => {
                let samples = self.all_samples();
                more.budget(part, samples) <= MOST_OF_EVEN * samples
            }
            // It may save more samples than it takes.
            PixelSamples::Listed(_) => true,
        };
        is_worth_it.then_some(more)
    }

    /// How many samples the picture has.
    fn all_samples(&self) -> f64 {
        let halves = if self.has_halves() { 2.0 } else { 1.0 };
        let samples = (0..self.expected_errors.len()).map(|pixel| self.samples.of(pixel));
        halves * samples.map(f64::from).sum::<f64>()
    }

    /// The parts of which nothing is known.
    fn parts(&self) -> &'static [Part] {
        match (self.has_fixed_positions, self.has_halves()) {
            (true, _) => &[Part::All],
            (false, false) if self.has_textures => &[Part::Samples, Part::Filter],
            (false, false) => &[Part::Samples],
            (false, true) if self.has_textures => &[Part::Filter],
            (false, true) => &[],
        }
    }

    /// Chooses pixels for about the samples that a part may take.
    fn hold_out(&self, part: Part, sampler: &Sampler, effort: Effort) -> HeldOut {
        let cost =
            |pixel: usize| part.runs() * effort.samples_of_estimate(part, self.samples.of(pixel));
        let pixels = self.expected_errors.par_iter().enumerate();
        let weights = pixels.map(|(pixel, expected)| {
            // Of the least error for a given cost.
            let weight = expected / (cost(pixel) as f32).sqrt();
            // The squares of very bright radiance overflow.
            weight.min(f32::MAX)
        });
        let weights: Vec<f32> = weights.collect();
        let budget = effort.budget(part, self.all_samples());
        let has_partners = self.has_fixed_positions;
        let pixels = if has_partners { 2 } else { 1 };
        let cost = |pixel: usize| f64::from(pixels * ANSWERS * cost(pixel));
        let random = sampler.frame_sequence(part.round(effort.round));
        let held_out = hold_out(&weights, cost, budget, random.sample_1d(0, 0));
        let choices = held_out
            .iter()
            .flat_map(|of| (0..of.times * ANSWERS).map(|_| of.pixel));
        let partners = choices.enumerate().map(|(number, pixel)| {
            let other = random.sample_1d(number as u32, 1);
            self.block(pixel).other(pixel, other)
        });
        let partners = match has_partners {
            true => partners.collect(),
            false => Vec::new(),
        };
        HeldOut {
            part,
            partners,
            pixels: held_out,
        }
    }

    /// The questions of a part: of each choice, [`ANSWERS`] times, and of its partners.
    fn ask(&self, held_out: &HeldOut, effort: Effort) -> Vec<Question> {
        let part = held_out.part;
        let mut partners = held_out.partners.iter();
        let mut questions = Vec::new();
        for of in &held_out.pixels {
            for answer in 0..of.times * ANSWERS {
                questions.push(self.question(part, of.pixel, answer, effort));
                let partner = partners.next();
                questions.extend(partner.map(|&pixel| self.question(part, pixel, 0, effort)));
            }
        }
        questions
    }

    /// A part of the error, from the answers to its questions.
    ///
    /// The variance is that of the noise of answers and, of pixels that were not certain to be chosen, of the choice
    /// (Horvitz and Thompson 1952, "A Generalization of Sampling Without Replacement"); the radiance that errors are relative
    /// to adds its own.
    fn of_part(&self, held_out: &HeldOut, next: &mut impl FnMut() -> [DVec3; 2]) -> PartOfError {
        let (mut choices, mut sum, mut variance, mut noise) = (0.0, 0.0, 0.0, 0.0_f64);
        let mut of_blocks = Vec::new();
        for of in &held_out.pixels {
            let mut pairs = Vec::new();
            for _ in 0..of.times * ANSWERS {
                let pair = next();
                pairs.push(pair);
                if !held_out.partners.is_empty() {
                    of_blocks.push(self.of_block(of.pixel, pair, next()) / of.density);
                }
            }
            let error = SquaredError::of(&pairs, self.inverse_normaliser(of.pixel));
            let times = f64::from(of.times);
            let weight = times / of.density;
            choices += times;
            sum += weight * error.value;
            let of_choice = (1.0 - of.chance) * (error.value / of.density).powi(2);
            noise += of.chance * weight.powi(2) * error.noise;
            variance += of_choice + (weight * error.deviation).powi(2);
        }
        let of_pixels = ErrorEstimate {
            rel_mse: sum / choices,
            standard_error: (variance + noise.max(0.0)).sqrt() / choices,
        };
        PartOfError {
            part: held_out.part,
            of_pixels,
            of_blocks: match of_blocks.is_empty() {
                // The errors of pixels are independent of each other.
                true => of_pixels.rel_mse / 64.0,
                false => mean(&of_blocks),
            },
        }
    }

    /// The squared error of the mean of a block, by estimates of the errors of a pixel and of its partner.
    fn of_block(&self, pixel: usize, [a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
        let block = self.block(pixel);
        let count = block.len() as f64;
        let sum = a * b + (count - 1.0) * 0.5 * (a * d + b * c);
        let square = sum * self.picture.inverse_normaliser_of(&block);
        channel_mean(square) / count
    }

    /// What the product of two estimates of a pixel's error is relative to, inverted, and its standard deviation.
    fn inverse_normaliser(&self, pixel: usize) -> [DVec3; 2] {
        let count = self.samples.of(pixel);
        self.picture.inverse_normaliser(pixel, count)
    }

    /// A question about a pixel.
    fn question(&self, part: Part, pixel: usize, answer: u32, effort: Effort) -> Question {
        let filtered_as = self.samples.of(pixel);
        Question {
            part,
            pixel,
            answer,
            samples: effort.samples_of_estimate(part, filtered_as),
            filtered_as,
        }
    }

    fn has_halves(&self) -> bool {
        self.picture.half_difference.is_some()
    }

    fn block(&self, pixel: usize) -> Block {
        Block::of(pixel, self.picture.width(), self.picture.height())
    }
}

/// The blocks whose error is expected to be largest.
fn worst_blocks(picture: &Picture, expected: impl Fn(usize) -> f64) -> Vec<Block> {
    let mut worst: Vec<(f64, Block)> = Vec::new();
    for block in Block::all(picture.width(), picture.height()) {
        let expected = block.pixels().map(&expected).sum::<f64>() / block.len() as f64;
        let place = worst.partition_point(|(other, _)| *other >= expected);
        if place < WORST_BLOCKS {
            worst.insert(place, (expected, block));
            worst.truncate(WORST_BLOCKS);
        }
    }
    worst.into_iter().map(|(_, block)| block).collect()
}
