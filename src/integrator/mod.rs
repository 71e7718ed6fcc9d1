//! How light reaches the camera along a ray.
//!
//! A ray that leaves the scene returns the background; a path that has no bounces left returns the
//! ambient light. Knows nothing of pixels, frames or time.

mod direct;
mod monte_carlo;
mod path;
mod ray_tracing;

use crate::accel::Traversal;
use crate::geometry::Hit;
use crate::material::{FeatureSet, Features, Only, mirror};
use crate::math::Ray;
use crate::sampling::Sequence;
use crate::scene::{Scene, Surface};
use direct::direct_of_neighbours;
use glam::Vec3;

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
            Integrator::RayTracing { bounces } => ray_tracing::radiance::<F>(
                scene, rays, surfaces, lit, *bounces, traversal, radiance,
            ),
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
    scene.closest_of_packet(rays, &mut hits, traversal);
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
static RADIANCE: [RadianceFor; FeatureSet::COUNT] = [
    Integrator::radiance_for::<Only<0>>,
    Integrator::radiance_for::<Only<1>>,
    Integrator::radiance_for::<Only<2>>,
    Integrator::radiance_for::<Only<3>>,
    Integrator::radiance_for::<Only<4>>,
    Integrator::radiance_for::<Only<5>>,
    Integrator::radiance_for::<Only<6>>,
    Integrator::radiance_for::<Only<7>>,
    Integrator::radiance_for::<Only<8>>,
    Integrator::radiance_for::<Only<9>>,
    Integrator::radiance_for::<Only<10>>,
    Integrator::radiance_for::<Only<11>>,
    Integrator::radiance_for::<Only<12>>,
    Integrator::radiance_for::<Only<13>>,
    Integrator::radiance_for::<Only<14>>,
    Integrator::radiance_for::<Only<15>>,
];

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
    surface.point.leave(reflected)
}
