//! The error of a picture against the converged one, from held-out pixels.
//!
//! Two independent estimates A and B of a held-out pixel make (c - A)(c - B) an unbiased estimate of the squared error of
//! its value c, whatever that comes from: edges, textures, highlights, mirrors or noise.
//!
//! What filters of textures change on average is estimated apart, from two independent sets of samples that are shaded
//! both unfiltered and filtered: the product of the differences is the square of the change, without the noise of edges.
//! The rest is the error against filtered samples, without the noise of textures; half buffers know it.

use super::block::Block;
use super::error_estimate::{ErrorEstimate, FrameErrorEstimate};
use super::half_buffer_error::HalfBufferError;
use super::held_out::{HeldOutPixel, hold_out};
use super::picture::Picture;
use super::sampler::{QuadrantSums, SampleRun, Sampler, Sequence, Work};
use crate::metrics::mean;
use glam::DVec3;
use rayon::prelude::*;

/// How many blocks are looked at for the worst, ...
const WORST_BLOCKS: usize = 2;

/// ... and the least number of samples of each estimate of their pixels: the largest of noisy errors is too large.
const LEAST_SAMPLES_OF_WORST: u32 = 4;

/// The least number of samples of each estimate of what filters of textures change: the product of the noise of two is
/// larger than the square of the change where they are few.
const LEAST_SAMPLES_OF_FILTER: u32 = 8;

/// The fraction of a picture's samples that each part of the error takes beside, ...
const FRACTION: f64 = 0.012;

/// ... the fraction once a picture is refined: what an interval of half the width takes more, it saves in samples, as its
/// upper bound ends a frame, ...
const FRACTION_OF_REFINED: f64 = 0.03;

/// ... and the least number of samples: the larger one where it is less than half of the picture's.
const LEAST_SAMPLES: [f64; 2] = [2048.0, 16384.0];

/// How often a pixel is asked for each time that it is chosen: the differences are the noise of the answers.
const ANSWERS: u32 = 2;

/// Questions that are answered together.
const CHUNK: usize = 32;

/// Estimates the error of a picture, by what is known of it.
pub(super) struct ErrorEstimator<'a> {
    pub(super) picture: &'a Picture,
    /// The expected squared error of each pixel, relative to the square of the radiance; up to a factor.
    pub(super) expected_errors: &'a [f32],
    pub(super) samples: PixelSamples<'a>,
    /// Whether samples lie at fixed places, so that their mean differs from that of the whole pixel.
    pub(super) has_fixed_positions: bool,
    /// Whether samples filter textures, so that their mean may differ from the unfiltered one.
    pub(super) has_textures: bool,
}

/// How much an estimate takes.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// How often the error of this frame was estimated before: tells independent estimates apart.
    pub(super) round: u32,
    /// Whether the picture is refined.
    pub(super) is_refined: bool,
    /// Times as many samples as usual.
    pub(super) times: f64,
}

impl Effort {
    pub(super) const FIRST: Effort = Effort {
        round: 0,
        is_refined: false,
        times: 1.0,
    };
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

/// What of an error is estimated together.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// All of it.
    All,
    /// What more samples with the same filters of textures would change.
    Samples,
    /// What these filters change on average.
    Filter,
}

impl Part {
    /// Its random numbers are other ones than those of other parts, and of other rounds.
    fn round(self, round: u32) -> u32 {
        2 * round + u32::from(self == Part::Filter)
    }
}

/// What of a pixel's error two estimates, of these samples each, shall tell.
struct Question {
    pixel: usize,
    /// Tells the random numbers of answers apart.
    answer: u32,
    samples: u32,
    part: Part,
}

/// The pixels that are held out for one part.
struct HeldOut {
    part: Part,
    pixels: Vec<HeldOutPixel>,
    /// For each question another pixel of its block, for errors that neighbours share; empty where they share none.
    partners: Vec<usize>,
}

