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
    behind: V,
}

/// Smaller slopes count as 0: their products with lengths would underflow and turn a ray in a triangle's
/// plane into noise.
pub(super) const MIN_SLOPE: f32 = 1e-25;

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

#[cfg(test)]
mod tests {
    use super::super::bvh::Bvh;
    use super::super::hit_filter::DISTANCE_PADDING;
    use super::super::query_state::QueryState;
    use super::*;
    use crate::math::Ray;
    use crate::sampling::Random;
    use crate::simd::{Kernel, Scalar};
    use glam::Vec3;

    /// Whether a triangle passes for a query whose best hit is at `t`, with a share of the error bound of depths.
    fn passes(ray: &Ray, triangle: [Vec3; 3], t: f64, share: f32) -> bool {
        let scalars = |v: Vec3| v.to_array().map(Scalar::splat);
        let magnitude = triangle
            .map(|v| v.abs().max_element())
            .into_iter()
            .fold(0.0, f32::max);
        let setup = RaySetup::<1>::new(scalars(ray.origin), scalars(ray.direction), magnitude);
        let [kx, ky, kz] = setup.axes(0);
        let permuted = triangle.map(|v| scalars(Vec3::new(v[kx], v[ky], v[kz])));
        let [error] = setup.depth_error.map(|error| share * error);
        let rays = ShearedRays::<Scalar> {
            behind: Scalar::splat(-error),
            ..ShearedRays::load(&setup)
        };
        let limit = t as f32 * DISTANCE_PADDING + error;
        rays.intersect(&permuted, Scalar::splat(limit)) != 0
    }

    /// The margin of the test of depths: hits are never culled, and those of steep triangles that rays pass by a hair
    /// need most of what is derived.
    #[test]
    fn depths_are_culled_only_beyond_their_error_bound() {
        let mut random = Random::new(3);
        let mut query_state = QueryState::default();
        let (mut hits, mut largest_share) = (0, 0.0_f32);
        for _ in 0..200_000 {
            let size = 10_f32.powf(4.0 * random.unit());
            let origin = random.vector(size);
            let direction = random.vector(1.0);
            let ray = Ray::new(origin, direction);
            // Along the ray, off it by some units in the last place.
            let mut vertex = || {
                let along = ray.at((2.0 * random.unit()).into()).as_vec3();
                along + random.vector(4.0 * f32::EPSILON * size)
            };
            let triangle = [vertex(), vertex(), vertex()];
            let bvh = Bvh::new(&[triangle], vec![], Kernel::PORTABLE);
            let Some(hit) = bvh.closest(&ray, &mut query_state) else {
                continue;
            };
            hits += 1;
            assert!(passes(&ray, triangle, hit.t, 1.0), "{ray:?} {triangle:?}");
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..10 {
                let share = 0.5 * (low + high);
                if passes(&ray, triangle, hit.t, share) {
                    high = share;
                } else {
                    low = share;
                }
            }
            largest_share = largest_share.max(low);
        }
        assert!(hits > 10_000);
        // Derived: 9.5 of 16.
        assert!((0.4..0.6).contains(&largest_share), "{largest_share}");
    }
}
