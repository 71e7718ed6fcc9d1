//! How light reaches the camera along a ray.
//!
//! A ray that leaves the scene returns the background; a path that has no bounces left returns the
//! ambient light. Knows nothing of pixels, frames or time.

mod direct;
mod monte_carlo;
mod ray_tracing;

use crate::accel::Traversal;
use crate::material::mirror;
use crate::math::Ray;
use crate::sampling::Sequence;
use crate::scene::{Scene, Surface};
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

impl Integrator {
    /// The radiance that arrives along a camera ray of unit direction.
    ///
    /// `sequence` and `index` give the random numbers of this camera sample; pair 0 is the
    /// camera's own.
    pub fn radiance(
        &self,
        scene: &Scene,
        ray: &Ray,
        sequence: Sequence,
        index: u32,
        traversal: &mut Traversal,
    ) -> Vec3 {
        match self {
            Integrator::RayTracing { bounces } => {
                ray_tracing::radiance(scene, *ray, *bounces, traversal)
            }
            Integrator::MonteCarlo { bounces, splits } => {
                monte_carlo::radiance(scene, ray, *bounces, splits, sequence, index, traversal)
            }
        }
    }
}

/// The scene's ambient light where nothing better is known.
fn ambient(scene: &Scene) -> Vec3 {
    const SHARE: f32 = 0.3;
    SHARE * scene.ambient
}

/// The ray that a mirror at the surface sees in place of `ray`.
fn reflect(surface: &Surface, ray: &Ray) -> Ray {
    let viewer = -ray.direction;
    let reflected = mirror(viewer, surface.shading_normal);
    // An interpolated normal may send it into the surface; the shape's own never does.
    let reflected = if reflected.dot(surface.geometric_normal) > 0.0 {
        reflected
    } else {
        mirror(viewer, surface.geometric_normal)
    };
    surface.leave(reflected)
}
