//! A sample of the camera.

use crate::math::Ray;
use crate::sampling::SobolSequence;

/// A camera ray and its random numbers. Pair 0 of these is the camera's own.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// The random numbers of its film position.
    pub sequence: SobolSequence,
    /// Sample index within `sequence`.
    pub index: u32,
}
