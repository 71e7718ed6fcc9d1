//! Samples of the light of a scene's emitters, as seen from a point.

use super::emitter::{Shape, Towards};
use super::emitters::{Emitter, Source};
use super::resolved::Scene;
use super::surface_point::SurfacePoint;
use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A ray towards an emitter and the light that it brings if nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// The ray, which ends at the emitter or just behind it.
    pub ray: Ray,
    /// The distance to the emitter.
    pub distance: f64,
    /// The primitive that the ray hits there, or [`NO_PRIMITIVE`].
    pub primitive: u32,
    /// The radiance that arrives.
    pub radiance: Vec3,
    /// The pdf of the direction, over solid angle.
    pub pdf: f32,
}

impl LightSample {
    /// Of a ray that arrives if it leaves the scene. Radiance and pdf are 1: the caller knows them.
    pub fn at_infinity(point: &SurfacePoint, direction: Vec3) -> LightSample {
        LightSample {
            ray: point.spawn_ray(direction),
            distance: f64::INFINITY,
            primitive: NO_PRIMITIVE,
            radiance: Vec3::ONE,
            pdf: 1.0,
        }
    }

    /// Whether the light arrives, given what the ray hits.
    #[inline]
    pub fn is_visible(&self, hit: Option<&Hit>) -> bool {
        /// Relative: above the rounding of double precision, far below that of the scene's coordinates.
        const ROUNDING: f64 = 1e-12;
        // The direction is rounded: it may miss a tiny emitter, and what is behind or beside it does not occlude it.
        hit.is_none_or(|hit| {
            hit.primitive == self.primitive || hit.t >= self.distance * (1.0 - ROUNDING)
        })
    }
}

impl Scene {
    /// Whether surfaces or balls emit: light that is sampled.
    pub fn has_emitters(&self) -> bool {
        !self.emitters.is_empty()
    }

    /// Whether there are lights whose shadows have soft edges: emitters, balls, and suns that are not points.
    pub fn has_soft_shadows(&self) -> bool {
        self.has_emitters() || self.suns.iter().any(|sun| sun.one_minus_cos > 0.0)
    }

    /// Samples an emitter from a point: which one by the number `choice`, the direction by `numbers`, all in [0, 1). None if
    /// no light comes from there.
    pub fn sample_emitter(
        &self,
        point: &SurfacePoint,
        choice: f32,
        numbers: [f32; 2],
    ) -> Option<LightSample> {
        let origin = point.spawn_origin();
        let emitters = &self.emitters;
        let (chosen, probability) = emitters.tree.sample(origin, point.shading_normal, choice)?;
        let Emitter { shape, source, .. } = &emitters.emitters[chosen];
        let towards = shape.sample(origin, numbers)?;
        let Towards {
            direction,
            distance,
            pdf,
        } = towards;
        let radiance = self.radiance_of(shape, source, origin, &towards);
        Some(LightSample {
            ray: Ray {
                // So far that a hit of the emitter itself is found.
                t_max: ((distance * (1.0 + f64::from(f32::EPSILON))) as f32).next_up(),
                ..point.spawn_ray(direction)
            },
            distance,
            primitive: match source {
                Source::Primitive(primitive) => *primitive,
                Source::Ball(_) => NO_PRIMITIVE,
            },
            radiance,
            pdf: probability * pdf,
        })
    }

    /// The pdf, over solid angle, that [`Scene::sample_emitter`] samples the direction of `ray`, which leaves a point with
    /// this shading normal, on the emitter that it hits; 0 if that is none.
    pub fn emitter_pdf(&self, shading_normal: Vec3, ray: &Ray, hit: &Hit) -> f32 {
        let emitters = &self.emitters;
        let Some(number) = self.emitter_at(ray, hit) else {
            return 0.0;
        };
        let shape = &emitters.emitters[number].shape;
        let probability = emitters
            .tree
            .probability(ray.origin, shading_normal, number);
        probability * shape.pdf(ray.origin, ray.direction, hit.t)
    }

    /// The radiance that an emitter sends to `origin`.
    fn radiance_of(&self, shape: &Shape, source: &Source, origin: Vec3, towards: &Towards) -> Vec3 {
        let direction = towards.direction.as_dvec3();
        let position = origin.as_dvec3() + towards.distance * direction;
        let unfiltered = |uv: Vec2| (uv, [Vec2::ZERO; 2]);
        match (shape, source) {
            (Shape::Triangle(shape), Source::Primitive(primitive)) => {
                let is_front = shape.front.dot(towards.direction) < 0.0;
                let triangle = &self.triangles[*primitive as usize];
                self.emitted_by_triangle(triangle, position, is_front, unfiltered)
            }
            (Shape::Sphere { center, .. }, Source::Primitive(primitive)) => {
                let normal = (position - center).normalize();
                let is_front = normal.dot(direction) < 0.0;
                self.emitted_by_sphere(*primitive as usize, normal, is_front, unfiltered)
            }
            (_, Source::Ball(light)) => {
                let light = &self.lights[*light];
                let away = origin - light.position;
                let is_outside = away.length_squared() > light.radius * light.radius;
                let disc = PI * light.radius * light.radius;
                light.intensity / disc
                    * light.cone.attenuation(away.normalize_or_zero())
                    * f32::from(is_outside)
            }
        }
    }

