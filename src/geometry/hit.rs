//! The result of a ray query.

use crate::math::NO_PRIMITIVE;

/// Where a ray meets a primitive: just enough to compute the surface once, for the closest hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter, in lengths of the ray's direction; above 0. In double precision, so
    /// that the point it stands for is as exact as single precision can write it.
    pub t: f64,
    /// The primitive: triangles are numbered first, spheres after them.
    pub primitive: u32,
}

impl Hit {
    /// No hit, farther than any: what traversal starts with.
    pub(crate) const MISS: Hit = Hit {
        t: f32::MAX as f64,
        primitive: NO_PRIMITIVE,
    };

    /// Whether this is [`Hit::MISS`].
    #[inline]
    pub(crate) fn is_miss(&self) -> bool {
        self.primitive == NO_PRIMITIVE
    }

    /// None for [`Hit::MISS`].
    #[inline]
    pub(crate) fn found(self) -> Option<Hit> {
        (!self.is_miss()).then_some(self)
    }
}
