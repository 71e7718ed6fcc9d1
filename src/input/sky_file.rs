//! The sky of a scene file: the syntax of `background`, its checks, and its image.

use super::check::{Checker, MAX_MAGNITUDE, MAX_RADIANCE, Triple};
use super::error::InputError;
use super::files::{InputFiles, relative_to};
use super::sky_map_file;
use crate::light::{Sky, SkyGradient};
use serde::Deserialize;
use serde::de::{Deserializer, EnumAccess, Error, VariantAccess, Visitor};
use std::fmt;

/// A colour, `gradient(...)` or `map(...)`.
pub(super) enum SkyFile {
    Uniform(Triple),
    Gradient(GradientFile),
    Map(MapFile),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GradientFile {
    zenith: Triple,
    horizon: Triple,
    nadir: Option<Triple>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MapFile {
    file: String,
    #[serde(default = "one")]
    intensity: f64,
    #[serde(default)]
    rotation: f64,
}

fn one() -> f64 {
    1.0
}

impl Default for SkyFile {
    fn default() -> SkyFile {
        SkyFile::Uniform(Triple::default())
    }
}

impl<'de> Deserialize<'de> for SkyFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<SkyFile, D::Error> {
        deserializer.deserialize_enum("Background", &KINDS, SkyVisitor)
    }
}

const KINDS: [&str; 2] = ["gradient", "map"];

/// The name in front of the bracket; none for a colour, which so is a variant without a name.
struct Kind(Option<String>);

impl<'de> Deserialize<'de> for Kind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Kind, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = String;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a name")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<String, E> {
                Ok(name.to_owned())
            }
        }

        Ok(Kind(deserializer.deserialize_identifier(Name).ok()))
    }
}

struct SkyVisitor;

impl<'de> Visitor<'de> for SkyVisitor {
    type Value = SkyFile;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a colour, `gradient(...)` or `map(...)`")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<SkyFile, A::Error> {
        let (Kind(name), content) = access.variant()?;
        match name.as_deref() {
            None => content.newtype_variant().map(SkyFile::Uniform),
            Some("gradient") => content.newtype_variant().map(SkyFile::Gradient),
            Some("map") => content.newtype_variant().map(SkyFile::Map),
            Some(other) => Err(A::Error::unknown_variant(other, &KINDS)),
        }
    }
}

/// The sky of a scene file, with its image read.
pub(super) fn load(
    sky: &SkyFile,
    check: Checker,
    files: &mut InputFiles,
) -> Result<Sky, InputError> {
    let key = |field: &str| format!("background.{field}");
    match sky {
        SkyFile::Uniform(rgb) => {
            let radiance = check.color("background", *rgb, MAX_RADIANCE)?;
            Ok(Sky::Uniform(radiance))
        }
        SkyFile::Gradient(gradient) => {
            let color = |field: &str, rgb| check.color(&key(field), rgb, MAX_RADIANCE);
            let zenith = color("zenith", gradient.zenith)?;
            let horizon = color("horizon", gradient.horizon)?;
            let nadir = color("nadir", gradient.nadir.unwrap_or(gradient.horizon))?;
            Ok(Sky::Gradient(SkyGradient::new(zenith, horizon, nadir)))
        }
        SkyFile::Map(map) => {
            let intensity = check.range(&key("intensity"), map.intensity, 0.0, MAX_RADIANCE)?;
            let most = MAX_MAGNITUDE;
            let degrees = check.range(&key("rotation"), map.rotation, -most, most)?;
            // Less than a turn, so that radians lose nothing.
            let rotation = (degrees % 360.0).to_radians();
            let file = relative_to(check.file, &map.file);
            let bytes = files.read_reference(&file, check.file, &key("file"))?;
            sky_map_file::decode(&file, &bytes, intensity, rotation).map(Sky::Map)
        }
    }
}
