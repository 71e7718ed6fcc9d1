//! Light-guided sampling: rays from the lights that illuminate a small area near them far more brightly than the rest
//! of the scene, the light subpath of bidirectional path tracing (Veach 1997, chapter 10). Direct light, from all
//! lights, is in `direct`.

use crate::accel::QueryState;
use crate::light::{Falloff, PointLight};
use crate::material::FeatureMask;
use crate::math::Ray;
use crate::sampling::{SobolSequence, uniform_sphere};
use crate::scene::Scene;
use std::f32::consts::PI;

/// A light guides paths if the mean irradiance around it is more than this many times that on a sphere around it.
const MIN_IRRADIANCE_RATIO: f32 = 2.0;

/// Rays that measure this, per light.
const PROBE_RAYS: u32 = 1024;

/// Samples rays from the lights that stand close to surfaces.
///
/// Such a light puts most of its power on a small area: few of the rays that are gathered over a hemisphere hit it,
/// and those that do carry most of the indirect light. Rays that leave the light uniformly in all directions find it.
#[derive(Clone, Debug)]
pub struct LightSampler<'a> {
    scene: &'a Scene,
    /// The probability of each light of the scene; empty if no light is close to a surface.
    probabilities: Vec<f32>,
}

impl<'a> LightSampler<'a> {
    /// Traces rays from the lights of a scene to find those that are close to surfaces.
    pub fn new(scene: &'a Scene) -> LightSampler<'a> {
        let power = |light: &PointLight| {
            if light.radius == 0.0
                && light.falloff == Falloff::InverseSquare
                && irradiance_ratio(scene, light) > MIN_IRRADIANCE_RATIO
            {
                light.intensity.as_dvec3().element_sum()
            } else {
                0.0
            }
        };
        let powers: Vec<f64> = scene.lights.iter().map(power).collect();
        let sum: f64 = powers.iter().sum();
        let probabilities = if sum == 0.0 {
            Vec::new()
        } else {
            powers.iter().map(|power| (power / sum) as f32).collect()
        };
        LightSampler {
            scene,
            probabilities,
        }
    }

    /// The scene of the lights.
    #[inline]
    pub(super) fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Whether no light is close to a surface, so that there is nothing to sample.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.probabilities.is_empty()
    }

    /// A ray from one of the lights, chosen by two numbers in [0, 1), uniform over the sphere. The sampler is not
    /// empty.
    pub(super) fn sample_ray(&self, [u, v]: [f32; 2]) -> Ray {
        let mut rest = u;
        let mut chosen = 0;
        for (light, probability) in self.probabilities.iter().enumerate() {
            if *probability > 0.0 {
                chosen = light;
                if rest < *probability {
                    break;
                }
                rest -= probability;
            }
        }
        // The rest is uniform in [0, probability) and is used again; rounding may leave too much.
        let u = (rest / self.probabilities[chosen]).min(1.0);
        Ray::new(self.scene.lights[chosen].position, uniform_sphere(u, v))
    }

    /// The pdf, over area, that a ray of [`LightSampler::sample_ray`] leaves `light` and hits a point that the light
    /// sees at `distance`, where the ray has the cosine `cos` to the geometric normal. The sampler is not empty.
    #[inline]
    pub(super) fn pdf(&self, light: usize, distance: f32, cos: f32) -> f32 {
        self.probabilities[light] * cos / (4.0 * PI * distance * distance)
    }
}

/// The mean irradiance where rays from a light hit, over that on a sphere whose radius is their mean length.
fn irradiance_ratio(scene: &Scene, light: &PointLight) -> f32 {
    let sequence = SobolSequence::new(0, 0, 0, 0);
    let mut query_state = QueryState::default();
    let (mut count, mut lengths, mut irradiances) = (0.0, 0.0, 0.0);
    for i in 0..PROBE_RAYS {
        let [u, v] = sequence.sample_2d(i, 0);
        let ray = Ray::new(light.position, uniform_sphere(u, v));
        let Some(hit) = scene.closest(&ray, &mut query_state) else {
            continue;
        };
        let cos = scene
            .surface::<FeatureMask<0>>(&ray, &hit)
            .point
            .geometric_normal
            .dot(-ray.direction);
        let length = hit.t as f32;
        count += 1.0;
        lengths += length;
        irradiances += cos / (length * length);
    }
    if count == 0.0 {
        return 0.0;
    }
    let mean = lengths / count;
    irradiances / count * mean * mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};
    use glam::{DVec3, Vec3, Vec3Swizzles};

    /// A floor of 20 m by 20 m with lights at these heights above its middle.
    fn floor_below(heights: &[f64]) -> Scene {
        let light = |height: &f64| {
            (
                DVec3::Y * *height,
                PointLight::isotropic(Vec3::ZERO, Vec3::ONE),
            )
        };
        let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z);
        let floor = SourceMesh {
            positions: vec![
                corner(-10.0, -10.0),
                corner(-10.0, 10.0),
                corner(10.0, 10.0),
                corner(10.0, -10.0),
            ],
            normals: vec![],
            uvs: vec![],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: MeshMaterial::Uniform(0),
        };
        let builder = SceneBuilder {
            lights: heights.iter().map(light).collect(),
            materials: vec![Material::lambert(Vec3::ONE)],
            meshes: vec![floor],
            ..SceneBuilder::default()
        };
        builder.build().0
    }

    #[test]
    fn only_lights_close_to_surfaces_are_sampled() {
        for heights in [&[][..], &[30.0]] {
            assert!(LightSampler::new(&floor_below(heights)).is_empty());
        }
        let scene = floor_below(&[30.0, 0.5]);
        let sampler = LightSampler::new(&scene);
        for i in 0..100 {
            let ray = sampler.sample_ray([i as f32 / 100.0, 0.3]);
            assert_eq!(ray.origin, scene.lights[1].position);
        }
    }

    /// The fraction of rays that hit a disc below the light is the integral of the pdf over the disc, and the disc's
    /// fraction of the sphere of directions.
    #[test]
    fn rays_are_distributed_by_the_pdf() {
        let scene = floor_below(&[0.5, 0.5]);
        let sampler = LightSampler::new(&scene);
        let (radius, height) = (0.3_f32, 0.5_f32);
        let sequence = SobolSequence::new(1, 0, 0, 0);
        let mut query_state = QueryState::default();
        let hits_disc = |i: u32| {
            let ray = sampler.sample_ray(sequence.sample_2d(i, 0));
            let hit = scene.closest(&ray, &mut query_state);
            hit.is_some_and(|hit| (ray.at(hit.t).as_vec3() - ray.origin).xz().length() < radius)
        };
        let fraction = (0..1 << 16).map(hits_disc).filter(|a| *a).count() as f32 / 65536.0;
        let steps = 1000;
        let step = radius / steps as f32;
        let expected: f32 = (0..steps)
            .map(|i| {
                let r = (i as f32 + 0.5) * step;
                let distance = r.hypot(height);
                let pdf = |light| sampler.pdf(light, distance, height / distance);
                2.0 * PI * r * step * (pdf(0) + pdf(1))
            })
            .sum();
        let solid_angle_fraction = 0.5 * (1.0 - height / radius.hypot(height));
        assert!((expected - solid_angle_fraction).abs() < 1e-5);
        assert!((fraction - expected).abs() < 5e-4, "{fraction} {expected}");
    }
}
