//! Lists of frames as the user writes them.

use std::str::FromStr;

/// Numbered frames as the user lists them: `7`, `0-99`, `0-99:2`, several with commas. Both ends
/// belong to a range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FrameRanges(Vec<(u32, u32, u32)>);

impl FromStr for FrameRanges {
    type Err = String;

    fn from_str(text: &str) -> Result<FrameRanges, String> {
        let ranges = text.split(',').map(|part| {
            parse_range(part.trim()).ok_or_else(|| {
                format!("\"{part}\" is not a frame or range as in 7, 0-99 or 0-99:2")
            })
        });
        ranges.collect::<Result<_, _>>().map(FrameRanges)
    }
}

fn parse_range(text: &str) -> Option<(u32, u32, u32)> {
    let (ends, step) = match text.split_once(':') {
        Some((ends, step)) => (ends, step.parse().ok()?),
        None => (text, 1),
    };
    let (first, last) = match ends.split_once('-') {
        Some((first, last)) => (first.parse().ok()?, last.parse().ok()?),
        None => {
            let frame = ends.parse().ok()?;
            (frame, frame)
        }
    };
    (first <= last && step > 0).then_some((first, last, step))
}

impl FrameRanges {
    /// The frames of a path of `count`, in the order listed, each once.
    pub(super) fn of_path(&self, count: u32) -> Result<Vec<u32>, String> {
        self.resolve(count).map_err(|frame| {
            let last = count - 1;
            format!("--frames: there is no frame {frame}; the path has 0-{last}")
        })
    }

    /// As [`FrameRanges::of_path`], or the first that is not below `count`.
    fn resolve(&self, count: u32) -> Result<Vec<u32>, u32> {
        let mut seen = vec![false; count as usize];
        let mut frames = Vec::new();
        for &(first, last, step) in &self.0 {
            for frame in (first..=last).step_by(step as usize) {
                let seen = seen.get_mut(frame as usize).ok_or(frame)?;
                if !std::mem::replace(seen, true) {
                    frames.push(frame);
                }
            }
        }
        Ok(frames)
    }
}

/// Rising numbers as `0,3-5`.
pub(super) fn ranges(numbers: &[u32]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let runs = runs.map(|run| match *run {
        [.., last] if run.len() > 1 => format!("{}-{last}", run[0]),
        _ => run[0].to_string(),
    });
    runs.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_listed_is_what_is_read() {
        for (numbers, expected) in [
            (&[0, 3, 4, 5, 7, 8][..], "0,3-5,7-8"),
            (&[4], "4"),
            (&[0, 1, 2], "0-2"),
        ] {
            assert_eq!(ranges(numbers), expected);
            assert_eq!(frames(expected, 9), Ok(numbers.to_vec()));
        }
    }

    fn frames(text: &str, count: u32) -> Result<Vec<u32>, u32> {
        text.parse::<FrameRanges>()
            .expect("well formed")
            .resolve(count)
    }

    #[test]
    fn ranges_steps_and_lists() {
        assert_eq!(frames("0-9:4,2, 7-8", 10), Ok(vec![0, 4, 8, 2, 7]));
        assert_eq!(frames("3", 4), Ok(vec![3]));
        assert_eq!(frames("0-5", 4), Err(4));
        assert_eq!(frames("4294967295", 4), Err(u32::MAX));
    }

    #[test]
    fn refuses_what_is_no_range() {
        for wrong in ["", "a", "1-", "-3", "5-2", "1-2:0", "1,,2", "1-2-3", "1.5"] {
            assert!(wrong.parse::<FrameRanges>().is_err(), "{wrong}");
        }
    }
}
