//! What a light tree knows of an emitter: Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with
//! Adaptive Tree Splitting", section 4.1.

use crate::math::Aabb;
use glam::Vec3;

/// The place of an emitter, its power and the directions it lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// A box that holds the emitter, in metres; finite and not empty.
    pub bounds: Aabb,
    /// The unit axis of a cone that holds all normals of the emitter.
    pub axis: Vec3,
    /// The cosine of the half angle of that cone: 1 for one normal, -1 for all directions.
    pub cos_theta_o: f32,
    /// The cosine of the angle from a normal from which on nothing is emitted: 0 for a Lambertian emitter.
    pub cos_theta_e: f32,
    /// Whether the emitter emits from both sides.
    pub is_two_sided: bool,
    /// What the emitter emits, in any one unit for all emitters. Those without a positive finite power are never
    /// chosen.
    pub power: f32,
}
