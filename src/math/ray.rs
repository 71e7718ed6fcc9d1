//! Rays with the interval in which they look for hits.

use glam::{DVec3, Vec3};

/// The number that no primitive has.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// A ray in scene space (see `scene`): the points `origin + t * direction` for `0 < t < t_max`.
///
/// The direction need not be of unit length; t counts lengths of the direction.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Ray {
    /// The start, in metres.
    pub origin: Vec3,
    /// Finite and not zero.
    pub direction: Vec3,
    /// The open end of a shadow ray's interval; infinite for other rays.
    pub t_max: f32,
    /// The primitive that the ray leaves and cannot hit again, or [`NO_PRIMITIVE`].
    pub exclude: u32,
}

impl Ray {
    /// An endless ray that may hit everything.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
            exclude: NO_PRIMITIVE,
        }
    }

    /// The point with parameter `t`, in double precision.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin.as_dvec3() + t * self.direction.as_dvec3()
    }
}
