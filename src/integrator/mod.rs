//! The radiance that reaches the camera along a ray: recursive ray tracing (Whitted 1980), path tracing (Kajiya
//! 1986) and irradiance caching (Ward et al. 1988).
//!
//! An [`Integrator`] is built from plain [`IntegratorSettings`], a scene and, for cached light, an irradiance
//! cache. A ray that leaves the scene returns the background; a path at its last bounce returns the ambient light.
//! Knows nothing of pixels, frames or time.

mod cached;
mod direct;
mod final_gather;
mod light_sampler;
mod path_state;
mod path_tracer;
mod settings;
mod visible_points;
mod whitted;

use crate::accel::Traversal;
use crate::geometry::Hit;
use crate::irradiance_cache::IrradianceCache;
use crate::material::{FeatureSet, Features, mirror};
use crate::math::Ray;
use crate::sampling::Sequence;
use crate::scene::{Scene, Surface};
use cached::CachedIrradiance;
use direct::direct_lighting_coherent;
use glam::Vec3;
use path_tracer::PathTracer;
use std::marker::PhantomData;
use thiserror::Error;
use whitted::Wavefront;

pub use final_gather::{FinalGather, GatherPoint};
pub use light_sampler::LightSampler;
pub use settings::IntegratorSettings;
pub use visible_points::{VisiblePoint, visible_points};

/// An array of a generic function's instances, one for each set of features, by [`FeatureSet::number`].
macro_rules! for_each_feature_set {
    ($($function:tt)+) => {{
        use crate::material::Only;
        [
            $($function)+::<Only<0>>,
            $($function)+::<Only<1>>,
            $($function)+::<Only<2>>,
            $($function)+::<Only<3>>,
            $($function)+::<Only<4>>,
            $($function)+::<Only<5>>,
            $($function)+::<Only<6>>,
            $($function)+::<Only<7>>,
            $($function)+::<Only<8>>,
            $($function)+::<Only<9>>,
            $($function)+::<Only<10>>,
            $($function)+::<Only<11>>,
            $($function)+::<Only<12>>,
            $($function)+::<Only<13>>,
            $($function)+::<Only<14>>,
            $($function)+::<Only<15>>,
        ]
    }};
}
use for_each_feature_set;

/// Computes the radiance along camera rays of one scene.
///
/// Building one may trace rays to find the lights that guide paths: build it once for a sequence.
#[derive(Clone, Debug)]
pub struct Integrator<'a> {
    scene: &'a Scene,
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
    },
    Cached {
        cache: &'a IrradianceCache,
        final_gather: FinalGather<'a>,
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
        "the irradiance cache is of {cache} bounces, the integrator of {settings}: bake another one"
    )]
    OtherBounces {
        /// Bounces of the cache.
        cache: u32,
        /// Bounces of the settings.
        settings: u32,
    },
}

/// A camera ray and its random numbers. Pair 0 of these is the camera's own.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// The random numbers of its film position.
    pub sequence: Sequence,
    /// Sample index within `sequence`.
    pub index: u32,
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
                }
            }
        };
        Ok(Integrator { scene, method })
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

    /// The same integrator with half of the paths, rounded up, from the first diffuse bounce. Itself if it does not
    /// split.
    pub(crate) fn with_half_the_paths(mut self) -> Integrator<'a> {
        if let Method::PathTraced { splits, .. } = &mut self.method
            && let Some(first) = splits.first_mut()
        {
            *first = first.div_ceil(2);
        }
        self
    }

    /// The radiance along each of the camera rays. The result of a ray does not depend on the others; coherent rays
    /// are faster.
    pub fn radiance(
        &self,
        samples: &[CameraSample],
        traversal: &mut Traversal,
        radiance: &mut [Vec3],
    ) {
        RADIANCE[self.scene.features().number()](self, samples, traversal, radiance);
    }
}

type RadianceFor = fn(&Integrator, &[CameraSample], &mut Traversal, &mut [Vec3]);

/// [`Integrator::radiance`] for each set of features.
static RADIANCE: [RadianceFor; FeatureSet::COUNT] = for_each_feature_set!(radiance_for);

fn radiance_for<F: Features>(
    integrator: &Integrator,
    samples: &[CameraSample],
    traversal: &mut Traversal,
    radiance: &mut [Vec3],
) {
    let scene = integrator.scene;
    let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
    let surfaces = coherent_surfaces::<F>(scene, &rays, traversal);
    let direct = direct_lighting_coherent::<F>(scene, &surfaces, &rays, traversal);
    match &integrator.method {
        Method::Whitted { bounces } => {
            let ambient = ambient(scene);
            let indirect =
                |wavefront: &Wavefront, _: &mut Traversal| vec![ambient; wavefront.surfaces.len()];
            let first = Wavefront::of_camera(rays, surfaces, direct, *bounces);
            whitted::radiance::<F>(scene, first, indirect, traversal, radiance);
        }
        Method::Cached {
            cache,
            final_gather,
        } => {
            let cached = CachedIrradiance {
                cache,
                final_gather,
                samples,
            };
            let indirect = |wavefront: &Wavefront, traversal: &mut Traversal| {
                cached.indirect::<F>(wavefront, traversal)
            };
            let first = Wavefront::of_camera(rays, surfaces, direct, cache.bounces());
            whitted::radiance::<F>(scene, first, indirect, traversal, radiance);
        }
        Method::PathTraced {
            bounces,
            splits,
            light_sampler,
        } => {
            let mut path_tracer = PathTracer::<F> {
                light_sampler,
                bounces: *bounces,
                splits,
                cache: None,
                traversal,
                features: PhantomData,
            };
            path_tracer.camera_radiance(samples, &surfaces, &direct, radiance);
        }
    }
}

/// The surface that each of some coherent rays hits.
fn coherent_surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Option<Surface>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_coherent(rays, &mut hits, traversal);
    surfaces::<F>(scene, rays, &hits)
}

/// The surface at each ray's hit.
fn surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    hits: &[Option<Hit>],
) -> Vec<Option<Surface>> {
    let surface =
        |(ray, hit): (&Ray, &Option<Hit>)| hit.as_ref().map(|hit| scene.surface::<F>(ray, hit));
    rays.iter().zip(hits).map(surface).collect()
}

/// The ambient light that stands for all bounces that are not computed.
fn ambient(scene: &Scene) -> Vec3 {
    const FRACTION: f32 = 0.3;
    FRACTION * scene.ambient
}

/// The mirror reflection of `ray` at the surface.
fn reflect(surface: &Surface, ray: &Ray) -> Ray {
    let viewer = -ray.direction;
    let reflected = mirror(viewer, surface.point.shading_normal);
    // An interpolated normal may reflect into the surface; the geometric normal never does.
    let reflected = if reflected.dot(surface.point.geometric_normal) > 0.0 {
        reflected
    } else {
        mirror(viewer, surface.point.geometric_normal)
    };
    surface.point.spawn_ray(reflected)
}
