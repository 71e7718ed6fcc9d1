//! Queries of single rays.

use super::bvh::Bvh;
use super::query_state::QueryState;
use super::traverse_single::TraverseSingle;
use crate::geometry::Hit;
use crate::math::Ray;

impl Bvh {
    /// The closest hit of a ray, or none. The ray's `t_max`, which bounds [`Bvh::occluded`], is infinite.
    #[inline]
    pub fn closest(&self, ray: &Ray, query_state: &mut QueryState) -> Option<Hit> {
        self.query::<false>(ray, query_state).found()
    }

    /// Whether any primitive lies in the ray's interval.
    #[inline]
    pub fn occluded(&self, ray: &Ray, query_state: &mut QueryState) -> bool {
        !self.query::<true>(ray, query_state).is_miss()
    }

    #[inline]
    pub(super) fn query<const ANY_HIT: bool>(
        &self,
        ray: &Ray,
        query_state: &mut QueryState,
    ) -> Hit {
        query_state.rays += 1;
        self.kernel.run(TraverseSingle::<ANY_HIT> {
            bvh: self,
            ray,
            stack: &mut query_state.stack,
        })
    }
}
