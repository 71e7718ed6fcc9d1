//! The sky: the radiance of rays that leave the scene, and the choice of directions towards where it is bright.

use super::sky_gradient::SkyGradient;
use super::sky_map::SkyMap;
use crate::sampling::uniform_sphere;
use glam::Vec3;
use std::f32::consts::PI;

/// What surrounds the scene, infinitely far away. All radiances are linear RGB in W/(sr m²).
#[derive(Clone, Debug)]
pub enum Sky {
    /// The same radiance in every direction.
    Uniform(Vec3),
    /// A radiance by elevation.
    Gradient(SkyGradient),
    /// A radiance from an image.
    Map(SkyMap),
}

impl Default for Sky {
    /// Black.
    fn default() -> Sky {
        Sky::Uniform(Vec3::ZERO)
    }
}

impl Sky {
    /// The radiance that arrives from a direction, of unit length in world space: along a ray that leaves the scene.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        match self {
            Sky::Uniform(radiance) => *radiance,
            Sky::Gradient(gradient) => gradient.radiance(direction),
            Sky::Map(map) => map.radiance(direction),
        }
    }

    /// Whether no light comes from it.
    pub fn is_black(&self) -> bool {
        match self {
            Sky::Uniform(radiance) => *radiance == Vec3::ZERO,
            Sky::Gradient(gradient) => gradient.colors() == [Vec3::ZERO; 3],
            Sky::Map(map) => map.is_black(),
        }
    }

    /// The mean radiance over the sphere.
    pub fn mean_radiance(&self) -> Vec3 {
        match self {
            Sky::Uniform(radiance) => *radiance,
            Sky::Gradient(gradient) => {
                let [zenith, horizon, nadir] = gradient.colors();
                0.25 * zenith + 0.5 * horizon + 0.25 * nadir
            }
            Sky::Map(map) => map.mean(),
        }
    }

    /// A direction of unit length in world space and its [`Sky::pdf`], for two numbers in [0, 1): more often where the
    /// sky is brighter.
    ///
    /// Where rounding takes a direction to the edge of what shines, the pdf may be 0; the radiance is 0 there, too.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        let direction = match self {
            Sky::Uniform(_) => uniform_sphere(u[0], u[1]),
            Sky::Gradient(gradient) => gradient.sample(u),
            Sky::Map(map) => map.sample(u),
        };
        (direction, self.pdf(direction))
    }

    /// The pdf, over solid angle, with which [`Sky::sample`] gives a direction of unit length in world space: above 0
    /// wherever the radiance is. A black sky is sampled evenly.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        match self {
            Sky::Uniform(_) => 1.0 / (4.0 * PI),
            Sky::Gradient(gradient) => gradient.pdf(direction),
            Sky::Map(map) => map.pdf(direction),
        }
    }

    /// The memory that it takes besides its own size, in bytes.
    pub fn memory(&self) -> usize {
        match self {
            Sky::Uniform(_) => 0,
            Sky::Gradient(gradient) => gradient.memory(),
            Sky::Map(map) => map.memory(),
        }
    }
}
