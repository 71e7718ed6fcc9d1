//! The sun: a disc of uniform radiance at infinity.

use crate::math::to_world;
use crate::sampling::uniform_cone;
use glam::Vec3;

/// A disc in the sky so far away that all of the scene sees it in the same direction. It is not seen itself: it is a
/// light, not a part of the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// The unit direction to its middle.
    pub to_sun: Vec3,
    /// The irradiance of a surface that faces it, linear RGB in W/m².
    pub irradiance: Vec3,
    /// 1 less the cosine of half of its angular diameter, 0..1; 0 is a point, with hard shadows.
    pub one_minus_cos: f32,
}

impl Sun {
    /// A direction uniform over the disc, from two numbers in [0, 1), and what it adds to the irradiance of a surface
    /// that faces it: the mean of that over the numbers, times the cosines of the directions with the middle's, is
    /// [`Sun::irradiance`].
    #[inline]
    pub fn sample(&self, [u, v]: [f32; 2]) -> (Vec3, Vec3) {
        if self.one_minus_cos == 0.0 {
            return (self.to_sun, self.irradiance);
        }
        let direction = to_world(self.to_sun, uniform_cone(u, v, self.one_minus_cos));
        // Radiance E / (pi sin^2) over the pdf 1 / (2 pi (1 - cos)).
        (
            direction,
            self.irradiance * (2.0 / (2.0 - self.one_minus_cos)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::SobolSequence;

    /// The mean over the disc of radiance times cosine, for discs from a point to the whole hemisphere.
    #[test]
    fn a_facing_surface_gets_the_irradiance() {
        let sequence = SobolSequence::new(1, 0, 0, 0);
        for one_minus_cos in [0.0, 1e-10, 1e-5, 0.1, 1.0] {
            let sun = Sun {
                to_sun: Vec3::new(0.6, 0.0, -0.8),
                irradiance: Vec3::new(1.0, 2.0, 3.0),
                one_minus_cos,
            };
            let mut sum = Vec3::ZERO;
            for i in 0..4096 {
                let (direction, irradiance) = sun.sample(sequence.sample_2d(i, 0));
                assert!((direction.length() - 1.0).abs() < 1e-6);
                let cos = direction.dot(sun.to_sun);
                assert!(cos > 1.0 - one_minus_cos - 1e-6);
                sum += cos * irradiance / 4096.0;
            }
            assert!(
                (sum - sun.irradiance).length() < 1e-3,
                "{one_minus_cos}: {sum}"
            );
        }
    }
}
