//! The integrator of a scene: the radiance along camera rays by one of three methods.

use super::cached::CachedIrradiance;
use super::camera_sample::CameraSample;
use super::direct::{add_headlight, direct_lighting_coherent};
use super::feature_sets::for_each_feature_set;
use super::final_gather::FinalGather;
use super::hit_surfaces::{ambient, coherent_surfaces};
use super::light_sampler::LightSampler;
use super::path_tracer::{PathTracer, Schedule};
use super::settings::IntegratorSettings;
use super::sky_sampler::SkySampler;
use super::visible_points::visible_points;
use super::whitted::{CameraLight, Wavefront};
use crate::accel::QueryState;
use crate::irradiance_cache::IrradianceCache;
use crate::material::{FeatureSet, Features};
use crate::math::{Ray, RayDifferential};
use crate::scene::Scene;
use glam::Vec3;
use std::marker::PhantomData;
use thiserror::Error;

/// Computes the radiance along camera rays of one scene.
///
/// Building one may trace rays to find the lights that guide paths: build it once for a sequence.
#[derive(Clone, Debug)]
pub struct Integrator<'a> {
    scene: &'a Scene,
    /// See [`Integrator::with_shadow_rays`].
    shadow_rays: u32,
    /// See [`Integrator::with_headlight`].
    headlight: f32,
    method: Method<'a>,
}

#[derive(Clone, Debug)]
enum Method<'a> {
    Whitted {
        bounces: u32,
    },
    PathTraced {
        bounces: u32,
        splits: Vec<u32>,
        light_sampler: LightSampler<'a>,
        sky: Option<SkySampler>,
    },
    Cached {
        cache: &'a IrradianceCache,
        final_gather: FinalGather<'a>,
        sky: Option<SkySampler>,
    },
}

/// Why settings and irradiance cache make no integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum IntegratorError {
    /// The settings need an irradiance cache, and there is none.
    #[error(
        "the integrator is cached, but there is no irradiance cache: bake one, or use path tracing"
    )]
    MissingCache,
    /// The cache has the light of paths of another length.
    #[error(
        "the irradiance cache was baked for {cache} bounces, and the settings have {settings}: bake another one"
    )]
    OtherBounces {
        /// Bounces of the cache.
        cache: u32,
        /// Bounces of the settings.
        settings: u32,
    },
}

impl<'a> Integrator<'a> {
    /// The integrator of the settings. `cache` is the scene's irradiance cache; only cached light needs it, others
    /// ignore it.
    pub fn new(
        scene: &'a Scene,
        settings: &IntegratorSettings,
        cache: Option<&'a IrradianceCache>,
    ) -> Result<Integrator<'a>, IntegratorError> {
        let method = match settings {
            IntegratorSettings::Whitted { bounces } => Method::Whitted { bounces: *bounces },
            IntegratorSettings::PathTraced { bounces, splits } => Method::PathTraced {
                bounces: *bounces,
                splits: splits.clone(),
                light_sampler: LightSampler::new(scene),
                sky: SkySampler::new(scene),
            },
            IntegratorSettings::Cached { bounces } => {
                let cache = cache.ok_or(IntegratorError::MissingCache)?;
                if cache.bounces() != *bounces {
                    return Err(IntegratorError::OtherBounces {
                        cache: cache.bounces(),
                        settings: *bounces,
                    });
                }
                Method::Cached {
                    cache,
                    final_gather: FinalGather::new(scene),
                    sky: SkySampler::new(scene),
                }
            }
        };
        Ok(Integrator {
            scene,
            shadow_rays: 1,
            headlight: 0.0,
            method,
        })
    }

    /// The same integrator with this many shadow rays, at least one, from every surface that a camera sample sees, for all
    /// emitters together, and for each sun that is not a point. One without.
    pub fn with_shadow_rays(mut self, shadow_rays: u32) -> Integrator<'a> {
        self.shadow_rays = shadow_rays;
        self
    }

    /// The scene whose light it computes.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// How many paths continue from each diffuse bounce, the first bounce first; none unless light is path traced.
    pub(crate) fn splits(&self) -> &[u32] {
        match &self.method {
            Method::PathTraced { splits, .. } => splits,
            Method::Whitted { .. } | Method::Cached { .. } => &[],
        }
    }

    /// The same integrator with a light that camera and mirror rays carry to what they see: a white Lambert surface that faces
    /// one gets this radiance. It throws no shadows and is not gathered. None without.
    pub fn with_headlight(mut self, headlight: f32) -> Integrator<'a> {
        self.headlight = headlight;
        self
    }

    /// How many shadow rays there are: see [`Integrator::with_shadow_rays`].
    pub(crate) fn shadow_rays(&self) -> u32 {
        self.shadow_rays
    }

    /// The same integrator with half of the paths from the first diffuse bounce, and of the shadow rays, rounded up.
    pub(crate) fn with_half_the_paths(mut self) -> Integrator<'a> {
        self.shadow_rays = self.shadow_rays.div_ceil(2);
        if let Method::PathTraced { splits, .. } = &mut self.method
            && let Some(first) = splits.first_mut()
        {
            *first = first.div_ceil(2);
        }
        self
    }

    /// The same integrator for a camera that some rays stand for: in a room paths look for the sky through its windows.
    pub(crate) fn for_camera(
        mut self,
        rays: &[Ray],
        query_state: &mut QueryState,
    ) -> Integrator<'a> {
        if let Method::PathTraced {
            bounces: 1.., sky, ..
        } = &mut self.method
            && let Some(of_scene) = sky.take()
        {
            let seen = visible_points(self.scene, rays, 1, query_state);
            let points = seen.iter().map(|visible| &visible.point);
            *sky = Some(of_scene.for_surfaces(self.scene, points));
        }
        self
    }

    /// The radiance along each of the camera rays. The result of a ray does not depend on the others; coherent rays
    /// are faster.
    ///
    /// Textures are filtered over the footprints that `differentials` has, one of each ray. Where that is zero the sample
    /// stands for a point: its textures are not filtered, and the mean of such samples over a pixel converges to the pixel
    /// without bias. The list is empty if all are such samples.
    pub fn radiance(
        &self,
        samples: &[CameraSample],
        differentials: &[RayDifferential],
        query_state: &mut QueryState,
        radiance: &mut [Vec3],
    ) {
        let for_features = RADIANCE[self.scene.features().index()];
        for_features(self, samples, differentials, query_state, radiance);
    }
}

