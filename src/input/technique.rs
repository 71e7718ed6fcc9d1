//! The rendering techniques by the names that files and the command line use.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The rendering technique and the default camera samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Mode {
    /// Whitted ray tracing: direct light, a constant ambient term and mirror reflection; one sample in the middle of the
    /// pixel.
    #[default]
    Raytracing,
    /// As `Raytracing`, with samples all over the pixel, as many as it takes.
    Supersampling,
    /// Global illumination: indirect diffuse light by Monte Carlo integration; samples as in `Supersampling`.
    Montecarlo,
    /// Another name of `Montecarlo`, since that is supersampled, too.
    MontecarloSupersampling,
}

impl Mode {
    const NAMES: [(&'static str, Mode); 4] = [
        ("raytracing", Mode::Raytracing),
        ("supersampling", Mode::Supersampling),
        ("montecarlo", Mode::Montecarlo),
        ("montecarlo-supersampling", Mode::MontecarloSupersampling),
    ];
}

impl FromStr for Mode {
    type Err = String;

    fn from_str(name: &str) -> Result<Mode, String> {
        let found = Mode::NAMES.into_iter().find(|(n, _)| *n == name);
        found.map(|(_, mode)| mode).ok_or_else(|| {
            let names = Mode::NAMES.map(|(name, _)| name).join(", ");
            format!("no mode is called \"{name}\"; there are: {names}")
        })
    }
}

impl TryFrom<String> for Mode {
    type Error = String;

    fn try_from(name: String) -> Result<Mode, String> {
        name.parse()
    }
}

impl From<Mode> for String {
    fn from(mode: Mode) -> String {
        mode.to_string()
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let found = Mode::NAMES.into_iter().find(|(_, mode)| mode == self);
        f.write_str(found.map_or("", |(name, _)| name))
    }
}

/// How the montecarlo modes compute indirect diffuse light at the points that the camera sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum GlobalIllumination {
    /// By path tracing from every camera sample: unbiased.
    PathTraced,
    /// From an irradiance cache, baked once for the whole sequence.
    Cached,
}

impl FromStr for GlobalIllumination {
    type Err = String;

    fn from_str(name: &str) -> Result<GlobalIllumination, String> {
        match name {
            "path-traced" => Ok(GlobalIllumination::PathTraced),
            "cached" => Ok(GlobalIllumination::Cached),
            _ => Err(format!("\"{name}\" is neither path-traced nor cached")),
        }
    }
}

impl From<GlobalIllumination> for String {
    fn from(gi: GlobalIllumination) -> String {
        match gi {
            GlobalIllumination::PathTraced => "path-traced".to_owned(),
            GlobalIllumination::Cached => "cached".to_owned(),
        }
    }
}

impl TryFrom<String> for GlobalIllumination {
    type Error = String;

    fn try_from(name: String) -> Result<GlobalIllumination, String> {
        name.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_has_one_name() {
        for (name, mode) in Mode::NAMES {
            assert_eq!(name.parse(), Ok(mode));
            assert_eq!(mode.to_string(), name);
        }
        assert!(
            "Raytracing"
                .parse::<Mode>()
                .is_err_and(|e| e.contains("montecarlo"))
        );
    }
}