    /// The emitter that a ray meets at a hit.
    fn emitter_at(&self, ray: &Ray, hit: &Hit) -> Option<usize> {
        let pieces = (*self.emitters.of_primitive.get(hit.primitive as usize)?)?;
        let first = pieces.first as usize;
        if pieces.rows == 1 {
            return Some(first);
        }
        let triangle = &self.triangles[hit.primitive as usize];
        let mesh = &self.meshes[triangle.mesh as usize];
        let [_, u, v] = mesh.weights(triangle.vertices, ray.at(hit.t));
        Some(first + pieces.piece_at(u, v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::QueryState;
    use crate::geometry::Sphere;
    use crate::material::{Emission, Material};
    use crate::math::RayDifferential;
    use crate::sampling::Random;
    use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};
    use crate::texture::Texture;
    use glam::DVec3;

    /// Triangles, one of them textured, and spheres, of all sizes, which emit from both sides.
    fn lamps() -> Scene {
        let mut random = Random::new(5);
        let mut mesh = |material: usize, size: f32| {
            let triangle = random.triangle(2.0, size);
            SourceMesh {
                positions: triangle.map(|p| p.as_dvec3()).to_vec(),
                normals: vec![],
                uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
                triangles: vec![[0, 1, 2]],
                material: MeshMaterial::Uniform(material),
            }
        };
        let texels = (0..64 * 64).map(|i| [(i % 251) as u8, 100, 255]);
        let lamp = |texture| Material {
            emission: Emission {
                radiance: Vec3::new(3.0, 2.0, 1.0),
                texture,
                is_two_sided: true,
            },
            ..Material::lambert(Vec3::ONE)
        };
        let builder = SceneBuilder {
            materials: vec![lamp(None), lamp(Some(0))],
            textures: Texture::new(64, 64, texels.collect()).into_iter().collect(),
            meshes: vec![mesh(0, 0.05), mesh(0, 1.0), mesh(1, 2.0), mesh(0, 0.3)],
            spheres: vec![
                (Sphere::new(DVec3::new(1.0, -1.0, 0.5), 0.3), 0),
                (Sphere::new(DVec3::new(-1.0, 1.0, 0.0), 0.01), 0),
            ],
            ..SceneBuilder::default()
        };
        builder.build().0
    }

    /// What is visible has the pdf and the radiance that a ray in its direction finds.
    #[test]
    fn samples_are_what_rays_find() {
        let scene = lamps();
        let mut random = Random::new(6);
        let mut query_state = QueryState::default();
        let (mut visible, mut primitives) = (0, [0; 6]);
        for _ in 0..20_000 {
            let normal = random.vector(1.0).normalize();
            let point = SurfacePoint {
                position: random.vector(2.0),
                geometric_normal: normal,
                shading_normal: normal,
                offset: 0.0,
                exclude: NO_PRIMITIVE,
            };
            let numbers = [random.unit(), random.unit()];
            let Some(sample) = scene.sample_emitter(&point, random.unit(), numbers) else {
                continue;
            };
            let hit = scene.closest(&sample.ray, &mut query_state);
            assert!((sample.ray.direction.length() - 1.0).abs() < 1e-6);
            let Some(hit) = hit.filter(|hit| hit.primitive == sample.primitive) else {
                continue;
            };
            assert!(sample.is_visible(Some(&hit)));
            visible += 1;
            primitives[hit.primitive as usize] += 1;
            let pdf = scene.emitter_pdf(normal, &sample.ray, &hit);
            let emitted = scene.emitted(&sample.ray, &hit, &RayDifferential::ZERO);
            // The edge between two pieces of a texture belongs to either.
            let is_edge = (pdf - sample.pdf).abs() > 1e-3 * pdf;
            assert!(!is_edge || hit.primitive == 2, "{sample:?} {pdf}");
            assert!(
                (emitted - sample.radiance).length() < 0.02,
                "{emitted} {sample:?}"
            );
        }
        assert!(
            visible > 5000 && primitives.iter().all(|count| *count > 20),
            "{primitives:?}"
        );
    }
}
