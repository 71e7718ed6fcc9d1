//! Frame numbers as runs, for messages.

use std::fmt;

/// The most runs that are listed; the frames of further ones are counted.
const MAX_RUNS: usize = 8;

/// Some frames of a path, at least one, as runs without gaps.
///
/// Written as "frame 7" or "frames 120-131, 140 and 150".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameRuns(Vec<[u32; 2]>);

impl FrameRuns {
    /// Frames by their numbers, rising.
    pub(super) fn of(numbers: impl IntoIterator<Item = u32>) -> FrameRuns {
        let mut runs: Vec<[u32; 2]> = Vec::new();
        for number in numbers {
            match runs.last_mut() {
                Some([_, last]) if *last + 1 == number => *last = number,
                _ => runs.push([number, number]),
            }
        }
        FrameRuns(runs)
    }

    /// The first and the last frame of each run, rising.
    pub fn runs(&self) -> &[[u32; 2]] {
        &self.0
    }

    /// How many frames there are.
    pub fn count(&self) -> u32 {
        self.0.iter().map(|[first, last]| last - first + 1).sum()
    }
}

impl fmt::Display for FrameRuns {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (listed, others) = self.0.split_at(self.0.len().min(MAX_RUNS));
        let mut runs: Vec<String> = listed
            .iter()
            .map(|[first, last]| match first == last {
                true => first.to_string(),
                false => format!("{first}-{last}"),
            })
            .collect();
        if !others.is_empty() {
            runs.push(format!("{} others", FrameRuns(others.to_vec()).count()));
        }
        let plural = if self.count() == 1 { "" } else { "s" };
        write!(f, "frame{plural} ")?;
        match runs.split_last() {
            Some((last, before)) if !before.is_empty() => {
                write!(f, "{} and {last}", before.join(", "))
            }
            _ => f.write_str(&runs.concat()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_written_as_runs() {
        let written = |numbers: &[u32]| FrameRuns::of(numbers.iter().copied()).to_string();
        assert_eq!(written(&[7]), "frame 7");
        assert_eq!(written(&[7, 8]), "frames 7-8");
        assert_eq!(written(&[0, 9]), "frames 0 and 9");
        assert_eq!(written(&[1, 2, 3, 5, 9, 10]), "frames 1-3, 5 and 9-10");
        let odd: Vec<u32> = (0..20).map(|i| 2 * i + 1).collect();
        assert_eq!(
            written(&odd),
            "frames 1, 3, 5, 7, 9, 11, 13, 15 and 12 others"
        );
    }

    #[test]
    fn runs_hold_every_frame_once() {
        let frames = FrameRuns::of([3, 4, 5, 8]);
        assert_eq!(frames.runs(), [[3, 5], [8, 8]]);
        assert_eq!(frames.count(), 4);
    }
}
