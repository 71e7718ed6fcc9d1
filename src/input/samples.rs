//! The camera samples of a pixel as files and the command line give them.

use crate::render::PixelSampling;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// The camera samples of each pixel, where their number is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// "center": one, in the middle of the pixel.
    Center,
    /// "corners": four, in the corners, shared with the neighbours.
    Corners,
    /// So many, stratified over the pixel's square.
    Spread(u32),
}

impl From<Samples> for PixelSampling {
    fn from(samples: Samples) -> PixelSampling {
        match samples {
            Samples::Center => PixelSampling::Center,
            Samples::Corners => PixelSampling::Corners,
            Samples::Spread(count) => PixelSampling::Spread(count),
        }
    }
}

impl FromStr for Samples {
    type Err = String;

    fn from_str(text: &str) -> Result<Samples, String> {
        match text {
            "center" => Ok(Samples::Center),
            "corners" => Ok(Samples::Corners),
            number => number.parse().map(Samples::Spread).map_err(|_| {
                format!("\"{text}\" is neither a number of samples, nor center, nor corners")
            }),
        }
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Samples::Center => f.write_str("center"),
            Samples::Corners => f.write_str("corners"),
            Samples::Spread(count) => write!(f, "{count}"),
        }
    }
}

impl Serialize for Samples {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Samples::Spread(count) => serializer.serialize_u32(*count),
            named => serializer.collect_str(named),
        }
    }
}

impl<'de> Deserialize<'de> for Samples {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Samples, D::Error> {
        deserializer.deserialize_any(SamplesVisitor)
    }
}

struct SamplesVisitor;

impl Visitor<'_> for SamplesVisitor {
    type Value = Samples;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number of samples, \"center\" or \"corners\"")
    }

    fn visit_u64<E: Error>(self, count: u64) -> Result<Samples, E> {
        let count = u32::try_from(count);
        count
            .map(Samples::Spread)
            .map_err(|_| E::custom("more samples than are possible"))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Samples, E> {
        text.parse().map_err(E::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_names_are_read_as_they_are_written() {
        for (samples, text) in [
            (Samples::Center, "\"center\""),
            (Samples::Corners, "\"corners\""),
            (Samples::Spread(16), "16"),
        ] {
            assert_eq!(ron::to_string(&samples).as_deref(), Ok(text));
            assert_eq!(ron::from_str(text), Ok(samples));
            assert_eq!(samples.to_string().parse(), Ok(samples));
        }
        for text in ["-1", "1.5", "\"middle\"", "99999999999", "true"] {
            assert!(ron::from_str::<Samples>(text).is_err(), "{text}");
        }
    }
}
