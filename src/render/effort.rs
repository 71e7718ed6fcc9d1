//! How many samples an estimate of an error takes.

use super::question::Part;

/// The fraction of a picture's samples that each part of its error takes beside, ...
const FRACTION: f64 = 0.012;

/// ... the fraction of later estimates of a frame: what an interval of half the width takes more, it saves in samples, as
/// its upper bound ends a frame, ...
const FRACTION_OF_LATER: f64 = 0.03;

/// ... and the least number of samples: the larger one where it is less than half of the picture's.
const LEAST_SAMPLES: [f64; 2] = [2048.0, 16384.0];

/// The least number of samples of each estimate of what filters of textures change: the product of the noise of two is
/// larger than the square of the change where they are few.
const LEAST_SAMPLES_OF_FILTER: u32 = 8;

/// A part of which too little is known takes so many times more pixels, and so many times more samples of each of their
/// estimates, ...
const MORE: u32 = 2;

/// ... up to so many times as many as at first.
const MOST: u32 = 4;

/// How much an estimate takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// How often the error of this frame was estimated before: tells independent estimates apart.
    pub(super) round: u32,
    /// How many times more pixels, and samples of each of their estimates, than at first each [`Part`] takes.
    times: [u32; 3],
}

impl Effort {
    /// For an estimate after so many others of this frame.
    pub(super) fn after(round: u32) -> Effort {
        Effort {
            round,
            times: [1; 3],
        }
    }

    /// About how many samples a part takes, of a picture of so many.
    pub(super) fn budget(&self, part: Part, samples: f64) -> f64 {
        let fraction = match self.round {
            0 => FRACTION,
            _ => FRACTION_OF_LATER,
        };
        let [least, more] = LEAST_SAMPLES;
        let usual = (fraction * samples).max((0.5 * samples).clamp(least, more));
        f64::from(self.times(part).pow(2)) * usual
    }

    /// How many samples each of the two estimates of a pixel has: as many as the pixel or its half buffer, or more.
    pub(super) fn samples_of_estimate(&self, part: Part, samples_of_pixel: u32) -> u32 {
        let least = match part {
            Part::Filter => LEAST_SAMPLES_OF_FILTER,
            Part::All | Part::Samples => 1,
        };
        self.times(part) * samples_of_pixel.max(least)
    }

    /// For another estimate, which knows more of a part; none if the part has taken the most.
    pub(super) fn with_more(mut self, part: Part) -> Option<Effort> {
        self.round += 1;
        let times = &mut self.times[part as usize];
        *times *= MORE;
        (*times <= MOST).then_some(self)
    }

    fn times(&self, part: Part) -> u32 {
        self.times[part as usize]
    }
}
