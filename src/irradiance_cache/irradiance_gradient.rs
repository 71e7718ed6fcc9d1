//! A value with a gradient, as Ward and Heckbert 1992 ("Irradiance Gradients") extend the records of an irradiance
//! cache. Here the gradient is fitted to neighbouring records: see `bake`.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Mean incident radiance around a record as a linear function of position.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct LinearIrradiance {
    /// At the record: E / π in W/(sr m²), RGB.
    pub mean_radiance: Vec3,
    /// The gradient of each channel in W/(sr m³); it lies in the record's tangent plane.
    pub gradient: [Vec3; 3],
}

impl LinearIrradiance {
    /// The value at an offset from the record, in metres. It may be negative.
    #[inline]
    pub fn at(&self, offset: Vec3) -> Vec3 {
        self.mean_radiance + Vec3::from_array(self.gradient.map(|gradient| gradient.dot(offset)))
    }

    /// The sum with a multiple of another function.
    pub(super) fn plus(&self, factor: f32, other: &LinearIrradiance) -> LinearIrradiance {
        let gradient = |channel: usize| self.gradient[channel] + factor * other.gradient[channel];
        LinearIrradiance {
            mean_radiance: self.mean_radiance + factor * other.mean_radiance,
            gradient: [0, 1, 2].map(gradient),
        }
    }
}
