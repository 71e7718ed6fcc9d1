//! The reflection of a surface at a point: diffuse, Phong highlight and mirror.

use super::features::Features;
use glam::Vec3;

/// How a surface reflects light at one point, with its texture applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    /// Diffuse reflectance, 0..1.
    pub diffuse: Vec3,
    /// Weight of the Phong highlight.
    pub specular: Vec3,
    /// Exponent of the Phong highlight.
    pub shininess: f32,
    /// Weight of the mirror, 0..1.
    pub reflective: Vec3,
}

impl Bsdf {
    /// Weight of the mirror.
    #[inline(always)]
    pub fn mirror_weight<F: Features>(&self) -> Vec3 {
        if F::MIRRORS {
            self.reflective
        } else {
            Vec3::ZERO
        }
    }

    /// Whether the base layer reflects direct light.
    #[inline(always)]
    pub fn has_direct<F: Features>(&self) -> bool {
        self.base_weight::<F>() != Vec3::ZERO
            && (self.diffuse != Vec3::ZERO || F::HIGHLIGHTS && self.specular != Vec3::ZERO)
    }

    /// Whether the base layer reflects indirect diffuse light.
    #[inline(always)]
    pub fn has_diffuse<F: Features>(&self) -> bool {
        self.base_weight::<F>() * self.diffuse != Vec3::ZERO
    }

    /// Weight of the base layer.
    #[inline(always)]
    pub fn base_weight<F: Features>(&self) -> Vec3 {
        Vec3::ONE - self.mirror_weight::<F>()
    }

    /// The mean of three, weighted by barycentric coordinates that sum to 1. It is never outside the range of the
    /// three, where rounding would take it: a mirror of more than all light leaves the base layer less than none.
    pub fn barycentric(vertices: [Bsdf; 3], weights: [f32; 3]) -> Bsdf {
        let mix = |of: fn(&Bsdf) -> Vec3| {
            let [a, b, c] = [of(&vertices[0]), of(&vertices[1]), of(&vertices[2])];
            let mean = a * weights[0] + b * weights[1] + c * weights[2];
            mean.clamp(a.min(b).min(c), a.max(b).max(c))
        };
        Bsdf {
            diffuse: mix(|r| r.diffuse),
            specular: mix(|r| r.specular),
            shininess: mix(|r| Vec3::splat(r.shininess)).x,
            reflective: mix(|r| r.reflective),
        }
    }

    /// The BRDF of the base layer times pi times the cosine: kd cos + ks (R.V)^shininess, cos = N.L, for light that
    /// arrives from `to_light` and leaves to `to_viewer` (Phong 1975). Zero for light from behind.
    #[inline(always)]
    pub fn eval_cos<F: Features>(&self, normal: Vec3, to_light: Vec3, to_viewer: Vec3) -> Vec3 {
        let [diffuse, highlight] = self.lobes_cos::<F>(normal, to_light, to_viewer);
        diffuse + highlight
    }

    /// The two terms of [`Bsdf::eval_cos`]: diffuse and highlight.
    #[inline(always)]
    pub fn lobes_cos<F: Features>(
        &self,
        normal: Vec3,
        to_light: Vec3,
        to_viewer: Vec3,
    ) -> [Vec3; 2] {
        let cos = normal.dot(to_light);
        if cos <= 0.0 {
            return [Vec3::ZERO; 2];
        }
        let highlight = if F::HIGHLIGHTS && self.specular != Vec3::ZERO {
            let highlight = reflect(to_light, normal).dot(to_viewer).max(0.0);
            self.specular * power(highlight, self.shininess)
        } else {
            Vec3::ZERO
        };
        [self.diffuse * cos, highlight]
    }
}

/// `base`, 0 or more, to the power of `exponent`, 0 or more.
///
/// Whole exponents, as most are, by repeated squaring: in a third of the time of the general function, with an error
/// below that of rounding `base`.
#[inline(always)]
fn power(base: f32, exponent: f32) -> f32 {
    const LARGE: f32 = 1024.0;
    let whole = exponent as u32;
    if whole as f32 != exponent || exponent > LARGE {
        return libm::powf(base, exponent);
    }
    let (mut rest, mut square, mut product) = (whole, base, 1.0);
    while rest != 0 {
        if rest & 1 != 0 {
            product *= square;
        }
        square *= square;
        rest >>= 1;
    }
    product
}

