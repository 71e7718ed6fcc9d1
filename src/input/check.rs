//! Range checks of single values of a file, with errors that name the value.

use super::error::InputError;
use glam::{DVec3, Vec3};
use std::path::Path;

/// A triple in a file: (x, y, z) or (r, g, b).
pub(crate) type Triple = (f64, f64, f64);

/// The largest magnitude of a number: beyond it, coordinates lose too much to rounding, or overflow when squared.
pub(crate) const MAX_MAGNITUDE: f64 = 1e15;

/// The smallest size: below it, sizes vanish when squared or in single precision.
pub(crate) const MIN_SIZE: f64 = 1e-15;

/// Checks values of one file.
#[derive(Clone, Copy)]
pub(crate) struct Checker<'a> {
    pub(crate) file: &'a Path,
}

impl Checker<'_> {
    /// An error about the value at `key`.
    pub(crate) fn refuse<T>(self, key: &str, message: impl Into<String>) -> Result<T, InputError> {
        Err(InputError::Value {
            file: self.file.to_owned(),
            key: key.to_owned(),
            message: message.into(),
        })
    }

    /// A number in `least..=most`.
    pub(crate) fn range(
        self,
        key: &str,
        value: f64,
        least: f64,
        most: f64,
    ) -> Result<f64, InputError> {
        if value >= least && value <= most {
            return Ok(value);
        }
        self.refuse(key, format!("{value} is not between {least} and {most}"))
    }

    /// A size or a rate, in [`MIN_SIZE`]..=[`MAX_MAGNITUDE`].
    pub(crate) fn positive(self, key: &str, value: f64) -> Result<f64, InputError> {
        if (MIN_SIZE..=MAX_MAGNITUDE).contains(&value) {
            return Ok(value);
        }
        let message = if value > 0.0 {
            format!("{value:e} is not between {MIN_SIZE:e} and {MAX_MAGNITUDE:e}")
        } else {
            format!("{value} is not a number above 0")
        };
        self.refuse(key, message)
    }

    /// A vertical field of view in degrees, in radians.
    pub(crate) fn field_of_view(self, key: &str, degrees: f64) -> Result<f64, InputError> {
        if degrees > 0.0 && degrees < 180.0 {
            return Ok(degrees.to_radians());
        }
        let message = format!("{degrees} degrees; a vertical field of view lies between 0 and 180");
        self.refuse(key, message)
    }

    /// A point, direction or set of angles, each number of at most [`MAX_MAGNITUDE`].
    pub(crate) fn vector(self, key: &str, (x, y, z): Triple) -> Result<DVec3, InputError> {
        let vector = DVec3::new(x, y, z);
        if vector.is_finite() && vector.abs().max_element() <= MAX_MAGNITUDE {
            return Ok(vector);
        }
        self.refuse(
            key,
            format!("({x}, {y}, {z}): every number must lie between -{MAX_MAGNITUDE:e} and {MAX_MAGNITUDE:e}"),
        )
    }

    /// A colour with channels in `0..=most`.
    pub(crate) fn color(self, key: &str, rgb: Triple, most: f64) -> Result<Vec3, InputError> {
        let (r, g, b) = rgb;
        let color = DVec3::new(r, g, b);
        if color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= most {
            return Ok(color.as_vec3());
        }
        let most = if most == 1.0 {
            "1".to_owned()
        } else {
            format!("{most:e}")
        };
        self.refuse(
            key,
            format!("({r}, {g}, {b}): every channel must lie between 0 and {most}"),
        )
    }
}

/// The largest channel of a radiance or an intensity: its square is finite in single precision.
pub(crate) const MAX_RADIANCE: f64 = 1e15;
