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
        let (mut min, mut max) = (a, a);
        for axis in 0..3 {
            min[axis] = a[axis].min(b[axis]).min(c[axis]);
            max[axis] = a[axis].max(b[axis]).max(c[axis]);
        }
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) =
            (widen::<D, N>(a), widen::<D, N>(b), widen::<D, N>(c));
        let (ux, uy, uz) = (bx.sub(ax), by.sub(ay), bz.sub(az));
        let (vx, vy, vz) = (cx.sub(ax), cy.sub(ay), cz.sub(az));
        TrianglePlanes {
            point: [ax, ay, az],
            normal: [
                uy.mul(vz).sub(vy.mul(uz)),
                uz.mul(vx).sub(vz.mul(ux)),
                ux.mul(vy).sub(vx.mul(uy)),
            ],
            min: widen(min),
            max: widen(max),
        }
    }

    /// One triangle in all of `N` lanes.
    #[inline(always)]
    pub(super) fn splat<E: Doubles<N>, const N: usize>(&self) -> TrianglePlanes<E>
    where
        D: Doubles<1>,
    {
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
        let above = nx
            .mul(px.sub(ox))
            .add(ny.mul(py.sub(oy)))
            .add(nz.mul(pz.sub(oz)));
        let t = above.div(nx.mul(dx).add(ny.mul(dy)).add(nz.mul(dz)));
        let x = self.outside(0, ox.add(t.mul(dx)));
        let y = self.outside(1, oy.add(t.mul(dy)));
        let z = self.outside(2, oz.add(t.mul(dz)));
        (t, z.max(x.max(y)))
    }

    /// How far a coordinate is outside the boxes along its axis.
    #[inline(always)]
    fn outside<const N: usize>(&self, axis: usize, at: D) -> D
    where
        D: Doubles<N>,
    {
        self.min[axis].sub(at).max(at.sub(self.max[axis]))
    }
}

#[inline(always)]
fn widen<D: Doubles<N>, const N: usize>([x, y, z]: [D::Floats; 3]) -> [D; 3] {
    [D::widen(x), D::widen(y), D::widen(z)]
}

#[inline(always)]
fn splat<D: Doubles<1>, E: Doubles<N>, const N: usize>([x, y, z]: [D; 3]) -> [E; 3] {
    [
        E::splat(x.store()[0]),
        E::splat(y.store()[0]),
        E::splat(z.store()[0]),
    ]
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
