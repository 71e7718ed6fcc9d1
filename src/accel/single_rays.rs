//! Queries of single rays.

use super::bvh::Bvh;
use super::traversal::Traversal;
use super::traverse::Traverse;
use crate::geometry::Hit;
use crate::math::Ray;

impl Bvh {
    /// The closest hit of a ray, or none. The ray's `t_max` is ignored: it only bounds [`Bvh::occluded`].
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Option<Hit> {
        self.query::<false>(ray, traversal).found()
    }

    /// Whether any primitive lies in the ray's interval.
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        !self.query::<true>(ray, traversal).is_miss()
    }

    #[inline]
    pub(super) fn query<const ANY_HIT: bool>(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        traversal.rays += 1;
        self.kernel.run(Traverse::<ANY_HIT> {
            bvh: self,
            ray,
            stack: &mut traversal.stack,
        })
    }
}
