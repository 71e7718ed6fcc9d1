use crate::render::ErrorEstimate;
use serde::{Deserialize, Serialize};

/// What a frame's file says of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Frame")]
pub struct FrameRecord {
    /// Its number.
    pub frame: u32,
    /// How far chance may have moved it; none where nothing was left to chance.
    pub error: Option<FrameError>,
}

/// The error of a frame, as [`ErrorEstimate`] defines it, to five digits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Error")]
pub struct FrameError {
    /// relMSE.
    pub relative_square_error: f64,
    /// The error is between this...
    pub low: f64,
    /// ...and this, 19 times of 20.
    pub high: f64,
}

impl FrameRecord {
    /// Of a frame and the error that was estimated for it.
    pub fn new(frame: u32, error: Option<ErrorEstimate>) -> FrameRecord {
        let error = error.map(|error| {
            let [low, high] = error.interval().map(five_digits);
            let relative_square_error = five_digits(error.relative_square_error);
            FrameError {
                relative_square_error,
                low,
                high,
            }
        });
        FrameRecord { frame, error }
    }

    /// The text that the file carries.
    pub(super) fn to_text(self) -> Result<String, ron::Error> {
        ron::ser::to_string(&self)
    }

    /// What a text says; none if it is no record.
    pub(super) fn from_text(text: &str) -> Option<FrameRecord> {
        ron::from_str(text).ok()
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
            let record = FrameRecord::new(7, error);
            let text = record.to_text().expect("plain numbers");
            assert_eq!(FrameRecord::from_text(&text), Some(record), "{text}");
        }
        let error = FrameRecord::new(7, Some(estimate)).error.expect("given");
        assert_eq!(error.relative_square_error, 0.001_234_6);
        assert_eq!([error.low, error.high], [0.001_215, 0.001_254_2]);
        assert_eq!(FrameRecord::from_text("Software"), None);
    }
}
