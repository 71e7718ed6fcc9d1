use super::rounding::{GROWTH, reach};
use super::simd::Floats;
use crate::math::Ray;
use glam::{Vec3, Vec4};

/// Rays and triangles, lane by lane, in the space where a ray runs along +Z from the origin: axes
/// permuted so that its largest component is z, then sheared.
///
/// Either one ray in all lanes against as many triangles, or the other way round: the same
/// operations, so the same answers.
#[derive(Clone, Copy)]
pub(super) struct ShearedRays<V> {
    /// The origin, in permuted axes.
    pub(super) origin: [V; 3],
    /// The slopes of x and y against z.
    pub(super) slopes: [V; 2],
    /// How much further along the ray one unit of z is.
    pub(super) stretch: V,
    /// How much nearer or farther than its corners a triangle may be met.
    pub(super) slack: V,
}

/// The order of axes, the one along which the direction is longest last.
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

/// A slope so small that its products with lengths underflow would turn a ray inside a triangle's
/// plane into noise.
pub(super) const LEAST_SLOPE: f32 = 1e-25;

impl<V> ShearedRays<V> {
    /// One ray in all lanes; `axes` are its [`permuted_axes`], and `magnitude` bounds all coordinates
    /// of the scene.
    #[inline(always)]
    pub(super) fn splat<const N: usize>(
        ray: &Ray,
        axes: [usize; 3],
        magnitude: f32,
    ) -> ShearedRays<V>
    where
        V: Floats<N>,
    {
        let [kx, ky, kz] = axes;
        let (o, d) = (ray.origin, ray.direction);
        let growth = GROWTH * (reach(ray) + magnitude);
        // One division in place of three.
        let along = Vec4::new(d[kx], d[ky], 1.0, 1.0) / Vec4::splat(d[kz]);
        let stretch = along.z;
        ShearedRays {
            origin: [V::splat(o[kx]), V::splat(o[ky]), V::splat(o[kz])],
            slopes: [
                V::splat(along.x).zero_below(LEAST_SLOPE),
                V::splat(along.y).zero_below(LEAST_SLOPE),
            ],
            stretch: V::splat(stretch),
            slack: V::splat(growth * stretch.abs()),
        }
    }

    /// A bit for each lane whose ray's line passes through the triangle, if the corners do not all
    /// lie behind the ray's start or beyond `limit`. Corners have permuted axes.
    ///
    /// The edge functions of Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection"
    /// (JCGT 2(1)): those of neighbours are exact negatives of each other, so a line cannot pass
    /// between them. Zero counts as inside. The method's distance is only as good as the largest
    /// coordinate of the triangle, so that is left to [`TrianglePlane`](crate::geometry::TrianglePlane).
    #[inline(always)]
    pub(super) fn pass<const N: usize>(&self, corners: &[[V; 3]; 3], limit: V) -> u32
    where
        V: Floats<N>,
    {
        let (ax, ay, at) = self.shear(corners[0]);
        let (bx, by, bt) = self.shear(corners[1]);
        let (cx, cy, ct) = self.shear(corners[2]);
        let edge_a = cx.mul(by).sub(cy.mul(bx));
        let edge_b = ax.mul(cy).sub(ay.mul(cx));
        let edge_c = bx.mul(ay).sub(by.mul(ax));

        let zero = V::splat(0.0);
        let least = edge_a.min(edge_b).min(edge_c);
        let most = edge_a.max(edge_b).max(edge_c);
        // All three zero: the line lies in the triangle's plane, and does not pass through it.
        let not_flat = least.lt(most) | zero.lt(least) | most.lt(zero);
        let (first, last) = (at.min(bt).min(ct), at.max(bt).max(ct));
        let in_reach = zero.lt(last.add(self.slack)) & first.sub(self.slack).le(limit);
        (zero.le(least) | most.le(zero)) & not_flat & in_reach
    }

    /// Points seen along the ray: x, y, and the ray parameter at their z.
    #[inline(always)]
    fn shear<const N: usize>(&self, [x, y, z]: [V; 3]) -> (V, V, V)
    where
        V: Floats<N>,
    {
        let [ox, oy, oz] = self.origin;
        let [sx, sy] = self.slopes;
        let z = z.sub(oz);
        let (x, y) = (x.sub(ox).sub(sx.mul(z)), y.sub(oy).sub(sy.mul(z)));
        (x, y, z.mul(self.stretch))
    }
}
