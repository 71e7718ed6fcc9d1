//! Light that ends paths beyond their first diffuse bounce.

use crate::accel::QueryState;
use crate::scene::SurfacePoint;
use glam::Vec3;

/// Light that is known at some surfaces.
pub(super) trait CachedLight {
    /// The cosine-weighted mean radiance that arrives at a surface point which a ray of length `distance` has hit, where
    /// `bounces_left` bounces, at least one, are left; none if it is not known there. Random numbers may choose between
    /// records.
    fn mean_radiance(
        &self,
        point: &SurfacePoint,
        bounces_left: u32,
        distance: f32,
        numbers: [f32; 2],
        query_state: &mut QueryState,
    ) -> Option<Vec3>;
}
