//! Leaves of up to eight triangles, as a structure of arrays.

use super::constants::WIDTH;
use super::hit_filter::{DISTANCE_PADDING, accept_hit};
use super::rounding::{BOX_PADDING, triangle_padding};
use super::single_ray::SingleRay;
use super::triangle_planes::{TrianglePlanes, clamp_to_box};
use crate::geometry::Hit;
use crate::simd::{Doubles, Floats, SetBits, Simd};
use glam::Vec3;

/// Up to eight triangles, coordinate by coordinate; unused lanes repeat the last.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct TriangleBlock {
    /// `vertices[vertex][axis][lane]`.
    vertices: [[[f32; WIDTH]; 3]; 3],
    /// The triangles' numbers, ascending.
    ids: [u32; WIDTH],
}

impl TriangleBlock {
    /// Packs one to eight of `triangles`, given by ascending numbers.
    pub(super) fn new(ids: &[u32], triangles: &[[Vec3; 3]]) -> TriangleBlock {
        let ids: [u32; WIDTH] = std::array::from_fn(|lane| ids[lane.min(ids.len() - 1)]);
        // Sorted, so that triangles with the same vertices are at the same distance to the bit.
        let sorted = ids.map(|id| {
            let mut vertices = triangles[id as usize];
            vertices.sort_unstable_by_key(|vertex| vertex.to_array().map(f32::to_bits));
            vertices
        });
        let vertices = std::array::from_fn(|vertex| {
            std::array::from_fn(|axis| sorted.map(|vertices| vertices[vertex][axis]))
        });
        TriangleBlock { vertices, ids }
    }

    /// The triangles' numbers; the last may be repeated.
    pub(super) fn ids(&self) -> &[u32; WIDTH] {
        &self.ids
    }

    /// How many triangles there are.
    pub(super) fn count(&self) -> usize {
        1 + self.ids.windows(2).filter(|ids| ids[0] != ids[1]).count()
    }

    /// Passes the triangles that the ray meets to the query, with `best` so far; returns whether the query
    /// is finished.
    #[inline(always)]
    pub(super) fn intersect<S: Simd, const ANY_HIT: bool>(
        &self,
        ray: &SingleRay<S>,
        best: &mut Hit,
    ) -> bool {
        let limit = if ANY_HIT {
            ray.ray.t_max
        } else {
            best.t as f32
        };
        let limit = S::F32x8::splat(limit * DISTANCE_PADDING + ray.depth_error);
        let vertices = self.load_vertices::<S::F32x8>(ray.axes);
        let passed = ray.sheared.intersect(&vertices, limit);
        if passed == 0 {
            return false;
        }
        let planes = TrianglePlanes::<S::F64x8>::through(self.load_vertices([0, 1, 2]));
        let (o, d) = (ray.ray.origin, ray.ray.direction);
        let splat = S::F64x8::splat;
        let origin = [splat(o.x.into()), splat(o.y.into()), splat(o.z.into())];
        let direction = [splat(d.x.into()), splat(d.y.into()), splat(d.z.into())];
        let (distances, outside) = planes.intersect(origin, direction);
        let padding = triangle_padding(ray.origin_magnitude.into());
        // Not where that is NaN. Mostly all, and then the triangles' own magnitudes are not needed.
        let inside = passed & outside.le(S::F64x8::splat(padding));
        let mut distances = distances.store();
        for lane in SetBits(passed & !inside) {
            distances[lane % WIDTH] = clamp_to_box(
                ray.ray,
                self.triangle(lane % WIDTH),
                distances[lane % WIDTH],
            );
        }
        for lane in SetBits(passed) {
            let lane = lane % WIDTH;
            if accept_hit::<ANY_HIT>(ray.ray, distances[lane], self.ids[lane], best) {
                return true;
            }
        }
        false
    }

    /// All triangles, one for each lane.
    #[inline(always)]
    fn load_vertices<V: Floats<WIDTH>>(&self, [kx, ky, kz]: [usize; 3]) -> [[V; 3]; 3] {
        // Spelled out: code in closures would not be compiled for the vector instructions.
        let [a, b, c] = &self.vertices;
        [
            [V::load(&a[kx]), V::load(&a[ky]), V::load(&a[kz])],
            [V::load(&b[kx]), V::load(&b[ky]), V::load(&b[kz])],
            [V::load(&c[kx]), V::load(&c[ky]), V::load(&c[kz])],
        ]
    }

    /// The planes of all triangles' boxes, as those of a node: padded relative to their coordinates.
    #[inline(always)]
    pub(super) fn planes<V: Floats<WIDTH>>(&self) -> [[V; 2]; 3] {
        let [a, b, c] = self.load_vertices::<V>([0, 1, 2]);
        let (mut min, mut max) = (a, a);
        let mut magnitude = V::splat(0.0);
        for axis in 0..3 {
            min[axis] = a[axis].min(b[axis]).min(c[axis]);
            max[axis] = a[axis].max(b[axis]).max(c[axis]);
            let size = max[axis].max(V::splat(0.0).sub(min[axis]));
            magnitude = magnitude.max(size);
        }
        let padding = magnitude.mul(V::splat(BOX_PADDING));
        [
            [min[0].sub(padding), max[0].add(padding)],
            [min[1].sub(padding), max[1].add(padding)],
            [min[2].sub(padding), max[2].add(padding)],
        ]
    }

    /// One triangle in all lanes.
    #[inline(always)]
    pub(super) fn splat_triangle<V: Floats<N>, const N: usize>(
        &self,
        lane: usize,
        [kx, ky, kz]: [usize; 3],
    ) -> [[V; 3]; 3] {
        let [a, b, c] = &self.vertices;
        let splat = V::splat;
        [
            [splat(a[kx][lane]), splat(a[ky][lane]), splat(a[kz][lane])],
            [splat(b[kx][lane]), splat(b[ky][lane]), splat(b[kz][lane])],
            [splat(c[kx][lane]), splat(c[ky][lane]), splat(c[kz][lane])],
        ]
    }

    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.vertices;
        let vertex = |[x, y, z]: &[[f32; WIDTH]; 3]| Vec3::new(x[lane], y[lane], z[lane]);
        [vertex(a), vertex(b), vertex(c)]
    }
}
