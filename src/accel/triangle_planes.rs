//! Where lines meet the planes of triangles: in double precision, where the rounding of a few operations on
//! single-precision vertices is negligible.

use super::rounding::triangle_padding;
use crate::math::Ray;
use crate::simd::{Doubles, Floats};
use glam::Vec3;

/// The planes and the boxes of `N` triangles, coordinate by coordinate.
#[derive(Clone, Copy)]
pub(super) struct TrianglePlanes<D> {
    point: [D; 3],
    normal: [D; 3],
    min: [D; 3],
    max: [D; 3],
}

impl<D> TrianglePlanes<D> {
    /// The planes through three vertices each.
    #[inline(always)]
    pub(super) fn through<const N: usize>([a, b, c]: [[D::Floats; 3]; 3]) -> TrianglePlanes<D>
    where
        D: Doubles<N>,
    {
        let widen = |[x, y, z]: [D::Floats; 3]| [D::widen(x), D::widen(y), D::widen(z)];
        let min = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let max = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (widen(a), widen(b), widen(c));
        let (ux, uy, uz) = (bx.sub(ax), by.sub(ay), bz.sub(az));
        let (vx, vy, vz) = (cx.sub(ax), cy.sub(ay), cz.sub(az));
        TrianglePlanes {
            point: [ax, ay, az],
            normal: [
                uy.mul(vz).sub(vy.mul(uz)),
                uz.mul(vx).sub(vz.mul(ux)),
                ux.mul(vy).sub(vx.mul(uy)),
            ],
            min: widen([min(0), min(1), min(2)]),
            max: widen([max(0), max(1), max(2)]),
        }
    }

    /// One triangle in all of `N` lanes.
    #[inline(always)]
    pub(super) fn splat<E: Doubles<N>, const N: usize>(&self) -> TrianglePlanes<E>
    where
        D: Doubles<1>,
    {
        let splat = |[x, y, z]: [D; 3]| {
            let splat = |x: D| E::splat(x.store()[0]);
            [splat(x), splat(y), splat(z)]
        };
        TrianglePlanes {
            point: splat(self.point),
            normal: splat(self.normal),
            min: splat(self.min),
            max: splat(self.max),
        }
    }

    /// The parameters at which lines meet the planes, not finite for a line in its plane; and how far that is
    /// outside the triangle's box, along the axis where it is farthest: not above 0 inside.
    #[inline(always)]
    pub(super) fn intersect<const N: usize>(&self, origin: [D; 3], direction: [D; 3]) -> (D, D)
    where
        D: Doubles<N>,
    {
        let ([nx, ny, nz], [px, py, pz]) = (self.normal, self.point);
        let ([ox, oy, oz], [dx, dy, dz]) = (origin, direction);
        let above = nx.mul(px.sub(ox)).add(ny.mul(py.sub(oy))).add(nz.mul(pz.sub(oz)));
        let t = above.div(nx.mul(dx).add(ny.mul(dy)).add(nz.mul(dz)));
        let outside = |axis: usize, o: D, d: D| {
            let at = o.add(t.mul(d));
            self.min[axis].sub(at).max(at.sub(self.max[axis]))
        };
        let (x, y, z) = (outside(0, ox, dx), outside(1, oy, dy), outside(2, oz, dz));
        (t, z.max(x.max(y)))
    }
}

/// The parameter nearest to `t` at which the ray is inside the triangle's box, padded on all sides; NaN if it misses
/// that box.
///
/// It replaces a `t` whose point is outside, so that hits do not depend on which boxes of a tree are visited in
/// which order, however steep the plane.
#[cold]
#[inline(never)]
pub(super) fn clamp_to_box(ray: &Ray, vertices: [Vec3; 3], t: f64) -> f64 {
    let [a, b, c] = vertices;
    let (min, max) = (a.min(b).min(c), a.max(b).max(c));
    let magnitude = f64::from(max.max(-min).max_element());
    let padding = triangle_padding(f64::from(ray.origin.abs().max_element()) + magnitude);
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (min, max) = (min.as_dvec3(), max.as_dvec3());
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let inverse = 1.0 / direction[axis];
        let low = (min[axis] - padding - origin[axis]) * inverse;
        let high = (max[axis] + padding - origin[axis]) * inverse;
        // A line in the plane of a box's side gives NaN, which `min` and `max` ignore.
        near = near.max(low.min(high));
        far = far.min(low.max(high));
    }
    if near <= far && t.is_finite() {
        t.clamp(near, far)
    } else {
        f64::NAN
    }
}
