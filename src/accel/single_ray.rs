//! One ray, loaded into vectors for tests against eight boxes or triangles.

use super::node::BoxRay;
use super::ray_setup::RaySetup;
use super::watertight::ShearedRays;
use crate::math::Ray;
use crate::simd::Simd;

/// What box and triangle tests need of a ray, in all lanes.
pub(super) struct SingleRay<'a, S: Simd> {
    pub(super) ray: &'a Ray,
    pub(super) boxes: BoxRay<S::F32x8>,
    pub(super) sheared: ShearedRays<S::F32x8>,
    /// The permutation of the axes, the one along which the direction is longest last.
    pub(super) axes: [usize; 3],
    /// The error bound of a ray parameter of a vertex, in either direction.
    pub(super) depth_error: f32,
    /// The largest absolute coordinate of the origin.
    pub(super) origin_magnitude: f32,
}

impl<'a, S: Simd> SingleRay<'a, S> {
    /// The ray of a lane of a setup.
    #[inline(always)]
    pub(super) fn new<const RAYS: usize>(
        ray: &'a Ray,
        setup: &RaySetup<RAYS>,
        lane: usize,
    ) -> SingleRay<'a, S> {
        SingleRay {
            ray,
            boxes: BoxRay::splat(setup, lane),
            sheared: ShearedRays::splat(setup, lane),
            axes: setup.axes(lane),
            depth_error: setup.depth_error[lane % RAYS],
            origin_magnitude: setup.origin_magnitude[lane % RAYS],
        }
    }
}
