//! Direct light of emitters, balls, suns and the sky, by shadow rays in sampled directions.
//!
//! Shadow rays look for the closest hit: what a light's ray meets first is decided by the same exact distances as what
//! the camera sees, so a wall that touches a lamp hides it.

use super::hit_surfaces::HitSurfaces;
use super::sky_sampler::{SkySampler, SkyTechniques};
use crate::geometry::Hit;
use crate::material::Features;
use crate::math::{NO_PRIMITIVE, Ray};
use crate::sampling::SobolSequence;
use crate::scene::{LightSample, Scene, SurfaceInteraction};
use glam::Vec3;
use std::f32::consts::PI;

/// Shadow rays that are traced together.
const BATCH: usize = 256;

/// The first pair of random numbers for shadow rays, by depth: above those of paths and of rays from lights.
const SHADOW_DIMENSION_OFFSET: u32 = 2 << 16;
const SKY_DIMENSION_OFFSET: u32 = 3 << 16;

/// Where the shadow rays of a surface get their random numbers.
#[derive(Clone, Copy)]
pub(super) struct ShadowNumbers {
    pub(super) sequence: SobolSequence,
    /// The index of the path that ends there, among those of its depth with the same sequence.
    pub(super) index: u32,
    /// Bounces since the camera.
    pub(super) depth: u32,
    /// How many shadow rays there are for emitters, and for each sun.
    pub(super) rays: u32,
    /// How many directions are sampled by the cosine as well, and count for emitters that they hit: multiple importance
    /// sampling.
    pub(super) cosine_rays: f32,
    /// As `cosine_rays`, of those that may find the sky; none if there are no shadow rays to it.
    pub(super) sky_rays: Option<f32>,
}

/// A shadow ray and what it brings.
struct ShadowRay {
    surface: usize,
    sample: LightSample,
    /// The reflected light, if it is visible.
    light: Vec3,
}

/// Whether a scene has lights that are sampled, given how its sky is.
pub(super) fn has_sampled_lights(scene: &Scene, sky: Option<&SkySampler>) -> bool {
    scene.has_emitters() || !scene.suns.is_empty() || sky.is_some()
}

/// The balance heuristic (Veach and Guibas 1995): the weight of the light that is sampled with a pdf by `rays`, where
/// `other_rays` sample it with another.
pub(super) fn balance_heuristic(rays: f32, pdf: f32, other_rays: f32, other_pdf: f32) -> f32 {
    let (density, other) = (rays * pdf, other_rays * other_pdf);
    // Either may be infinite.
    1.0 / (1.0 + other / density)
}

/// Adds the light of emitters, balls, suns and, by `sky`, the sky that the surfaces' base layers, without their mirrors,
/// reflect against `rays`. `closest` traces rays. Highlights do not answer the sky.
pub(super) fn add_sampled_lights<F: Features>(
    scene: &Scene,
    sky: Option<&SkySampler>,
    hit: &HitSurfaces,
    rays: &[Ray],
    numbers: impl Fn(usize, &SurfaceInteraction) -> ShadowNumbers,
    mut closest: impl FnMut(&[Ray], &mut [Option<Hit>]),
    sums: &mut [Vec3],
) {
    let mut batch: Vec<ShadowRay> = Vec::with_capacity(BATCH);
    let mut trace = |batch: &mut Vec<ShadowRay>| {
        let rays: Vec<Ray> = batch.iter().map(|shadow| shadow.sample.ray).collect();
        let mut hits = vec![None; rays.len()];
        closest(&rays, &mut hits);
        for (shadow, hit) in batch.iter().zip(&hits) {
            if shadow.sample.is_visible(hit.as_ref()) {
                sums[shadow.surface] += shadow.light;
            }
        }
        batch.clear();
    };
    for (index, surface) in hit.surfaces.iter().enumerate() {
        let Some(surface) = surface else {
            continue;
        };
        if !surface.bsdf.has_direct::<F>() {
            continue;
        }
        let numbers = numbers(index, surface);
        let to_viewer = -rays[index].direction;
        let point = &surface.point;
        let of_sky = sky
            .zip(numbers.sky_rays)
            .filter(|_| surface.bsdf.diffuse != Vec3::ZERO)
            .map(|(sky, cosine_rays)| {
                let origin = point.spawn_origin();
                (
                    sky.techniques(scene, origin, point.shading_normal),
                    cosine_rays,
                )
            });
        for ray in 0..numbers.rays {
            let mut add = |sample, light| {
                batch.push(ShadowRay {
                    surface: index,
                    sample,
                    light,
                });
            };
            numbers.sample::<F>(scene, surface, to_viewer, ray, &mut add);
            if let Some((techniques, cosine_rays)) = &of_sky {
                numbers.sample_sky(scene, techniques, *cosine_rays, surface, ray, &mut add);
            }
            if batch.len() >= BATCH {
                trace(&mut batch);
            }
        }
    }
    trace(&mut batch);
}

