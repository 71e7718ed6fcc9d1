//! How light reaches the camera along a ray.
//!
//! A ray that leaves the scene returns the background; a path that has no bounces left returns the
//! ambient light. Knows nothing of pixels, frames or time.

mod cached;
mod direct;
mod gather;
mod monte_carlo;
mod path;
mod ray_tracing;
mod seen;

use crate::accel::Traversal;
use crate::geometry::Hit;
use crate::irradiance_cache::IrradianceCache;
use crate::material::{FeatureSet, Features, mirror};
use crate::math::Ray;
use crate::sampling::Sequence;
use crate::scene::{Scene, Surface};
use direct::direct_of_neighbours;
use glam::Vec3;
use ray_tracing::Step;
use std::sync::Arc;

pub use gather::{GatherPoint, gather};
pub use seen::{Seen, seen};

/// A function for each set of features, by its number.
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

/// A way to work out the light along a camera ray.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Direct light, ambient light and mirrors (Whitted 1980). Uses no random numbers.
    RayTracing {
        /// How often a ray may be reflected.
        bounces: u32,
    },
    /// Light gathered over the hemisphere in place of the ambient term (Kajiya 1986).
    MonteCarlo {
        /// How many bounces are counted, diffuse and mirror alike; 0 is direct light only.
        bounces: u32,
        /// How many paths go on from each diffuse bounce, the first first; 1 beyond the list.
        splits: Vec<u32>,
    },
    /// The same, with what is gathered at the surfaces that the camera sees, itself and in mirrors, looked up.
    Cached {
        /// Of the scene. It knows how many bounces are counted.
        illumination: Arc<IrradianceCache>,
    },
}

/// A ray from the camera and its random numbers; pair 0 of them is the camera's own.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// Of unit direction.
    pub ray: Ray,
    /// The numbers of its film position.
    pub sequence: Sequence,
    /// Which of them.
    pub index: u32,
}

impl Integrator {
    /// How many bounces are counted.
    pub fn bounces(&self) -> u32 {
        match self {
            Integrator::RayTracing { bounces } | Integrator::MonteCarlo { bounces, .. } => *bounces,
            Integrator::Cached { illumination } => illumination.bounces(),
        }
    }

    /// The radiance that arrives along each of the camera rays. Each gets what it would get alone;
    /// together they are faster if they run side by side.
    pub fn radiance(
        &self,
        scene: &Scene,
        samples: &[CameraSample],
        traversal: &mut Traversal,
        radiance: &mut [Vec3],
    ) {
        let for_features = RADIANCE[scene.features().number()];
        for_features(self, scene, samples, traversal, radiance);
    }

    fn radiance_for<F: Features>(
        &self,
        scene: &Scene,
        samples: &[CameraSample],
        traversal: &mut Traversal,
        radiance: &mut [Vec3],
    ) {
        let rays: Vec<Ray> = samples.iter().map(|sample| sample.ray).collect();
        let surfaces = surfaces_of_neighbours::<F>(scene, &rays, traversal);
        let lit = direct_of_neighbours::<F>(scene, &surfaces, &rays, traversal);
        match self {
            Integrator::RayTracing { bounces } => {
                let ambient = ambient(scene);
                let indirect = |step: &Step, _: &mut Traversal| vec![ambient; step.surfaces.len()];
                let first = Step::first(rays, surfaces, lit, *bounces);
                ray_tracing::radiance::<F>(scene, first, indirect, traversal, radiance);
            }
            Integrator::Cached { illumination } => {
                let cached = cached::Cached {
                    scene,
                    illumination,
                    samples,
                };
                let indirect =
                    |step: &Step, traversal: &mut Traversal| cached.indirect::<F>(step, traversal);
                let first = Step::first(rays, surfaces, lit, illumination.bounces());
                ray_tracing::radiance::<F>(scene, first, indirect, traversal, radiance);
            }
            Integrator::MonteCarlo { bounces, splits } => monte_carlo::radiance::<F>(
                scene, samples, &surfaces, &lit, *bounces, splits, traversal, radiance,
            ),
        }
    }
}

/// What each of some rays that run side by side sees.
fn surfaces_of_neighbours<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Option<Surface>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_coherent(rays, &mut hits, traversal);
    surfaces::<F>(scene, rays, &hits)
}

/// What each ray sees where it hits.
fn surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    hits: &[Option<Hit>],
) -> Vec<Option<Surface>> {
    let surface =
        |(ray, hit): (&Ray, &Option<Hit>)| hit.as_ref().map(|hit| scene.surface::<F>(ray, hit));
    rays.iter().zip(hits).map(surface).collect()
}

type RadianceFor = fn(&Integrator, &Scene, &[CameraSample], &mut Traversal, &mut [Vec3]);

/// [`Integrator::radiance`] for each set of features.
static RADIANCE: [RadianceFor; FeatureSet::COUNT] = for_each_feature_set!(Integrator::radiance_for);

/// The scene's ambient light where nothing better is known.
fn ambient(scene: &Scene) -> Vec3 {
    const SHARE: f32 = 0.3;
    SHARE * scene.ambient
}

/// The ray that a mirror at the surface sees in place of `ray`.
fn reflect(surface: &Surface, ray: &Ray) -> Ray {
    let viewer = -ray.direction;
    let reflected = mirror(viewer, surface.point.shading_normal);
    // An interpolated normal may send it into the surface; the shape's own never does.
    let reflected = if reflected.dot(surface.point.geometric_normal) > 0.0 {
        reflected
    } else {
        mirror(viewer, surface.point.geometric_normal)
    };
    surface.point.spawn_ray(reflected)
}
