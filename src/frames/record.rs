//! The record of a frame, which is the metadata of its file.

use crate::render::FrameErrorEstimate;
use serde::{Deserialize, Serialize};

/// What a frame is made from, a hash of its pixels, and its error; the metadata of the frame's file.
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
    pub pixel_hash: String,
    /// Its estimated error.
    pub error: FrameError,
}

/// The error of a frame, as [`FrameErrorEstimate`] defines it, to five digits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Error")]
pub struct FrameError {
    /// relMSE.
    pub rel_mse: f64,
    /// Lower end of the 95 % confidence interval.
    pub low: f64,
    /// Upper end of the 95 % confidence interval.
    pub high: f64,
    /// relMSE of the worst block of 8 x 8 pixels.
    pub worst_block: f64,
    /// relMSE after each such block is replaced by its mean.
    pub blurred: f64,
}

impl FrameRecord {
    /// The metadata: the record and a hash of it.
    pub(super) fn to_text(&self) -> Result<String, ron::Error> {
        let text = ron::ser::to_string(self)?;
        let hash = blake3::hash(text.as_bytes());
        Ok(format!("{text} {hash}"))
    }

    /// The record of metadata; none if it is no record, or was changed.
    pub(super) fn from_text(text: &str) -> Option<FrameRecord> {
        let (text, hash) = text.rsplit_once(' ')?;
        let is_whole = blake3::hash(text.as_bytes()).to_string() == hash;
        ron::from_str(text).ok().filter(|_| is_whole)
    }
}

impl From<FrameErrorEstimate> for FrameError {
    fn from(error: FrameErrorEstimate) -> FrameError {
        let [low, high] = error.whole.interval().map(five_digits);
        FrameError {
            rel_mse: five_digits(error.whole.rel_mse),
            low,
            high,
            worst_block: five_digits(error.worst_block),
            blurred: five_digits(error.blurred),
        }
    }
}

fn five_digits(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::ErrorEstimate;

    #[test]
    fn metadata_gives_back_the_record() {
        let error = FrameError::from(FrameErrorEstimate {
            whole: ErrorEstimate {
                rel_mse: 0.001_234_567,
                standard_error: 1e-5,
            },
            worst_block: 0.1,
            blurred: 1e-6,
        });
        let record = FrameRecord {
            frame: 7,
            build: "0123".to_owned(),
            input_hash: "ab".to_owned(),
            pixel_hash: "cd".to_owned(),
            error,
        };
        let text = record.to_text().expect("plain numbers");
        assert_eq!(FrameRecord::from_text(&text), Some(record), "{text}");
        assert_eq!(error.rel_mse, 0.001_234_6);
        assert_eq!([error.low, error.high], [0.001_215, 0.001_254_3]);
        for other in ["Software", "", "Frame(frame:7) ab"] {
            assert_eq!(FrameRecord::from_text(other), None);
        }
    }
}
