//! Lights that settings add to those of the scene.

use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A light that is not in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum ExtraLight {
    /// A headlight, which the camera carries: it shows what is there where nothing else shines.
    Camera,
}

impl FromStr for ExtraLight {
    type Err = String;

    fn from_str(name: &str) -> Result<ExtraLight, String> {
        match name {
            "camera" => Ok(ExtraLight::Camera),
            _ => Err(format!("no light is called \"{name}\"; there is: camera")),
        }
    }
}

impl TryFrom<String> for ExtraLight {
    type Error = String;

    fn try_from(name: String) -> Result<ExtraLight, String> {
        name.parse()
    }
}

impl From<ExtraLight> for String {
    fn from(ExtraLight::Camera: ExtraLight) -> String {
        "camera".to_owned()
    }
}
