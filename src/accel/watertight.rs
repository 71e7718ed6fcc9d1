//! Watertight ray-triangle tests (Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", JCGT
//! 2(1)).

use super::rounding::{BOX_PADDING, origin_magnitude};
use crate::math::Ray;
use crate::simd::Floats;
use glam::{Vec3, Vec4};

/// Rays in the space where each runs along +Z from the origin: axes permuted so that the largest component
/// of its direction is z, then sheared.
///
/// Either one ray in all lanes against as many triangles, or the other way round: the same operations, so
/// the same results.
#[derive(Clone, Copy)]
pub(super) struct ShearedRays<V> {
    /// The origin, in permuted axes.
    pub(super) origin: [V; 3],
    /// The slopes of x and y against z.
    pub(super) slopes: [V; 2],
    /// 1 / direction.z: the ray parameter of one unit of z.
    pub(super) inv_dz: V,
    /// The error bound of a ray parameter, in either direction.
    pub(super) depth_error: V,
}

/// The permutation of the axes, the one along which the direction is longest last.
#[inline(always)]
pub(super) fn permuted_axes(direction: Vec3) -> [usize; 3] {
    let size = direction.abs();
    if size.x >= size.y && size.x >= size.z {
        [1, 2, 0]
    } else if size.y >= size.z {
        [2, 0, 1]
    } else {
        [0, 1, 2]
    }
}

/// Smaller slopes count as 0: their products with lengths would underflow and turn a ray in a triangle's
/// plane into noise.
pub(super) const MIN_SLOPE: f32 = 1e-25;

impl<V> ShearedRays<V> {
    /// One ray in all lanes; `axes` are its [`permuted_axes`], and `scene_magnitude` bounds the absolute
    /// coordinates of the scene.
    #[inline(always)]
    pub(super) fn splat<const N: usize>(
        ray: &Ray,
        axes: [usize; 3],
        scene_magnitude: f32,
    ) -> ShearedRays<V>
    where
        V: Floats<N>,
    {
        let [kx, ky, kz] = axes;
        let (o, d) = (ray.origin, ray.direction);
        let padding = BOX_PADDING * (origin_magnitude(ray) + scene_magnitude);
        // One division in place of three.
        let along = Vec4::new(d[kx], d[ky], 1.0, 1.0) / Vec4::splat(d[kz]);
        let inv_dz = along.z;
        ShearedRays {
            origin: [V::splat(o[kx]), V::splat(o[ky]), V::splat(o[kz])],
            slopes: [
                V::splat(along.x).zero_below(MIN_SLOPE),
                V::splat(along.y).zero_below(MIN_SLOPE),
            ],
            inv_dz: V::splat(inv_dz),
            depth_error: V::splat(padding * inv_dz.abs()),
        }
    }

    /// The mask of lanes whose ray's line passes through the triangle, unless all vertices lie behind the
    /// ray's origin or beyond `limit`. Vertices have permuted axes.
    ///
    /// The edge functions of neighbours are exact negatives of each other, so a line cannot pass between
    /// them. Zero counts as inside. The method's distance is only as good as the largest coordinate of the
    /// triangle, so that is left to [`TrianglePlane`](crate::geometry::TrianglePlane).
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
        // All three zero: the line lies in the triangle's plane, and does not pass through it.
        let not_flat = min.lt(max) | zero.lt(min) | max.lt(zero);
        let (first, last) = (at.min(bt).min(ct), at.max(bt).max(ct));
        let in_range = zero.lt(last.add(self.depth_error)) & first.sub(self.depth_error).le(limit);
        (zero.le(min) | max.le(zero)) & not_flat & in_range
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
