//! Point lights.

use glam::Vec3;
use std::f32::consts::PI;

/// How a light's colour falls off with distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// I / (pi d^2): physical; the intensity is in W/sr.
    InverseSquare,
    /// I at every distance.
    Constant,
}

/// A light without size, alike in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// World-space position.
    pub position: Vec3,
    /// Linear RGB intensity I.
    pub intensity: Vec3,
    /// What distance does to it.
    pub falloff: Falloff,
}

impl PointLight {
    /// The light's colour C at a squared distance: what kd cos is multiplied by.
    ///
    /// Black where it would not be finite: a point at the light has no direction to it.
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
