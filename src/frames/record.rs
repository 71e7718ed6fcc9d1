//! What the file of a frame says of the frame.

use crate::render::ErrorEstimate;
use serde::{Deserialize, Serialize};

/// What a frame is made from, a hash of its pixels and its error, as the frame's own file says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Frame")]
pub struct FrameRecord {
    /// Its number.
    pub frame: u32,
    /// The build of the program that rendered it.
    pub build: String,
    /// A hash of all inputs that decide its pixels: the scene's files, its camera, settings and format.
    pub input_hash: String,
    /// A hash of the file's pixels.
    pub pixels: String,
    /// Its estimated error; none where the frame has no Monte Carlo noise.
    pub error: Option<FrameError>,
}

/// The error of a frame, as [`ErrorEstimate`] defines it, to five digits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Error")]
pub struct FrameError {
    /// relMSE.
    pub relative_square_error: f64,
    /// Lower end of the 95 % confidence interval.
    pub low: f64,
    /// Upper end of the 95 % confidence interval.
    pub high: f64,
}

impl FrameRecord {
    /// The text that the file carries: the record and a hash of it.
    pub(super) fn to_text(&self) -> Result<String, ron::Error> {
        let text = ron::ser::to_string(self)?;
        let hash = blake3::hash(text.as_bytes());
        Ok(format!("{text} {hash}"))
    }

    /// What a text says; none if it is no record, or was changed.
    pub(super) fn from_text(text: &str) -> Option<FrameRecord> {
        let (text, hash) = text.rsplit_once(' ')?;
        let is_whole = blake3::hash(text.as_bytes()).to_string() == hash;
        ron::from_str(text).ok().filter(|_| is_whole)
    }
}

impl From<ErrorEstimate> for FrameError {
    fn from(error: ErrorEstimate) -> FrameError {
        let [low, high] = error.interval().map(five_digits);
        FrameError {
            relative_square_error: five_digits(error.relative_square_error),
            low,
            high,
        }
    }
}

fn five_digits(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_say_what_the_record_says() {
        let estimate = ErrorEstimate {
            relative_square_error: 0.001_234_567,
            standard_error: 1e-5,
        };
        for error in [None, Some(estimate)] {
            let record = FrameRecord {
                frame: 7,
                build: "0123".to_owned(),
                input_hash: "ab".to_owned(),
                pixels: "cd".to_owned(),
                error: error.map(FrameError::from),
            };
            let text = record.to_text().expect("plain numbers");
            assert_eq!(FrameRecord::from_text(&text), Some(record), "{text}");
        }
        let error = FrameError::from(estimate);
        assert_eq!(error.relative_square_error, 0.001_234_6);
        assert_eq!([error.low, error.high], [0.001_215, 0.001_254_2]);
        for other in ["Software", "", "Frame(frame:7) ab"] {
            assert_eq!(FrameRecord::from_text(other), None);
        }
    }
}
