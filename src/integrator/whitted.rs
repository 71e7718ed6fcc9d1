//! Recursive ray tracing with mirrors (Whitted 1980, "An Improved Illumination Model for Shaded Display"), one
//! wavefront of reflected rays after the other.

use super::camera_sample::CameraSample;
use super::direct::{add_headlight, direct_lighting_coherent};
use super::hit_surfaces::{HitSurfaces, ambient, coherent_surfaces, spawn_reflected_ray};
use super::sampled_lights::{ShadowNumbers, add_sampled_lights, has_sampled_lights};
use super::sky_sampler::SkySampler;
use crate::accel::QueryState;
use crate::material::Features;
use crate::math::{Ray, RayDifferential};
use crate::scene::{Scene, SurfaceInteraction};
use glam::Vec3;

/// Rays of the same number of reflections; all lists are of one length, unless they are said to be empty.
pub(super) struct Wavefront {
    pub(super) rays: Vec<Ray>,
    /// The index of the camera sample that each ray belongs to.
    pub(super) samples: Vec<usize>,
    /// The throughput from each ray to its camera sample.
    pub(super) throughputs: Vec<Vec3>,
    /// What each ray hits.
    pub(super) surfaces: Vec<Option<SurfaceInteraction>>,
    /// The differentials of the rays that are reflected there: see [`HitSurfaces::reflected`].
    pub(super) reflected: Vec<RayDifferential>,
    /// What the surfaces send out by themselves: see [`HitSurfaces::emitted`].
    emitted: Vec<Vec3>,
    /// The direct light that is reflected there.
    direct: Vec<Vec3>,
    /// How many more bounces are computed.
    pub(super) bounces_left: u32,
}

/// The light that camera samples see.
pub(super) struct CameraLight<'a> {
    pub(super) scene: &'a Scene,
    pub(super) samples: &'a [CameraSample],
    /// How many shadow rays there are at a surface for emitters, and for each sun.
    pub(super) shadow_rays: u32,
    /// See [`Integrator::with_headlight`](super::Integrator::with_headlight).
    pub(super) headlight: f32,
    /// Samples the sky; none if surfaces are not lit by it.
    pub(super) sky: Option<&'a SkySampler>,
}

impl CameraLight<'_> {
    /// The wavefront of the camera rays.
    pub(super) fn first<F: Features>(
        &self,
        rays: Vec<Ray>,
        hit: HitSurfaces,
        bounces: u32,
        query_state: &mut QueryState,
    ) -> Wavefront {
        let samples: Vec<usize> = (0..rays.len()).collect();
        Wavefront {
            direct: self.direct::<F>(&hit, &rays, &samples, [0, bounces], query_state),
            samples,
            throughputs: vec![Vec3::ONE; rays.len()],
            rays,
            surfaces: hit.surfaces,
            reflected: hit.reflected,
            emitted: hit.emitted,
            bounces_left: bounces,
        }
    }

    /// The direct light of everything that shines, at surfaces that rays of some samples hit after `depth` reflections, with
    /// `bounces_left`.
    fn direct<F: Features>(
        &self,
        hit: &HitSurfaces,
        rays: &[Ray],
        samples: &[usize],
        [depth, bounces_left]: [u32; 2],
        query_state: &mut QueryState,
    ) -> Vec<Vec3> {
        let scene = self.scene;
        let mut direct = direct_lighting_coherent::<F>(scene, &hit.surfaces, rays, query_state);
        add_headlight::<F>(self.headlight, &hit.surfaces, rays, &mut direct);
        if has_sampled_lights(scene, self.sky) {
            let numbers = |i: usize, _: &SurfaceInteraction| {
                let CameraSample {
                    sequence, index, ..
                } = self.samples[samples[i]];
                ShadowNumbers {
                    sequence,
                    index,
                    depth,
                    rays: self.shadow_rays,
                    cosine_rays: 0.0,
                    sky_rays: (bounces_left > 0).then_some(0.0),
                }
            };
            let closest =
                |rays: &[Ray], hits: &mut [_]| scene.closest_coherent(rays, hits, query_state);
            add_sampled_lights::<F>(scene, self.sky, hit, rays, numbers, closest, &mut direct);
        }
        direct
    }

    /// The radiance along camera rays: base (1 - reflective) + reflective * (radiance of the mirrored ray), where base is
    /// the direct light plus the diffuse reflection of the indirect light, which `indirect` gives for each ray of a
    /// wavefront.
    ///
    /// Rays of one wavefront are traced together: neighbours mostly hit the same mirror.
    pub(super) fn radiance<F: Features>(
        &self,
        mut wavefront: Wavefront,
        indirect: impl Fn(&Wavefront, &mut QueryState) -> Vec<Vec3>,
        query_state: &mut QueryState,
        radiance: &mut [Vec3],
    ) {
        let scene = self.scene;
        radiance.fill(Vec3::ZERO);
        for depth in 1.. {
            let indirect = indirect(&wavefront, query_state);
            let mut rays = Vec::new();
            let mut differentials = Vec::new();
            let mut samples = Vec::new();
            let mut throughputs = Vec::new();
            for (i, &sample) in wavefront.samples.iter().enumerate() {
                let throughput = wavefront.throughputs[i];
                let sum = &mut radiance[sample];
                let Some(surface) = &wavefront.surfaces[i] else {
                    *sum += throughput * scene.sky.radiance(wavefront.rays[i].direction);
                    continue;
                };
                if let Some(emitted) = wavefront.emitted.get(i) {
                    *sum += throughput * *emitted;
                }
                let bsdf = &surface.bsdf;
                let base = indirect[i] * bsdf.diffuse + wavefront.direct[i];
                *sum += throughput * bsdf.base_weight::<F>() * base;
                let throughput = throughput * bsdf.mirror_weight::<F>();
                if throughput == Vec3::ZERO {
                    continue;
                }
                if wavefront.bounces_left == 0 {
                    *sum += throughput * ambient(scene);
                } else {
                    rays.push(spawn_reflected_ray(surface, &wavefront.rays[i]));
                    differentials.extend(wavefront.reflected.get(i));
                    samples.push(sample);
                    throughputs.push(throughput);
                }
            }
            if rays.is_empty() {
                return;
            }
            let hit = coherent_surfaces::<F>(scene, &rays, &differentials, query_state);
            let bounces_left = wavefront.bounces_left - 1;
            wavefront = Wavefront {
                direct: self.direct::<F>(&hit, &rays, &samples, [depth, bounces_left], query_state),
                rays,
                samples,
                throughputs,
                surfaces: hit.surfaces,
                reflected: hit.reflected,
                emitted: hit.emitted,
                bounces_left,
            };
        }
    }
}
