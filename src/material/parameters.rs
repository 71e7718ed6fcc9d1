//! The parameters of materials, as the scene gives them.

use super::bsdf::Bsdf;
use super::features::{FeatureSet, Features};
use crate::texture::Texture;
use glam::{Vec2, Vec3};

/// The light that a surface sends out by itself, the same in all directions on the side that emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// The radiance, linear RGB in W/(sr m²), 0 or more; multiplied by the texture where there is one.
    pub radiance: Vec3,
    /// The index of a texture of the scene.
    pub texture: Option<usize>,
    /// Whether both sides emit; else only the front: the side that vertex normals point to or, without any, from which the
    /// vertices of a triangle run counter-clockwise; of a sphere the outside.
    pub is_two_sided: bool,
}

impl Emission {
    /// No light.
    pub const NONE: Emission = Emission {
        radiance: Vec3::ZERO,
        texture: None,
        is_two_sided: false,
    };
}

/// A material as the scene defines it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Diffuse reflectance, 0..1; multiplied by the texture where there is one.
    pub diffuse: Vec3,
    /// The index of a texture of the scene.
    pub texture: Option<usize>,
    /// Weight of the Phong highlight, 0 or more.
    pub specular: Vec3,
    /// Exponent of the Phong highlight, 0 or more.
    pub shininess: f32,
    /// Weight of the mirror, 0..1; that of the base layer is 1 less this.
    pub reflective: Vec3,
    /// The light that it sends out.
    pub emission: Emission,
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
            emission: Emission::NONE,
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

    /// The reflection at texture coordinates `uv`, with the texture filtered over `footprint`: see
    /// [`Texture::filtered`].
    #[inline(always)]
    pub fn bsdf<F: Features>(&self, uv: Vec2, footprint: [Vec2; 2], textures: &[Texture]) -> Bsdf {
        let texel = match self.texture {
            Some(id) if F::TEXTURES => textures[id].filtered(uv, footprint),
            _ => Vec3::ONE,
        };
        Bsdf {
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
