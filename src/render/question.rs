//! Questions about the errors of pixels, and the samples that answer them.

use super::picture::Picture;
use super::sampler::{QuadrantSums, SampleRun, Sampler, Sequence, Work};
use glam::DVec3;
use rayon::prelude::*;

/// What of an error is estimated together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// All of it.
    All,
    /// What more samples with the same filters of textures would change.
    Samples,
    /// What these filters change on average.
    Filter,
}

/// What of a pixel's error two independent estimates shall tell.
#[derive(Clone, Copy)]
pub(super) struct Question {
    pub(super) part: Part,
    pub(super) pixel: usize,
    /// Tells the random numbers of answers to the same question apart.
    pub(super) answer: u32,
    /// How many samples each of the two estimates has.
    pub(super) samples: u32,
    /// Of how many samples the pixel is, or its half buffer: that decides how textures are filtered.
    pub(super) filtered_as: u32,
}

/// Questions that are answered together.
const CHUNK: usize = 32;

/// Two independent estimates of what each question asks for, an error of the picture, not squared; and the work. `round`
/// tells the random numbers of estimates of the same picture apart.
pub(super) fn answers(
    questions: &[Question],
    picture: &Picture,
    sampler: &Sampler,
    round: u32,
) -> (Vec<[DVec3; 2]>, Work) {
    let chunks = questions.par_chunks(CHUNK).map(|questions| {
        let runs = questions
            .iter()
            .flat_map(|of| of.runs(picture.width(), round));
        let runs: Vec<SampleRun> = runs.collect();
        let mut work = Work::default();
        let sums = sampler.sums(&runs, &mut work);
        let mut means = sums.iter().map(QuadrantSums::mean);
        let mut next = || [0, 1].map(|_| means.next().expect("one for each run"));
        let errors = questions.iter().map(|of| {
            let estimates = next();
            let values = match of.part {
                Part::All | Part::Samples => [picture.value(of.pixel); 2],
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

impl Part {
    /// Its random numbers are other ones than those of other parts, and of other rounds.
    pub(super) fn round(self, round: u32) -> u32 {
        2 * round + u32::from(self == Part::Filter)
    }

    /// How many runs of samples a question takes.
    pub(super) fn runs(self) -> u32 {
        match self {
            Part::All | Part::Samples => 2,
            Part::Filter => 4,
        }
    }
}

impl Question {
    /// The samples of the two estimates; of filters the same samples again, filtered, so that what else is random cancels.
    fn runs(&self, width: usize, round: u32) -> impl Iterator<Item = SampleRun> {
        let &Question {
            part,
            pixel,
            answer,
            samples,
            filtered_as,
        } = self;
        let filters = match part {
            Part::All => vec![0],
            Part::Samples => vec![filtered_as],
            Part::Filter => vec![0, filtered_as],
        };
        filters.into_iter().flat_map(move |filtered_as| {
            [0, 1].map(|estimate| SampleRun {
                point: ((pixel % width) as u32, (pixel / width) as u32),
                sequence: Sequence::HeldOut {
                    estimate,
                    round: part.round(round),
                    answer,
                    filtered_as,
                },
                first: 0,
                end: samples,
            })
        })
    }
}
