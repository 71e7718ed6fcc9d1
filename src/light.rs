//! Point lights.

use glam::Vec3;
use std::f32::consts::PI;

/// How a light's colour falls off with distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// I / (pi d^2): physical; the intensity is in W/sr. The 1/pi is that of the Lambert BRDF.
    InverseSquare,
    /// I at every distance.
    Constant,
}

/// An isotropic point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Position, relative to the scene's origin, in metres.
    pub position: Vec3,
    /// Linear RGB intensity I.
    pub intensity: Vec3,
    /// How its colour falls off with distance.
    pub falloff: Falloff,
}

impl PointLight {
    /// The light's colour C at a squared distance: the factor on kd cos.
    ///
    /// Black where it would not be finite: at the light itself there is no direction to it.
    #[inline]
    pub fn color_at(&self, distance_squared: f32) -> Vec3 {
        let color = match self.falloff {
            Falloff::InverseSquare => self.intensity / (PI * distance_squared),
            Falloff::Constant => self.intensity,
        };
        if color.is_finite() && distance_squared > 0.0 {
            color
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
        assert_eq!(light.color_at(4.0), Vec3::splat(0.25));
        for d2 in [0.0, 1e-40, 1e-45] {
            assert_eq!(light.color_at(d2), Vec3::ZERO);
        }
        assert!(light.color_at(1e38).x > 0.0);
        light.falloff = Falloff::Constant;
        assert_eq!(light.color_at(4.0), Vec3::splat(PI));
        assert_eq!(light.color_at(0.0), Vec3::ZERO);
    }
}
