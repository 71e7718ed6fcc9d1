//! Values of options: names, times, sizes and percentages.

use crate::frames::FrameFormat;
use clap::ValueEnum;
use std::num::NonZeroUsize;
use std::str::FromStr;
use std::time::Duration;

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum FormatArgument {
    /// 8 bits, sRGB
    Png,
    /// 16 bits, sRGB
    Png16,
    /// 32-bit floats, linear
    Exr,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum AovArgument {
    /// error_00000.exr: the estimated standard error of every pixel. With Monte Carlo noise it is half the difference of the
    /// pixel's A and B half buffers
    Error,
    /// cache_error_00000.exr: the part of it that the irradiance cache of --gi cached makes; black where frames use none
    CacheError,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum OrderArgument {
    /// As they are listed
    Sequential,
    /// Every 2^n-th frame of the path first, then those between: an interrupted run can be watched, and its ETA soon
    /// knows the whole path
    CoarseToFine,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PrepareArgument {
    /// Write sequence.ron, the record of the expected frames
    Sequence,
    /// The same, and bake the irradiance cache of --gi cached if it is needed
    Cache,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressArgument {
    /// A bar on a terminal, a line a minute elsewhere
    Auto,
    /// The lines that Open Job Description reads, on stdout
    Openjd,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ListFormatArgument {
    /// One frame a line
    List,
    /// Tasks of a Slurm array, as in 0,3-5
    Slurm,
    /// Frames and ranges, as in 0,3-5, for Open Job Description and for --frames
    Openjd,
}

impl From<FormatArgument> for FrameFormat {
    fn from(format: FormatArgument) -> FrameFormat {
        match format {
            FormatArgument::Png => FrameFormat::Png,
            FormatArgument::Png16 => FrameFormat::Png16,
            FormatArgument::Exr => FrameFormat::Exr,
        }
    }
}

/// A duration, as in 2h or 90min; above 0.
pub(super) fn parse_time(text: &str) -> Result<Duration, String> {
    let time = humantime::parse_duration(text).map_err(|error| error.to_string())?;
    match time.is_zero() {
        true => Err("the time must be above 0".to_owned()),
        false => Ok(time),
    }
}

/// A number of frames, or a percentage of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SampleSize {
    /// A fraction of all.
    Fraction(f64),
    Count(u32),
}

impl FromStr for SampleSize {
    type Err = String;

    fn from_str(text: &str) -> Result<SampleSize, String> {
        let wrong = || "write a number, as in 5, or a percentage, as in 1%".to_owned();
        match text.strip_suffix('%') {
            Some(percent) => {
                let percent: f64 = percent.parse().map_err(|_| wrong())?;
                let is_valid = percent > 0.0 && percent <= 100.0;
                is_valid
                    .then_some(SampleSize::Fraction(percent / 100.0))
                    .ok_or_else(wrong)
            }
            None => text.parse().map(SampleSize::Count).map_err(|_| wrong()),
        }
    }
}

impl SampleSize {
    /// How many of `all`, 1 at least.
    pub(super) fn of(self, all: usize) -> usize {
        let count = match self {
            SampleSize::Fraction(fraction) => (fraction * all as f64).ceil() as usize,
            SampleSize::Count(count) => count as usize,
        };
        count.clamp(1, all.max(1))
    }
}

/// A distance in metres.
pub(super) fn parse_distance(text: &str) -> Result<f64, String> {
    let metres = text.parse().ok();
    let metres = metres.filter(|metres: &f64| metres.is_finite() && *metres >= 0.0);
    metres.ok_or_else(|| "write a number of metres, as in 0.1".to_owned())
}

/// A number of threads: more than any machine has are a mistake.
pub(super) fn parse_threads(text: &str) -> Result<NonZeroUsize, String> {
    const MOST: usize = 4096;
    let threads = text.parse().ok();
    let threads = threads.filter(|threads: &NonZeroUsize| threads.get() <= MOST);
    threads.ok_or_else(|| format!("write a number from 1 to {MOST}"))
}

pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once(['x', 'X']);
    let numbers = parts.and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    numbers.ok_or_else(|| "write columns and rows, as in 1280x720".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_samples() {
        assert_eq!(parse_time("1h 30min"), Ok(Duration::from_secs(5400)));
        for wrong in ["2", "h", "-1h", "0s", ""] {
            assert!(parse_time(wrong).is_err(), "{wrong}");
        }
        let of = |text: &str, all| text.parse::<SampleSize>().map(|size| size.of(all));
        assert_eq!(of("1%", 240), Ok(3));
        assert_eq!(of("100%", 240), Ok(240));
        assert_eq!(of("5", 240), Ok(5));
        assert_eq!(of("5", 3), Ok(3));
        assert_eq!(of("0", 3), Ok(1));
        for wrong in ["0%", "101%", "NaN%", "-1", "1.5", "%"] {
            assert!(of(wrong, 9).is_err(), "{wrong}");
        }
    }

    #[test]
    fn distances() {
        assert_eq!(parse_distance("0.25"), Ok(0.25));
        assert_eq!(parse_distance("0"), Ok(0.0));
        for wrong in ["-1", "NaN", "inf", "1m", ""] {
            assert!(parse_distance(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes() {
        assert_eq!(parse_size("1280x720"), Ok((1280, 720)));
        for wrong in ["1280", "x", "12x", "-1x2", "1.5x2", "1x2x3"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }
}