/// The mirror reflection of `direction` at a surface with unit `normal`; both directions point away.
#[inline(always)]
pub fn reflect(direction: Vec3, normal: Vec3) -> Vec3 {
    normal * (2.0 * normal.dot(direction)) - direction
}

#[cfg(test)]
mod tests {
    use super::super::features::FeatureMask;
    use super::*;
    use crate::sampling::Random;

    const PLASTIC: Bsdf = Bsdf {
        diffuse: Vec3::new(0.5, 0.25, 0.0),
        specular: Vec3::splat(0.5),
        shininess: 2.0,
        reflective: Vec3::ZERO,
    };

    #[test]
    fn lambert_and_phong_by_hand() {
        let sixty = Vec3::new(0.75_f32.sqrt(), 0.5, 0.0);
        // Viewer along the mirrored light: cos = 1/2, R.V = 1.
        let seen = PLASTIC.eval_cos::<FeatureMask<2>>(Vec3::Y, sixty, reflect(sixty, Vec3::Y));
        assert!((seen - Vec3::new(0.75, 0.625, 0.5)).length() < 1e-6);
        // Viewer along the normal: R.V = 1/2, squared a quarter, times 1/2.
        let seen = PLASTIC.eval_cos::<FeatureMask<2>>(Vec3::Y, sixty, Vec3::Y);
        assert!((seen - Vec3::new(0.375, 0.25, 0.125)).length() < 1e-6);
        // Light from below the surface.
        assert_eq!(
            PLASTIC.eval_cos::<FeatureMask<2>>(Vec3::Y, -sixty, Vec3::Y),
            Vec3::ZERO
        );
    }

    #[test]
    fn powers_of_whole_and_other_exponents() {
        for exponent in [
            0.0, 1.0, 2.0, 7.0, 40.0, 1023.0, 1024.0, 1025.0, 0.5, 12.25_f32,
        ] {
            for base in [0.0, 0.3, 0.9, 0.999, 1.0_f32] {
                let exact = f64::from(base).powf(exponent.into());
                let tolerance = f64::from(f32::EPSILON * exponent.max(2.0)) * exact + 1e-38;
                assert!((f64::from(power(base, exponent)) - exact).abs() <= tolerance);
            }
        }
    }

    #[test]
    fn vertices_mix_in_every_part() {
        let other = Bsdf {
            diffuse: Vec3::ONE,
            specular: Vec3::ZERO,
            shininess: 10.0,
            reflective: Vec3::X,
        };
        let mixed = Bsdf::barycentric([PLASTIC, other, other], [0.5, 0.25, 0.25]);
        assert_eq!(mixed.diffuse, Vec3::new(0.75, 0.625, 0.5));
        assert_eq!(mixed.specular, Vec3::splat(0.25));
        assert_eq!(mixed.shininess, 6.0);
        assert_eq!(mixed.reflective, Vec3::new(0.5, 0.0, 0.0));
    }

    /// Barycentric coordinates as they are rounded, at the edges and far beyond.
    #[test]
    fn mixtures_stay_within_their_vertices() {
        let mirror = Bsdf {
            diffuse: Vec3::ZERO,
            reflective: Vec3::ONE,
            ..PLASTIC
        };
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let [b, c] = [random.unit(), random.unit()];
            let off = 1.0 + 1e-6 * (random.unit() - 0.5);
            let weights = [(1.0 - b - c) * off, b * off, c * off];
            for equal in [PLASTIC, mirror] {
                assert_eq!(Bsdf::barycentric([equal; 3], weights), equal);
            }
            let mixed = Bsdf::barycentric([PLASTIC, mirror, mirror], weights);
            let base = mixed.base_weight::<FeatureMask<4>>();
            assert!(base.min_element() >= 0.0 && base.max_element() <= 1.0);
            assert!(mixed.diffuse.min_element() >= 0.0 && mixed.diffuse.x <= 0.5);
        }
    }
}
