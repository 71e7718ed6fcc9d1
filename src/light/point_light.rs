//! Point lights.

use glam::Vec3;
use std::f32::consts::PI;

/// How irradiance falls off with the distance from a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// E / pi = I / (pi d^2): physical; the intensity I is in W/sr. The 1/pi is that of the Lambert BRDF.
    InverseSquare,
    /// E / pi = I at every distance; I is in W/(sr m²).
    Constant,
}

/// An isotropic point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Position in scene space, in metres.
    pub position: Vec3,
    /// Intensity I, linear RGB; its unit is that of the falloff.
    pub intensity: Vec3,
    /// How irradiance falls off with distance.
    pub falloff: Falloff,
}

impl PointLight {
    /// E / pi at a squared distance in m², of a surface that faces the light: the factor on kd cos, in W/(sr m²).
    ///
    /// Black where it would not be finite: at the light itself there is no direction to it.
    #[inline(always)]
    pub fn irradiance_over_pi(&self, distance_squared: f32) -> Vec3 {
        let value = match self.falloff {
            Falloff::InverseSquare => self.intensity / (PI * distance_squared),
            Falloff::Constant => self.intensity,
        };
        if value.is_finite() && distance_squared > 0.0 {
            value
        } else {
            Vec3::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_off_as_declared_and_stays_finite() {
        let mut light = PointLight {
            position: Vec3::ZERO,
            intensity: Vec3::splat(PI),
            falloff: Falloff::InverseSquare,
        };
        assert_eq!(light.irradiance_over_pi(4.0), Vec3::splat(0.25));
        for d2 in [0.0, 1e-40, 1e-45] {
            assert_eq!(light.irradiance_over_pi(d2), Vec3::ZERO);
        }
        assert!(light.irradiance_over_pi(1e38).x > 0.0);
        light.falloff = Falloff::Constant;
        assert_eq!(light.irradiance_over_pi(4.0), Vec3::splat(PI));
        assert_eq!(light.irradiance_over_pi(0.0), Vec3::ZERO);
    }
}
