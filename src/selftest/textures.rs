//! Texture coordinates and filtering against double precision.

use super::fixtures::{first_hits, ray_in, worse};
use crate::geometry::Sphere;
use crate::material::{FeatureMask, Material};
use crate::math::color::srgb_to_linear;
use crate::sampling::Random;
use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};
use crate::simd::Kernel;
use crate::texture::Texture;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// A texture whose lookup is computed in double precision.
pub(super) struct ReferenceTexture {
    width: usize,
    height: usize,
    texels: Vec<[u8; 3]>,
}

impl ReferenceTexture {
    /// Texels of random colours.
    pub(super) fn colorful(width: usize, height: usize) -> ReferenceTexture {
        let mut random = Random::new(9);
        let texels = (0..width * height).map(|_| [0; 3].map(|_| random.below(256) as u8));
        ReferenceTexture {
            width,
            height,
            texels: texels.collect(),
        }
    }

    pub(super) fn texture(&self) -> Texture {
        Texture::new(self.width, self.height, self.texels.clone()).expect("as many texels as that")
    }

    /// The colour at `uv`, whose origin is the lower left corner: bilinear between the centres of texels, repeated
    /// beyond the edges.
    pub(super) fn color(&self, uv: DVec2) -> DVec3 {
        let position = DVec2::new(uv.x.rem_euclid(1.0), (-uv.y).rem_euclid(1.0))
            * DVec2::new(self.width as f64, self.height as f64)
            - 0.5;
        let (corner, fraction) = (position.floor(), position - position.floor());
        let texel = |dx: i64, dy: i64| {
            let x = (corner.x as i64 + dx).rem_euclid(self.width as i64) as usize;
            let y = (corner.y as i64 + dy).rem_euclid(self.height as i64) as usize;
            let linear =
                self.texels[y * self.width + x].map(|code| srgb_to_linear(f32::from(code) / 255.0));
            Vec3::from_array(linear).as_dvec3()
        };
        let upper = texel(0, 0).lerp(texel(1, 0), fraction.x);
        let lower = texel(0, 1).lerp(texel(1, 1), fraction.x);
        upper.lerp(lower, fraction.y)
    }
}

fn error(found: Vec3, exact: DVec3) -> f64 {
    found.as_dvec3().distance(exact)
}

/// Both lookups get the same coordinates, so that only the error of the lookup itself is measured.
pub(super) fn coordinates(_: Kernel) -> f64 {
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        1e-9,
        -1e-9,
        1e-30,
        -1e-30,
        0.999_999_94,
        1.000_000_1,
        0.3,
        -0.3,
        7.7,
        -123.4,
        12_345.6,
        -99_999.9,
        1e6,
        -1e6,
        999_999.94,
        1e15,
    ];
    let mut worst: f64 = 0.0;
    for (width, height) in [(1, 1), (2, 1), (1, 3), (5, 3), (16, 16)] {
        let reference = ReferenceTexture::colorful(width, height);
        let texture = reference.texture();
        for u in numbers {
            for v in numbers {
                let uv = Vec2::new(u, v);
                worst = worse(
                    worst,
                    error(texture.sample(uv), reference.color(uv.as_dvec2())),
                );
            }
        }
    }
    worst
}

fn textured() -> Material {
    Material {
        texture: Some(0),
        ..Material::lambert(Vec3::ONE)
    }
}

/// A globe seen from outside and inside: rays to its poles, to its seam at the back, and to points up to
/// 1e-2 and 1e-6 beside them.
pub(super) fn poles_and_seam(kernel: Kernel) -> f64 {
    let reference = ReferenceTexture::colorful(8, 6);
    let center = DVec3::new(3.0, -2.0, 5.0);
    let globe = Sphere::new(center, 2.0);
    let builder = SceneBuilder {
        materials: vec![textured()],
        textures: vec![reference.texture()],
        spheres: vec![(globe, 0)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let mut random = Random::new(10);
    let mut worst: f64 = 0.0;
    for i in 0..6000 {
        let angle = PI * f64::from(random.unit());
        let seam = DVec3::new(0.0, angle.cos(), -angle.sin());
        let mark = [DVec3::Y, DVec3::NEG_Y, seam][i % 3];
        let beside = [0.0, 1e-6, 1e-2][random.below(3)];
        let target = center + 2.0 * (mark + beside * random.point()).normalize();
        let eye = center + [0.8, 8.0][random.below(2)] * random.point();
        let ray = ray_in(&scene, eye, target - eye);
        let Some(hit) = first_hits(&scene, &[ray])[0] else {
            continue;
        };
        let normal = (scene.origin + ray.at(hit.t) - center).normalize();
        let uv = DVec2::new(
            0.5 + normal.x.atan2(normal.z) / TAU,
            0.5 + normal.y.asin() / PI,
        );
        let found = scene.surface::<FeatureMask<1>>(&ray, &hit).bsdf.diffuse;
        // At the pole itself u is undefined, and any colour of the pole's row is right.
        if DVec2::new(normal.x, normal.z).length() > 1e-9 {
            worst = worse(worst, error(found, reference.color(uv)));
        } else if !found.is_finite() {
            return f64::NAN;
        }
    }
    worst
}

/// Triangles whose vertices have equal texture coordinates, or collinear ones: the colour is that at the interpolated
/// coordinate.
pub(super) fn equal_vertices(kernel: Kernel) -> f64 {
    let reference = ReferenceTexture::colorful(8, 8);
    let mut random = Random::new(11);
    let mut worst: f64 = 0.0;
    for uvs in [
        [Vec2::new(0.3, 0.7); 3],
        [Vec2::ZERO; 3],
        [
            Vec2::new(0.2, 0.4),
            Vec2::new(0.4, 0.8),
            Vec2::new(0.1, 0.2),
        ],
        [
            Vec2::new(-5.0, 3.0),
            Vec2::new(-5.0, 3.0),
            Vec2::new(-4.0, 3.0),
        ],
    ] {
        let mesh = SourceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: Vec::new(),
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2]],
            material: MeshMaterial::Uniform(0),
        };
        let builder = SceneBuilder {
            materials: vec![textured()],
            textures: vec![reference.texture()],
            meshes: vec![mesh],
            kernel,
            ..SceneBuilder::default()
        };
        let (scene, _) = builder.build();
        for _ in 0..1000 {
            let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
            let target = DVec3::new(u.into(), v.into(), 0.0);
            let ray = ray_in(&scene, target + DVec3::Z, DVec3::NEG_Z);
            let Some(hit) = first_hits(&scene, &[ray])[0] else {
                return 1.0;
            };
            let point = scene.origin + ray.at(hit.t);
            let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
            let exact = a + point.x * (b - a) + point.y * (c - a);
            let found = scene.surface::<FeatureMask<1>>(&ray, &hit).bsdf.diffuse;
            worst = worse(worst, error(found, reference.color(exact)));
        }
    }
    worst
}
