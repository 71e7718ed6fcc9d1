//! The syntax of the lights of scene files: point lights, which have no name before their brackets, and `sun(...)`.

use super::check::Triple;
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::fmt;

/// A light.
pub(super) enum LightFile {
    Point(PointFile),
    Sun(SunFile),
}

pub(super) struct PointFile {
    pub(super) position: Triple,
    pub(super) intensity: Triple,
    pub(super) falloff: FalloffFile,
    pub(super) radius: f64,
    pub(super) spot: Option<SpotFile>,
}

pub(super) struct SunFile {
    pub(super) direction: Triple,
    pub(super) irradiance: Triple,
    pub(super) angle: f64,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename = "Falloff", rename_all = "snake_case")]
pub(super) enum FalloffFile {
    #[default]
    InverseSquare,
    Constant,
}

#[derive(Deserialize)]
#[serde(rename = "Spot", deny_unknown_fields)]
pub(super) struct SpotFile {
    pub(super) direction: Triple,
    #[serde(default)]
    pub(super) inner: f64,
    #[serde(default = "outer")]
    pub(super) outer: f64,
}

/// The default of glTF.
fn outer() -> f64 {
    45.0
}

/// The fields of all kinds: which are there says which it is, as the parser keeps no name.
#[derive(Deserialize)]
#[serde(rename = "Light", deny_unknown_fields)]
struct Fields {
    position: Option<Triple>,
    intensity: Option<Triple>,
    falloff: Option<FalloffFile>,
    radius: Option<f64>,
    spot: Option<SpotFile>,
    direction: Option<Triple>,
    irradiance: Option<Triple>,
    angle: Option<f64>,
}

impl Fields {
    fn light(self) -> Result<LightFile, String> {
        let missing = |field: &str, kind: &str| format!("missing field `{field}` of {kind}");
        let of_sun = [
            self.direction.is_some(),
            self.irradiance.is_some(),
            self.angle.is_some(),
        ];
        let of_point = [
            self.position.is_some(),
            self.intensity.is_some(),
            self.falloff.is_some(),
            self.radius.is_some(),
            self.spot.is_some(),
        ];
        if !of_sun.contains(&true) {
            let kind = "a point light (a sun is `sun(direction: ..., irradiance: ...)`)";
            return Ok(LightFile::Point(PointFile {
                position: self.position.ok_or_else(|| missing("position", kind))?,
                intensity: self.intensity.ok_or_else(|| missing("intensity", kind))?,
                falloff: self.falloff.unwrap_or_default(),
                radius: self.radius.unwrap_or(0.0),
                spot: self.spot,
            }));
        }
        if of_point.contains(&true) {
            let message = "a sun has direction, irradiance and angle; a point light has position, \
                           intensity, falloff, radius and spot";
            return Err(message.to_owned());
        }
        Ok(LightFile::Sun(SunFile {
            direction: self
                .direction
                .ok_or_else(|| missing("direction", "a sun"))?,
            irradiance: self
                .irradiance
                .ok_or_else(|| missing("irradiance", "a sun"))?,
            angle: self.angle.unwrap_or(0.0),
        }))
    }
}

impl<'de> Deserialize<'de> for LightFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<LightFile, D::Error> {
        struct Light;

        impl<'de> Visitor<'de> for Light {
            type Value = LightFile;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a light: (position: ..., intensity: ...) or sun(direction: ..., irradiance: ...)")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<LightFile, A::Error> {
                let fields = Fields::deserialize(MapAccessDeserializer::new(map))?;
                fields.light().map_err(A::Error::custom)
            }
        }

        deserializer.deserialize_any(Light)
    }
}