type RadianceFor =
    fn(&Integrator, &[CameraSample], &[RayDifferential], &mut QueryState, &mut [Vec3]);

/// [`Integrator::radiance`] for each set of features.
static RADIANCE: [RadianceFor; FeatureSet::COUNT] = for_each_feature_set!(radiance_for);

fn radiance_for<F: Features>(
    integrator: &Integrator,
    samples: &[CameraSample],
    differentials: &[RayDifferential],
    query_state: &mut QueryState,
    radiance: &mut [Vec3],
) {
    let scene = integrator.scene;
    let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
    let hit = coherent_surfaces::<F>(scene, &rays, differentials, query_state);
    let camera = CameraLight {
        scene,
        samples,
        shadow_rays: integrator.shadow_rays,
        headlight: integrator.headlight,
        sky: match &integrator.method {
            Method::Cached { sky, .. } => sky.as_ref(),
            Method::Whitted { .. } | Method::PathTraced { .. } => None,
        },
    };
    match &integrator.method {
        Method::Whitted { bounces } => {
            let ambient = ambient(scene);
            let indirect =
                |wavefront: &Wavefront, _: &mut QueryState| vec![ambient; wavefront.surfaces.len()];
            let first = camera.first::<F>(rays, hit, *bounces, query_state);
            camera.radiance::<F>(first, indirect, query_state, radiance);
        }
        Method::Cached {
            cache,
            final_gather,
            ..
        } => {
            let cached = CachedIrradiance {
                cache,
                final_gather,
                samples,
            };
            let indirect = |wavefront: &Wavefront, query_state: &mut QueryState| {
                cached.indirect::<F>(wavefront, query_state)
            };
            let first = camera.first::<F>(rays, hit, cache.bounces(), query_state);
            camera.radiance::<F>(first, indirect, query_state, radiance);
        }
        Method::PathTraced {
            bounces,
            splits,
            light_sampler,
            sky,
        } => {
            let mut direct =
                direct_lighting_coherent::<F>(scene, &hit.surfaces, &rays, query_state);
            add_headlight::<F>(integrator.headlight, &hit.surfaces, &rays, &mut direct);
            let mut path_tracer = PathTracer::<F> {
                light_sampler,
                schedule: Schedule {
                    bounces: *bounces,
                    splits,
                    shadow_rays: integrator.shadow_rays,
                    counts_emitters_by_shadow_rays: false,
                    excludes_sky: false,
                },
                sky: sky.as_ref().filter(|sky| sky.guides_paths),
                cache: None,
                query_state,
                features: PhantomData,
            };
            path_tracer.camera_radiance(samples, &hit, direct, radiance);
        }
    }
}
