//! What a sequence is expected to take, from a pilot.

use super::pilot::{Pilot, PilotFrame, Workload};
use crate::metrics::{mean, student_t};
use crate::render::frame_memory;
use serde::{Deserialize, Serialize};

/// Relative change of the speed of a shared machine from one minute to the next.
const PACE: f64 = 0.2;

/// Working memory of a thread, in bytes.
const THREAD_MEMORY: f64 = 2e6;

/// What a sequence is expected to take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Threads that it is for.
    pub threads: usize,
    /// What the frames of the pilot cost, by number.
    pub frames: Vec<PilotFrame>,
    /// Relative half width of the 95 % confidence interval of the seconds.
    pub seconds_within: f64,
    /// The same of the bytes.
    pub bytes_within: f64,
    /// Bytes of memory at most.
    pub memory: Forecast,
}

/// A number that is not known yet, with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Forecast")]
pub struct Forecast {
    /// The expected value.
    pub expected: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Forecast {
    fn within(expected: f64, relative: f64) -> Forecast {
        Forecast {
            expected,
            low: expected / (1.0 + relative),
            high: expected * (1.0 + relative),
        }
    }
}

impl Estimate {
    /// Estimates all frames of a path. `memory` are the bytes that the program takes before the first frame.
    pub fn new(workload: &Workload, memory: f64) -> Estimate {
        let Pilot {
            frames,
            doubt_of_seconds,
            doubt_of_bytes,
        } = Pilot::run(workload);
        let count = workload.path.timeline().frame_count();
        let within = |value: fn(&PilotFrame) -> f64, doubt: f64, pace: f64| {
            let values: Vec<f64> = frames.iter().map(value).collect();
            let sampling = error_of_mean(&values, count);
            (sampling.powi(2) + doubt.powi(2) + pace.powi(2)).sqrt()
        };
        let threads = workload.pool.current_num_threads();
        let before = memory + THREAD_MEMORY * threads as f64;
        let [least, most] = frame_memory(workload.renderer.scene(), workload.renderer.settings())
            .map(|bytes| before + 2.0 * bytes as f64);
        Estimate {
            threads,
            seconds_within: within(|frame| frame.seconds, doubt_of_seconds, PACE),
            bytes_within: within(|frame| frame.bytes, doubt_of_bytes, 0.0),
            frames,
            memory: Forecast {
                expected: 0.5 * (least + most),
                low: least,
                high: most,
            },
        }
    }

    /// Seconds that some frames take.
    pub fn seconds(&self, frames: &[u32]) -> Forecast {
        Forecast::within(self.sum(frames, |frame| frame.seconds), self.seconds_within)
    }

    /// Bytes of the files of some frames.
    pub fn bytes(&self, frames: &[u32]) -> Forecast {
        Forecast::within(self.sum(frames, |frame| frame.bytes), self.bytes_within)
    }

    /// The sum of a value, interpolated linearly between the frames of the pilot.
    fn sum(&self, frames: &[u32], value: fn(&PilotFrame) -> f64) -> f64 {
        let of = |frame: &u32| {
            let next = self.frames.partition_point(|known| known.frame < *frame);
            let after = self.frames.get(next).or(self.frames.last());
            let before = next
                .checked_sub(1)
                .map_or(after, |last| self.frames.get(last));
            let (Some(before), Some(after)) = (before, after) else {
                return 0.0;
            };
            let span = f64::from(after.frame) - f64::from(before.frame);
            let t = match span > 0.0 {
                true => ((f64::from(*frame) - f64::from(before.frame)) / span).min(1.0),
                false => 0.0,
            };
            value(before) + t * (value(after) - value(before))
        };
        frames.iter().map(of).sum()
    }
}

/// Relative half width of the 95 % confidence interval of the mean of `count` values, of which these are evenly spread.
/// Their variance is taken from differences of neighbours (von Neumann 1941): how they change along the path is no
/// noise.
fn error_of_mean(values: &[f64], count: u32) -> f64 {
    let known = values.len() as f64;
    let Some(degrees) = (values.len() as u32)
        .checked_sub(1)
        .filter(|degrees| *degrees > 0)
    else {
        return if count > 1 { f64::INFINITY } else { 0.0 };
    };
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    let variance = steps.sum::<f64>() / (2.0 * f64::from(degrees));
    let unknown = 1.0 - known / f64::from(count);
    student_t(degrees, 0.05) * (variance * unknown / known).sqrt() / mean(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    fn estimate(frames: &[(u32, f64)]) -> Estimate {
        let frames = frames.iter().map(|&(frame, seconds)| PilotFrame {
            frame,
            seconds,
            bytes: 10.0,
        });
        Estimate {
            threads: 1,
            frames: frames.collect(),
            seconds_within: 0.25,
            bytes_within: 0.1,
            memory: Forecast::within(1.0, 0.1),
        }
    }

    #[test]
    fn frames_between_cost_something_between() {
        let estimate = estimate(&[(1, 2.0), (3, 4.0)]);
        for (frames, seconds) in [
            (&[0][..], 2.0),
            (&[1], 2.0),
            (&[2], 3.0),
            (&[3], 4.0),
            (&[9], 4.0),
        ] {
            assert_eq!(estimate.seconds(frames).expected, seconds, "{frames:?}");
        }
        let all = estimate.seconds(&[0, 1, 2, 3, 4]);
        assert_eq!((all.expected, all.low, all.high), (15.0, 12.0, 18.75));
        assert_eq!(estimate.bytes(&[0, 2]).expected, 20.0);
    }

    #[test]
    fn what_is_known_of_all_is_certain() {
        assert_eq!(error_of_mean(&[1.0, 2.0, 3.0], 3), 0.0);
        assert_eq!(error_of_mean(&[5.0], 1), 0.0);
        assert_eq!(error_of_mean(&[5.0], 2), f64::INFINITY);
    }

    /// Values that rise evenly and have noise: the mean of the middles of parts is within the error of the mean
    /// of all, in about 19 of 20 cases.
    #[test]
    fn means_are_as_certain_as_they_say() {
        let mut random = Random::new(1);
        let mut noise = || f64::from(random.unit());
        let mut held = 0;
        for _ in 0..400 {
            let all: Vec<f64> = (0..240)
                .map(|i| 1.0 + f64::from(i) / 240.0 + noise())
                .collect();
            let known: Vec<f64> = (0..12).map(|part| all[10 + 20 * part]).collect();
            let off = (mean(&known) / mean(&all) - 1.0).abs();
            held += u32::from(off <= error_of_mean(&known, 240));
        }
        assert!((370..=399).contains(&held), "{held}");
    }
}
