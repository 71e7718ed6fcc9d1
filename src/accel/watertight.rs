//! Watertight ray-triangle tests (Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", JCGT
//! 2(1)).

use super::ray_setup::RaySetup;
use crate::simd::Floats;

/// Rays in the space where each runs along +Z from the origin: axes permuted so that the largest component
/// of its direction is z, then sheared.
///
/// Either one ray in all lanes against as many triangles, or the other way round: the same operations, so
/// the same results.
#[derive(Clone, Copy)]
pub(super) struct ShearedRays<V> {
    /// The origin, in permuted axes.
    origin: [V; 3],
    /// The slopes of x and y against z.
    slopes: [V; 2],
    /// 1 / direction.z: the ray parameter of one unit of z.
    inv_dz: V,
    /// What lies before this ray parameter lies behind the origin, less than the error bound from it.
    pub(super) behind: V,
}

impl<V> ShearedRays<V> {
    /// All rays of a packet that share the permutation of their axes.
    #[inline(always)]
    pub(super) fn load<const N: usize>(setup: &RaySetup<N>) -> ShearedRays<V>
    where
        V: Floats<N>,
    {
        let ([ox, oy, oz], [sx, sy]) = (&setup.origin, &setup.slopes);
        ShearedRays {
            origin: [V::load(ox), V::load(oy), V::load(oz)],
            slopes: [V::load(sx), V::load(sy)],
            inv_dz: V::load(&setup.inv_dz),
            behind: V::splat(0.0).sub(V::load(&setup.depth_error)),
        }
    }

    /// One ray in all lanes.
    #[inline(always)]
    pub(super) fn splat<const N: usize, const RAYS: usize>(
        setup: &RaySetup<RAYS>,
        lane: usize,
    ) -> ShearedRays<V>
    where
        V: Floats<N>,
    {
        let ([ox, oy, oz], [sx, sy]) = (&setup.origin, &setup.slopes);
        let lane = lane % RAYS;
        ShearedRays {
            origin: [V::splat(ox[lane]), V::splat(oy[lane]), V::splat(oz[lane])],
            slopes: [V::splat(sx[lane]), V::splat(sy[lane])],
            inv_dz: V::splat(setup.inv_dz[lane]),
            behind: V::splat(-setup.depth_error[lane]),
        }
    }

    /// The mask of lanes whose ray's line passes through the triangle, unless all vertices lie behind the
    /// ray's origin or beyond `limit`, which has the error bound added. Vertices have permuted axes.
    ///
    /// The edge functions of neighbours are exact negatives of each other, so a line cannot pass between
    /// them. Zero counts as inside. The method's distance is only as good as the largest coordinate of the
    /// triangle, so that is left to [`TrianglePlanes`](super::triangle_planes::TrianglePlanes).
    #[inline(always)]
    pub(super) fn intersect<const N: usize>(&self, vertices: &[[V; 3]; 3], limit: V) -> u32
    where
        V: Floats<N>,
    {
        let (ax, ay, at) = self.shear(vertices[0]);
        let (bx, by, bt) = self.shear(vertices[1]);
        let (cx, cy, ct) = self.shear(vertices[2]);
        let edge_a = cx.mul(by).sub(cy.mul(bx));
        let edge_b = ax.mul(cy).sub(ay.mul(cx));
        let edge_c = bx.mul(ay).sub(by.mul(ax));

        let zero = V::splat(0.0);
        let min = edge_a.min(edge_b).min(edge_c);
        let max = edge_a.max(edge_b).max(edge_c);
        // Not all three zero: then the line lies in the triangle's plane, and does not pass through it.
        let inside = (zero.le(min) & zero.lt(max)) | (max.le(zero) & min.lt(zero));
        let (first, last) = (at.min(bt).min(ct), at.max(bt).max(ct));
        inside & self.behind.lt(last) & first.le(limit)
    }

    /// Points in the rays' space: x, y, and the ray parameter at their z.
    #[inline(always)]
    fn shear<const N: usize>(&self, [x, y, z]: [V; 3]) -> (V, V, V)
    where
        V: Floats<N>,
    {
        let [ox, oy, oz] = self.origin;
        let [sx, sy] = self.slopes;
        let z = z.sub(oz);
        let (x, y) = (x.sub(ox).sub(sx.mul(z)), y.sub(oy).sub(sy.mul(z)));
        (x, y, z.mul(self.inv_dz))
    }
}