impl ErrorEstimator<'_> {
    /// The error against what `sampler` converges to, and the work.
    pub(super) fn estimate(&self, sampler: &Sampler, effort: Effort) -> (FrameErrorEstimate, Work) {
        // They do not know what fixed positions are off by.
        let half_buffers = match self.has_fixed_positions {
            true => None,
            false => HalfBufferError::of(self.picture),
        };
        let parts = self.parts().iter();
        let parts: Vec<HeldOut> = parts
            .map(|&part| self.hold_out(part, sampler, effort))
            .collect();
        let worst_blocks = self.worst_blocks(half_buffers.as_ref());
        let mut questions = Vec::new();
        parts.iter().for_each(|part| self.ask(part, &mut questions));
        questions.extend(worst_blocks.iter().flat_map(Block::pixels).map(|pixel| {
            let count = self.samples_of_estimate(pixel, Part::All);
            Question {
                pixel,
                answer: 0,
                samples: count.max(LEAST_SAMPLES_OF_WORST),
                part: Part::All,
            }
        }));
        let (errors, work) = self.errors(&questions, sampler, effort.round);
        let mut errors = errors.into_iter();
        let of_half_buffers = half_buffers.as_ref().map(HalfBufferError::estimate);
        let mut whole = of_half_buffers.unwrap_or(ErrorEstimate::NONE);
        let mut blurred = half_buffers.as_ref().map_or(0.0, HalfBufferError::blurred);
        for part in &parts {
            let (of_pixels, of_blocks) = self.of_part(part, &mut errors);
            whole = whole.plus(of_pixels);
            blurred += of_blocks;
        }
        let of_worst = worst_blocks.iter().map(|block| {
            let squares = block.pixels().zip(&mut errors);
            let squares =
                squares.map(|(pixel, error)| product(error, self.inverse_normaliser(pixel)[0]));
            mean(&squares.collect::<Vec<f64>>())
        });
        let estimate = FrameErrorEstimate {
            worst_block: of_worst.fold(0.0, f64::max),
            whole: ErrorEstimate {
                rel_mse: whole.rel_mse.max(0.0),
                ..whole
            },
            blurred: blurred.max(0.0),
        };
        (estimate, work)
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
        let pixels = self.expected_errors.par_iter().enumerate();
        let weights = pixels.map(|(pixel, expected)| {
            // Of the least error for a given cost.
            let weight = expected / (self.cost(pixel, part) as f32).sqrt();
            // The squares of very bright radiance overflow.
            weight.min(f32::MAX)
        });
        let weights: Vec<f32> = weights.collect();
        let halves = if self.has_halves() { 2.0 } else { 1.0 };
        let samples = (0..weights.len()).map(|pixel| f64::from(self.samples.of(pixel)));
        let fraction = match effort.is_refined {
            false => FRACTION,
            true => FRACTION_OF_REFINED,
        };
        let samples: f64 = halves * samples.sum::<f64>();
        let [least, more] = LEAST_SAMPLES;
        let budget = effort.times * (fraction * samples).max((0.5 * samples).clamp(least, more));
        let has_partners = self.has_fixed_positions;
        let pixels = if has_partners { 2 } else { 1 };
        let cost = |pixel: usize| f64::from(pixels * ANSWERS * self.cost(pixel, part));
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
    fn ask(&self, held_out: &HeldOut, questions: &mut Vec<Question>) {
        let part = held_out.part;
        let mut partners = held_out.partners.iter();
        for of in &held_out.pixels {
            let count = self.samples_of_estimate(of.pixel, part);
            for answer in 0..of.times * ANSWERS {
                questions.push(Question {
                    pixel: of.pixel,
                    answer,
                    samples: count,
                    part,
                });
                questions.extend(partners.next().map(|&pixel| Question {
                    pixel,
                    answer: 0,
                    samples: self.samples_of_estimate(pixel, part),
                    part,
                }));
            }
        }
    }

    /// A part of the error of pixels, and of blocks' means, from the answers to its questions.
    ///
    /// All answers of a pixel make one pair of estimates A and B, with the noise that the jackknife finds between them. The
    /// variance is that of the noise and, of pixels that were not certain to be chosen, of the choice (Horvitz and Thompson
    /// 1952, "A Generalization of Sampling Without Replacement"); the radiance that errors are relative to adds its own.
    fn of_part(
        &self,
        held_out: &HeldOut,
        errors: &mut impl Iterator<Item = [DVec3; 2]>,
    ) -> (ErrorEstimate, f64) {
        let mut next = || errors.next().expect("one for each question");
        let (mut choices, mut sum, mut variance) = (0.0, 0.0, 0.0);
        let mut of_blocks = Vec::new();
        for of in &held_out.pixels {
            let inverse = self.inverse_normaliser(of.pixel);
            let relative = |error| inverse.map(|inverse| product(error, inverse) / of.density);
            let (mut sums, mut answers) = ([DVec3::ZERO; 2], Vec::new());
            for _ in 0..of.times * ANSWERS {
                let [a, b] = next();
                sums = [sums[0] + a, sums[1] + b];
                answers.push([a, b]);
                if !held_out.partners.is_empty() {
                    let [c, d] = next();
                    let block = self.block(of.pixel);
                    let count = block.len() as f64;
                    let sum = a * b + (count - 1.0) * 0.5 * (a * d + b * c);
                    let square = sum * self.picture.inverse_normaliser_of(&block);
                    of_blocks.push(square.element_sum() / 3.0 / count / of.density);
                }
            }
            let count = answers.len() as f64;
            let means = sums.map(|sum| sum / count);
            let [value, deviation] = relative(means);
            // The noise of A times that of B counts twice in the jackknife's squares.
            let square = |answer: &[DVec3; 2]| {
                let off = [0, 1].map(|i| (answer[i] - means[i]) / (count - 1.0));
                let [without, _] = relative([0, 1].map(|i| means[i] - off[i]));
                let [of_both, _] = relative(off);
                let square = (without - value).powi(2) - (count - 1.0) * of_both.powi(2);
                (count - 1.0) * square
            };
            let noise = answers.iter().map(square).sum::<f64>().max(0.0) / count;
            let times = f64::from(of.times);
            choices += times;
            sum += times * value;
            variance += of.chance * times.powi(2) * noise + (1.0 - of.chance) * value.powi(2);
            variance += (times * deviation).powi(2);
        }
        let of_pixels = ErrorEstimate {
            rel_mse: sum / choices,
            standard_error: variance.sqrt() / choices,
        };
        let of_blocks = match held_out.partners.is_empty() {
            // The errors of pixels are independent of each other.
            true => of_pixels.rel_mse / 64.0,
            false => mean(&of_blocks),
        };
        (of_pixels, of_blocks)
    }

    /// What the product of two estimates of a pixel's error is relative to, inverted, and its standard deviation.
    fn inverse_normaliser(&self, pixel: usize) -> [DVec3; 2] {
        let count = self.samples.of(pixel);
        self.picture.inverse_normaliser(pixel, count)
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

    /// How many samples it takes to answer a question.
    fn cost(&self, pixel: usize, part: Part) -> u32 {
        let runs = match part {
            Part::Filter => 4,
            Part::All | Part::Samples => 2,
        };
        runs * self.samples_of_estimate(pixel, part)
    }

    /// How many samples each of the two estimates of a pixel has: as many as the pixel or its half buffer, or more.
    fn samples_of_estimate(&self, pixel: usize, part: Part) -> u32 {
        let least = match part {
            Part::Filter => LEAST_SAMPLES_OF_FILTER,
            Part::All | Part::Samples => 1,
        };
        self.samples.of(pixel).max(least)
    }

    /// Two independent estimates of each error, not squared.
    fn errors(
        &self,
        questions: &[Question],
        sampler: &Sampler,
        round: u32,
    ) -> (Vec<[DVec3; 2]>, Work) {
        let chunks = questions.par_chunks(CHUNK).map(|questions| {
            let runs = questions.iter().flat_map(|of| self.runs(of, round));
            let runs: Vec<SampleRun> = runs.collect();
            let mut work = Work::default();
            let sums = sampler.sums(&runs, &mut work);
            let mut means = sums.iter().map(QuadrantSums::mean);
            let mut next = || [0, 1].map(|_| means.next().expect("one for each run"));
            let errors = questions.iter().map(|of| {
                let estimates = next();
                let values = match of.part {
                    Part::All | Part::Samples => [self.picture.value(of.pixel); 2],
                    Part::Filter => next(),
                };
                [0, 1].map(|i| values[i] - estimates[i])
            });
            (errors.collect::<Vec<_>>(), work)
        });
        let chunks: Vec<_> = chunks.collect();
        let mut all = Work::default();
        let mut errors = Vec::with_capacity(questions.len());
        for (of_chunk, work) in chunks {
            all.query_state.rays += work.query_state.rays;
            all.non_finite += work.non_finite;
            errors.extend(of_chunk);
        }
        (errors, all)
    }

    /// The samples that answer a question: two estimates; of filters the same samples again, filtered, so that what else
    /// is random cancels.
    fn runs(&self, of: &Question, round: u32) -> impl Iterator<Item = SampleRun> {
        let width = self.picture.width();
        let point = ((of.pixel % width) as u32, (of.pixel / width) as u32);
        let filtered_as = self.samples.of(of.pixel);
        let filters = match of.part {
            Part::All => vec![0],
            Part::Samples => vec![filtered_as],
            Part::Filter => vec![0, filtered_as],
        };
        let &Question {
            answer,
            samples,
            part,
            ..
        } = of;
        let round = part.round(round);
        filters.into_iter().flat_map(move |filtered_as| {
            [0, 1].map(|estimate| SampleRun {
                point,
                sequence: Sequence::HeldOut {
                    estimate,
                    round,
                    answer,
                    filtered_as,
                },
                first: 0,
                end: samples,
            })
        })
    }

    fn has_halves(&self) -> bool {
        self.picture.half_difference.is_some()
    }

    fn block(&self, pixel: usize) -> Block {
        Block::of(pixel, self.picture.width(), self.picture.height())
    }
}

/// The product of two estimates of an error, relative to the radiance.
fn product([a, b]: [DVec3; 2], inverse_normaliser: DVec3) -> f64 {
    (a * b * inverse_normaliser).element_sum() / 3.0
}
