//! A sample of the camera.

use crate::math::{Ray, RayDifferential};
use crate::sampling::SobolSequence;

/// A camera ray and its random numbers. Pair 0 of these is the camera's own.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// The footprint of the sample, over which textures are filtered; zero for a sample of a point, whose textures are
    /// not filtered: the mean of such samples over a pixel converges to the pixel without bias.
    pub differential: RayDifferential,
    /// The random numbers of its film position.
    pub sequence: SobolSequence,
    /// Sample index within `sequence`.
    pub index: u32,
}
