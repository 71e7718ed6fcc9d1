use super::WIDTH;
use super::rounding::{GROWTH, reach, triangle_growth};
use super::simd::Floats;
use super::watertight::ShearedRays;
use crate::geometry::{Hit, TrianglePlane};
use crate::math::Ray;
use glam::Vec3;

/// Grows a rounded distance beyond what rounding took away: nothing as near to single precision is
/// culled by it.
pub(super) const PADDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Up to eight triangles, coordinate by coordinate; a lane that is not needed repeats the last.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct TriangleBlock {
    /// `corners[corner][axis][lane]`.
    corners: [[[f32; WIDTH]; 3]; 3],
    /// The triangles' numbers, rising.
    ids: [u32; WIDTH],
}

impl TriangleBlock {
    /// Takes one to eight rising numbers of `triangles`.
    pub(super) fn new(ids: &[u32], triangles: &[[Vec3; 3]]) -> TriangleBlock {
        let ids: [u32; WIDTH] = std::array::from_fn(|lane| ids[lane.min(ids.len() - 1)]);
        // In an order of their own: of triangles with the same corners all are as far away, bit by bit.
        let sorted = ids.map(|id| {
            let mut corners = triangles[id as usize];
            corners.sort_unstable_by_key(|corner| corner.to_array().map(f32::to_bits));
            corners
        });
        let corners = std::array::from_fn(|corner| {
            std::array::from_fn(|axis| sorted.map(|corners| corners[corner][axis]))
        });
        TriangleBlock { corners, ids }
    }

    /// The triangles' numbers; the last may be repeated.
    pub(super) fn ids(&self) -> &[u32; WIDTH] {
        &self.ids
    }

    /// How many triangles there are.
    pub(super) fn count(&self) -> usize {
        1 + self.ids.windows(2).filter(|ids| ids[0] != ids[1]).count()
    }

    /// Takes over every triangle that the ray meets nearer than `best`, or as near with a lower
    /// number.
    #[inline(always)]
    pub(super) fn closest<V: Floats<WIDTH>>(
        &self,
        ray: &Ray,
        axes: [usize; 3],
        sheared: &ShearedRays<V>,
        best: &mut Hit,
    ) {
        let limit = V::splat(best.t as f32 * PADDING);
        let mut passed = sheared.pass(&self.all(axes), limit);
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize;
            passed &= passed - 1;
            let t = self.distance(lane, ray);
            take_nearer(ray, t, self.ids[lane], best);
        }
    }

    /// Whether the ray meets any of the triangles in its interval.
    #[inline(always)]
    pub(super) fn occludes<V: Floats<WIDTH>>(
        &self,
        ray: &Ray,
        axes: [usize; 3],
        sheared: &ShearedRays<V>,
    ) -> bool {
        let limit = V::splat(ray.t_max * PADDING);
        let mut passed = sheared.pass(&self.all(axes), limit);
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize;
            passed &= passed - 1;
            let t = self.distance(lane, ray);
            if is_in_the_way(ray, t, self.ids[lane]) {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn distance(&self, lane: usize, ray: &Ray) -> f64 {
        let plane = TrianglePlane::through(self.triangle(lane));
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let t = plane.distance(origin, direction);
        let reach = f64::from(reach(ray));
        // False for NaN. Mostly so, and then the triangle's own coordinates need no look.
        if plane.outside(origin + t * direction) <= triangle_growth(reach) {
            t
        } else {
            let growth = triangle_growth(reach + plane.magnitude());
            plane.distance_in_box(origin, direction, growth, t)
        }
    }

    /// All triangles, one for each lane.
    #[inline(always)]
    fn all<V: Floats<WIDTH>>(&self, [kx, ky, kz]: [usize; 3]) -> [[V; 3]; 3] {
        // Spelled out: code in closures would not be compiled for the vector instructions.
        let [a, b, c] = &self.corners;
        [
            [V::load(&a[kx]), V::load(&a[ky]), V::load(&a[kz])],
            [V::load(&b[kx]), V::load(&b[ky]), V::load(&b[kz])],
            [V::load(&c[kx]), V::load(&c[ky]), V::load(&c[kz])],
        ]
    }

    /// The planes of all triangles' boxes, as those of a node: grown in proportion to their coordinates.
    #[inline(always)]
    pub(super) fn planes<V: Floats<WIDTH>>(&self) -> [V; 6] {
        let [a, b, c] = self.all::<V>([0, 1, 2]);
        let (mut least, mut greatest) = (a, a);
        let mut magnitude = V::splat(0.0);
        for axis in 0..3 {
            least[axis] = a[axis].min(b[axis]).min(c[axis]);
            greatest[axis] = a[axis].max(b[axis]).max(c[axis]);
            let size = greatest[axis].max(V::splat(0.0).sub(least[axis]));
            magnitude = magnitude.max(size);
        }
        let growth = magnitude.mul(V::splat(GROWTH));
        [
            least[0].sub(growth),
            least[1].sub(growth),
            least[2].sub(growth),
            greatest[0].add(growth),
            greatest[1].add(growth),
            greatest[2].add(growth),
        ]
    }

    /// One triangle in all lanes.
    #[inline(always)]
    pub(super) fn one<V: Floats<N>, const N: usize>(
        &self,
        lane: usize,
        [kx, ky, kz]: [usize; 3],
    ) -> [[V; 3]; 3] {
        let [a, b, c] = &self.corners;
        let splat = V::splat;
        [
            [splat(a[kx][lane]), splat(a[ky][lane]), splat(a[kz][lane])],
            [splat(b[kx][lane]), splat(b[ky][lane]), splat(b[kz][lane])],
            [splat(c[kx][lane]), splat(c[ky][lane]), splat(c[kz][lane])],
        ]
    }

    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.corners;
        let corner = |[x, y, z]: &[[f32; WIDTH]; 3]| Vec3::new(x[lane], y[lane], z[lane]);
        [corner(a), corner(b), corner(c)]
    }
}

/// Takes over a primitive that the ray meets at `t` if it is nearer than `best`; at the same
/// distance, to a share of 2^-28, if its number is lower.
#[inline(always)]
pub(super) fn take_nearer(ray: &Ray, t: f64, primitive: u32, best: &mut Hit) {
    // The bits of numbers above 0 are in their order. Rounding moves the distances of two triangles in one
    // plane, but hardly ever into another share.
    let (rounded, best_rounded) = (t.to_bits() >> 24, best.t.to_bits() >> 24);
    let is_before =
        rounded < best_rounded || (rounded == best_rounded && primitive < best.primitive);
    if t > 0.0 && primitive != ray.exclude && is_before {
        *best = Hit { t, primitive };
    }
}

/// Whether a primitive that the ray meets at `t` lies in its interval.
#[inline(always)]
pub(super) fn is_in_the_way(ray: &Ray, t: f64, primitive: u32) -> bool {
    t > 0.0 && t < f64::from(ray.t_max) && primitive != ray.exclude
}
