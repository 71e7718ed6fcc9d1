use glam::{DVec3, Vec3};

/// The id that no primitive has.
pub const NO_PRIMITIVE: u32 = u32::MAX;

/// A ray in world space: the points `origin + t * direction` for `0 < t < t_max`.
///
/// The direction need not be of unit length: t is measured in its length, so a
/// shadow ray that reaches from a point to a light ends at t = 1.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: Vec3,
    /// Where it goes; finite and not zero.
    pub direction: Vec3,
    /// The open end of a shadow ray's interval, in lengths of `direction`; infinite for others.
    pub t_max: f32,
    /// A primitive that the ray cannot hit again, the one it left; or [`NO_PRIMITIVE`].
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
