//! Materials as the scene defines them, and their reflectance at a point.

use super::features::{FeatureSet, Features};
use crate::texture::Texture;
use glam::{Vec2, Vec3};

/// A material as the scene defines it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Diffuse reflectance, 0..1; multiplied by the texture where there is one.
    pub diffuse: Vec3,
    /// The number of a texture of the scene.
    pub texture: Option<usize>,
    /// Weight of the Phong highlight, 0 or more.
    pub specular: Vec3,
    /// Exponent of the Phong highlight, 0 or more.
    pub shininess: f32,
    /// Weight of the mirror, 0..1; that of the base layer is 1 less this.
    pub reflective: Vec3,
}

impl Material {
    /// A Lambert surface.
    pub const fn lambert(diffuse: Vec3) -> Material {
        Material {
            diffuse,
            texture: None,
            specular: Vec3::ZERO,
            shininess: 0.0,
            reflective: Vec3::ZERO,
        }
    }

    /// The features of materials; `mixes` says whether a triangle mixes some of them.
    pub fn features<'a>(
        materials: impl IntoIterator<Item = &'a Material>,
        mixes: bool,
    ) -> FeatureSet {
        let [mut textures, mut highlights, mut mirrors] = [false; 3];
        for material in materials {
            textures |= material.texture.is_some();
            highlights |= material.specular != Vec3::ZERO;
            mirrors |= material.reflective != Vec3::ZERO;
        }
        FeatureSet::new(textures, highlights, mirrors, mixes)
    }

    /// The material at texture coordinate `uv`.
    #[inline]
    pub fn at<F: Features>(&self, uv: Vec2, textures: &[Texture]) -> Reflectance {
        let texel = match self.texture {
            Some(id) if F::TEXTURES => textures[id].sample(uv),
            _ => Vec3::ONE,
        };
        Reflectance {
            diffuse: self.diffuse * texel,
            specular: if F::HIGHLIGHTS {
                self.specular
            } else {
                Vec3::ZERO
            },
            shininess: self.shininess,
            reflective: if F::MIRRORS {
                self.reflective
            } else {
                Vec3::ZERO
            },
        }
    }
}

/// A material at one point, with its texture applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// Diffuse reflectance, 0..1.
    pub diffuse: Vec3,
    /// Weight of the Phong highlight.
    pub specular: Vec3,
    /// Exponent of the Phong highlight.
    pub shininess: f32,
    /// Weight of the mirror, 0..1.
    pub reflective: Vec3,
}

impl Reflectance {
    /// Weight of the mirror.
    #[inline]
    pub fn mirror<F: Features>(&self) -> Vec3 {
        if F::MIRRORS {
            self.reflective
        } else {
            Vec3::ZERO
        }
    }

    /// Whether the base layer reflects the light of point lights.
    #[inline]
    pub fn reflects_light<F: Features>(&self) -> bool {
        self.base_weight::<F>() != Vec3::ZERO
            && (self.diffuse != Vec3::ZERO || F::HIGHLIGHTS && self.specular != Vec3::ZERO)
    }

    /// Whether the base layer reflects indirect diffuse light.
    #[inline]
    pub fn has_diffuse<F: Features>(&self) -> bool {
        self.base_weight::<F>() * self.diffuse != Vec3::ZERO
    }

    /// Weight of the base layer.
    #[inline]
    pub fn base_weight<F: Features>(&self) -> Vec3 {
        Vec3::ONE - self.mirror::<F>()
    }

    /// The mean of three, weighted by barycentric coordinates that sum to 1.
    pub fn barycentric(vertices: [Reflectance; 3], weights: [f32; 3]) -> Reflectance {
        let mix = |of: fn(&Reflectance) -> Vec3| {
            of(&vertices[0]) * weights[0]
                + of(&vertices[1]) * weights[1]
                + of(&vertices[2]) * weights[2]
        };
        Reflectance {
            diffuse: mix(|r| r.diffuse),
            specular: mix(|r| r.specular),
            shininess: mix(|r| Vec3::splat(r.shininess)).x,
            reflective: mix(|r| r.reflective),
        }
    }

    /// The factor of the base layer on a light's colour: kd cos + ks (R.V)^shininess, cos = N.L, for light that arrives
    /// from `to_light` and leaves to `to_viewer` (Phong 1975). Zero for light from behind.
    #[inline]
    pub fn reflect_light<F: Features>(
        &self,
        normal: Vec3,
        to_light: Vec3,
        to_viewer: Vec3,
    ) -> Vec3 {
        let cos = normal.dot(to_light);
        if cos <= 0.0 {
            return Vec3::ZERO;
        }
        let mut factor = self.diffuse * cos;
        if F::HIGHLIGHTS && self.specular != Vec3::ZERO {
            let highlight = mirror(to_light, normal).dot(to_viewer).max(0.0);
            factor += self.specular * power(highlight, self.shininess);
        }
        factor
    }
}

/// `base`, 0 or more, to the power of `exponent`, 0 or more.
///
/// Whole exponents, as most are, by repeated squaring: in a third of the time of the general function, with an error
/// below that of rounding `base`.
#[inline]
fn power(base: f32, exponent: f32) -> f32 {
    const LARGE: f32 = 1024.0;
    if exponent.fract() != 0.0 || exponent > LARGE {
        return libm::powf(base, exponent);
    }
    let (mut rest, mut square, mut product) = (exponent as u32, base, 1.0);
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
#[inline]
pub fn mirror(direction: Vec3, normal: Vec3) -> Vec3 {
    normal * (2.0 * normal.dot(direction)) - direction
}

#[cfg(test)]
mod tests {
    use super::super::features::Only;
    use super::*;

    const PLASTIC: Reflectance = Reflectance {
        diffuse: Vec3::new(0.5, 0.25, 0.0),
        specular: Vec3::splat(0.5),
        shininess: 2.0,
        reflective: Vec3::ZERO,
    };

    #[test]
    fn lambert_and_phong_by_hand() {
        let sixty = Vec3::new(0.75_f32.sqrt(), 0.5, 0.0);
        // Viewer along the mirrored light: cos = 1/2, R.V = 1.
        let seen = PLASTIC.reflect_light::<Only<2>>(Vec3::Y, sixty, mirror(sixty, Vec3::Y));
        assert!((seen - Vec3::new(0.75, 0.625, 0.5)).length() < 1e-6);
        // Viewer along the normal: R.V = 1/2, squared a quarter, times 1/2.
        let seen = PLASTIC.reflect_light::<Only<2>>(Vec3::Y, sixty, Vec3::Y);
        assert!((seen - Vec3::new(0.375, 0.25, 0.125)).length() < 1e-6);
        // Light from below the surface.
        assert_eq!(
            PLASTIC.reflect_light::<Only<2>>(Vec3::Y, -sixty, Vec3::Y),
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
        let other = Reflectance {
            diffuse: Vec3::ONE,
            specular: Vec3::ZERO,
            shininess: 10.0,
            reflective: Vec3::X,
        };
        let mixed = Reflectance::barycentric([PLASTIC, other, other], [0.5, 0.25, 0.25]);
        assert_eq!(mixed.diffuse, Vec3::new(0.75, 0.625, 0.5));
        assert_eq!(mixed.specular, Vec3::splat(0.25));
        assert_eq!(mixed.shininess, 6.0);
        assert_eq!(mixed.reflective, Vec3::new(0.5, 0.0, 0.0));
    }
}
