//! Point lights: isotropic, in a cone, and with a radius.

use glam::Vec3;
use std::f32::consts::PI;
use std::f64::consts::TAU;

/// How irradiance falls off with the distance from a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// E / pi = I / (pi d^2): physical; the intensity I is in W/sr. The 1/pi is that of the Lambert BRDF.
    InverseSquare,
    /// E / pi = I at every distance; I is in W/(sr m²).
    Constant,
}

/// The cone of a spotlight: full intensity up to the inner angle from the axis, none beyond the outer one. In between it
/// falls as glTF defines it (KHR_lights_punctual): as the square of a linear function of the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The unit direction of its axis, away from the light.
    axis: Vec3,
    scale: f32,
    offset: f32,
    /// The integral of the part of the intensity over all directions, in sr.
    solid_angle: f64,
}

impl Cone {
    /// All directions: a light that is no spotlight.
    pub const ALL: Cone = Cone {
        axis: Vec3::ZERO,
        scale: 0.0,
        offset: 1.0,
        solid_angle: 4.0 * std::f64::consts::PI,
    };

    /// The cone around a unit direction, of angles from the axis in radians, 0 <= inner <= outer <= pi.
    pub fn new(axis: Vec3, inner: f64, outer: f64) -> Cone {
        let (cos_inner, cos_outer) = (libm::cos(inner), libm::cos(outer));
        // glTF's bound: the edge of a hard cone is no narrower.
        let scale = 1.0 / (cos_inner - cos_outer).max(0.001);
        Cone {
            axis,
            scale: scale as f32,
            offset: (-cos_outer * scale) as f32,
            // All of the inner part, a third of the rest.
            solid_angle: TAU * (1.0 - cos_inner + (cos_inner - cos_outer) / 3.0),
        }
    }

    /// The power of a light with a mean intensity of 1 W/sr up to the inner angle, in W.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The part of the intensity, 0..1, in a unit direction away from the light.
    #[inline(always)]
    pub fn attenuation(&self, direction: Vec3) -> f32 {
        // Most lights: it costs them nothing.
        if self.scale == 0.0 {
            return self.offset;
        }
        let linear = (direction.dot(self.axis) * self.scale + self.offset).clamp(0.0, 1.0);
        linear * linear
    }
}

/// A point light, in all directions or in those of a cone; with a radius a ball, which throws soft shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Position in scene space, in metres.
    pub position: Vec3,
    /// Intensity I, linear RGB; its unit is that of the falloff.
    pub intensity: Vec3,
    /// How irradiance falls off with distance.
    pub falloff: Falloff,
    /// The directions in which it shines.
    pub cone: Cone,
    /// The radius, in metres, of the ball that has the light's power; 0 of a point. Rays pass through the ball. It falls off
    /// by the inverse square.
    pub radius: f32,
}

impl PointLight {
    /// A point that shines in all directions with an intensity in W/sr.
    pub const fn isotropic(position: Vec3, intensity: Vec3) -> PointLight {
        PointLight {
            position,
            intensity,
            falloff: Falloff::InverseSquare,
            cone: Cone::ALL,
            radius: 0.0,
        }
    }
}

impl PointLight {
    /// E / pi at a squared distance in m², in a unit direction away from the light, of a surface that faces it: the factor on
    /// kd cos, in W/(sr m²).
    ///
    /// Black where it would not be finite: at the light itself there is no direction to it.
    #[inline(always)]
    pub fn irradiance_over_pi(&self, distance_squared: f32, direction: Vec3) -> Vec3 {
        let intensity = self.intensity * self.cone.attenuation(direction);
        let value = match self.falloff {
            Falloff::InverseSquare => intensity / (PI * distance_squared),
            Falloff::Constant => intensity,
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
        let mut light = PointLight::isotropic(Vec3::ZERO, Vec3::splat(PI));
        assert_eq!(light.irradiance_over_pi(4.0, Vec3::X), Vec3::splat(0.25));
        for d2 in [0.0, 1e-40, 1e-45] {
            assert_eq!(light.irradiance_over_pi(d2, Vec3::X), Vec3::ZERO);
        }
        assert!(light.irradiance_over_pi(1e38, Vec3::X).x > 0.0);
        light.falloff = Falloff::Constant;
        assert_eq!(light.irradiance_over_pi(4.0, Vec3::X), Vec3::splat(PI));
        assert_eq!(light.irradiance_over_pi(0.0, Vec3::X), Vec3::ZERO);
    }

    /// The formula of KHR_lights_punctual, by hand.
    #[test]
    fn cones_fall_off_as_in_gltf() {
        let cone = Cone::new(Vec3::NEG_Y, 0.3, 0.9);
        let (inner, outer) = (0.3_f32.cos(), 0.9_f32.cos());
        for degrees in 0..180 {
            let (sin, cos) = (degrees as f32).to_radians().sin_cos();
            let seen = cone.attenuation(Vec3::new(sin, -cos, 0.0));
            let expected = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
            assert!(
                (seen - expected).abs() < 1e-5,
                "{degrees}: {seen} {expected}"
            );
        }
        assert_eq!(Cone::ALL.attenuation(Vec3::X), 1.0);
        let hard = Cone::new(Vec3::X, 0.5, 0.5);
        let at = |angle: f32| hard.attenuation(Vec3::new(angle.cos(), angle.sin(), 0.0));
        assert_eq!((at(0.49), at(0.51)), (1.0, 0.0));
    }
}