impl ShadowNumbers {
    /// Samples one shadow ray for emitters and one for each sun, and hands over those that may bring light.
    fn sample<F: Features>(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        to_viewer: Vec3,
        ray: u32,
        add: &mut impl FnMut(LightSample, Vec3),
    ) {
        let ShadowNumbers { sequence, rays, .. } = *self;
        let index = self.index.wrapping_mul(rays).wrapping_add(ray);
        let pair = SHADOW_DIMENSION_OFFSET + self.depth;
        let point = &surface.point;
        if scene.has_emitters() {
            let choice = sequence.sample_1d(index, pair);
            let sampled = scene.sample_emitter(point, choice, sequence.sample_2d(index, pair));
            if let Some(sample) = sampled
                && sample.radiance != Vec3::ZERO
                && sample.ray.direction.dot(point.geometric_normal) > 0.0
            {
                let direction = sample.ray.direction;
                let normal = point.shading_normal;
                let [diffuse, highlight] =
                    surface.bsdf.lobes_cos::<F>(normal, direction, to_viewer);
                let cosine_rays = match sample.primitive {
                    NO_PRIMITIVE => 0.0,
                    _ => self.cosine_rays,
                };
                let cosine_pdf = normal.dot(direction).max(0.0) / PI;
                let weight = balance_heuristic(rays as f32, sample.pdf, cosine_rays, cosine_pdf);
                let light = (weight * diffuse + highlight) * sample.radiance
                    / (PI * sample.pdf * rays as f32);
                if light != Vec3::ZERO && light.is_finite() {
                    add(sample, light);
                }
            }
        }
        for (number, sun) in (1..).zip(&scene.suns) {
            // All shadow rays to a point would be the same.
            let is_point = sun.one_minus_cos == 0.0;
            if is_point && ray > 0 {
                continue;
            }
            let rays = if is_point { 1 } else { rays };
            let numbers = sequence.stream(number).sample_2d(index, pair);
            let (direction, irradiance) = sun.sample(numbers);
            if direction.dot(point.geometric_normal) <= 0.0 {
                continue;
            }
            let reflected = surface
                .bsdf
                .eval_cos::<F>(point.shading_normal, direction, to_viewer);
            let light = reflected * irradiance / (PI * rays as f32);
            if light != Vec3::ZERO {
                add(LightSample::at_infinity(point, direction), light);
            }
        }
    }

    /// Samples one shadow ray for the sky.
    fn sample_sky(
        &self,
        scene: &Scene,
        techniques: &SkyTechniques,
        cosine_rays: f32,
        surface: &SurfaceInteraction,
        ray: u32,
        add: &mut impl FnMut(LightSample, Vec3),
    ) {
        let point = &surface.point;
        let index = self.index.wrapping_mul(self.rays).wrapping_add(ray);
        let pair = SKY_DIMENSION_OFFSET + self.depth;
        let choice = self.sequence.sample_1d(index, pair);
        let (direction, pdf) = techniques.sample(choice, self.sequence.sample_2d(index, pair));
        let cosine = direction.dot(point.shading_normal);
        if cosine <= 0.0 || direction.dot(point.geometric_normal) <= 0.0 {
            return;
        }
        let weight = balance_heuristic(self.rays as f32, pdf, cosine_rays, cosine / PI);
        let reflected = surface.bsdf.diffuse * (weight * cosine / (PI * pdf * self.rays as f32));
        let light = reflected * scene.sky.radiance(direction);
        if light != Vec3::ZERO && light.is_finite() {
            add(LightSample::at_infinity(point, direction), light);
        }
    }
}
