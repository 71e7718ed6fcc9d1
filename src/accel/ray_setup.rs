//! What box and triangle tests need of rays, computed for as many rays at once as a vector holds.
//!
//! The same for one ray and for a packet: the same operations, so the same bits.

use super::rounding::BOX_PADDING;
use crate::simd::Floats;
use glam::Vec3;

/// Components of a direction that are smaller than this, relative to the largest, count as this much: their
/// reciprocals would overflow. That moves a ray by less than boxes are padded.
const MIN_DIRECTION: f32 = 1e-18;

/// Smaller slopes count as 0: their products with lengths would underflow and turn a ray in a triangle's plane into
/// noise.
const MIN_SLOPE: f32 = 1e-25;

/// The permutations of the axes, by the one that comes last.
const PERMUTATIONS: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// `N` rays, prepared; `[axis][lane]`.
#[repr(C, align(64))]
pub(super) struct RaySetup<const N: usize> {
    /// The reciprocal of the direction. A ray meets a plane of a padded box at plane * inverse - offset.
    pub(super) inverse: [[f32; N]; 3],
    /// The origin's part where the ray enters a padded box, and where it leaves.
    pub(super) near_offset: [[f32; N]; 3],
    pub(super) far_offset: [[f32; N]; 3],
    /// The origin in the ray's own axes: permuted, so that the direction is longest along the last.
    pub(super) origin: [[f32; N]; 3],
    /// The direction's slopes along the first two of its own axes against the last.
    pub(super) slopes: [[f32; N]; 2],
    /// The ray parameter of one unit along the last of its own axes.
    pub(super) inv_dz: [f32; N],
    /// The error bound of the ray parameter of a vertex, in either direction: [`BOX_PADDING`] of the magnitude M of
    /// ray and scene, in units of the last axis. No hit is farther before the nearest of a triangle's vertices, or
    /// behind the farthest: it lies in the triangle's box, padded by [`TRIANGLE_PADDING`] (8 epsilon of M), and three
    /// roundings move a vertex by 1.5 epsilon of M more. That is 9.5 of 16.
    ///
    /// [`TRIANGLE_PADDING`]: super::rounding::TRIANGLE_PADDING
    pub(super) depth_error: [f32; N],
    /// The largest absolute coordinate of the origin.
    pub(super) origin_magnitude: [f32; N],
    /// The mask of rays that descend along each axis.
    pub(super) down: [u32; 3],
    /// The masks of rays whose direction is longest along x, and along y.
    pub(super) mainly: [u32; 2],
}

impl<const N: usize> RaySetup<N> {
    /// Prepares rays; `scene_magnitude` bounds the absolute coordinates of the scene.
    #[inline(always)]
    pub(super) fn new<V: Floats<N>>(
        origin: [V; 3],
        direction: [V; 3],
        scene_magnitude: f32,
    ) -> RaySetup<N> {
        let [ox, oy, oz] = origin;
        let [dx, dy, dz] = direction;
        let (one, zero) = (V::splat(1.0), V::splat(0.0));
        let [x, y, z] = [dx.abs(), dy.abs(), dz.abs()];
        let (yz, largest) = (y.max(z), x.max(y).max(z));
        let by_major =
            |of_x: V, of_y: V, of_z: V| yz.select_le(x, of_x, z.select_le(y, of_y, of_z));
        let major = by_major(dx, dy, dz);
        let inv_dz = one.div(major);
        let slope = |along: V| along.div(major).zero_below(MIN_SLOPE);
        let magnitude = ox.abs().max(oy.abs()).max(oz.abs());
        let depth_padding = V::splat(BOX_PADDING).mul(magnitude.add(V::splat(scene_magnitude)));
        let box_padding = V::splat(BOX_PADDING).mul(magnitude);
        let smallest = V::splat(MIN_DIRECTION).mul(largest);
        let reciprocal = |size: V, d: V| one.div(size.max(smallest)).copy_sign(d);
        let inverse = [reciprocal(x, dx), reciprocal(y, dy), reciprocal(z, dz)];
        let center = [
            finite_or_nan(ox.mul(inverse[0])),
            finite_or_nan(oy.mul(inverse[1])),
            finite_or_nan(oz.mul(inverse[2])),
        ];
        let around = [
            box_padding.mul(inverse[0].abs()),
            box_padding.mul(inverse[1].abs()),
            box_padding.mul(inverse[2].abs()),
        ];
        let mainly_x = yz.le(x);
        RaySetup {
            inverse: [inverse[0].store(), inverse[1].store(), inverse[2].store()],
            near_offset: [
                center[0].add(around[0]).store(),
                center[1].add(around[1]).store(),
                center[2].add(around[2]).store(),
            ],
            far_offset: [
                center[0].sub(around[0]).store(),
                center[1].sub(around[1]).store(),
                center[2].sub(around[2]).store(),
            ],
            origin: [
                by_major(oy, oz, ox).store(),
                by_major(oz, ox, oy).store(),
                by_major(ox, oy, oz).store(),
            ],
            slopes: [
                slope(by_major(dy, dz, dx)).store(),
                slope(by_major(dz, dx, dy)).store(),
            ],
            inv_dz: inv_dz.store(),
            depth_error: depth_padding.mul(inv_dz.abs()).store(),
            origin_magnitude: magnitude.store(),
            down: [
                inverse[0].lt(zero),
                inverse[1].lt(zero),
                inverse[2].lt(zero),
            ],
            mainly: [mainly_x, z.le(y) & !mainly_x],
        }
    }

    /// The permutation of a ray's axes, the one along which its direction is longest last.
    #[inline(always)]
    pub(super) fn axes(&self, lane: usize) -> [usize; 3] {
        let [x, y] = self.mainly.map(|mask| mask >> lane & 1);
        PERMUTATIONS[(2 - 2 * x - y) as usize % 3]
    }

    /// Whether all rays have the same permutation of their axes.
    #[inline(always)]
    pub(super) fn is_one_major_axis(&self) -> bool {
        self.mainly.iter().all(|mask| is_uniform::<N>(*mask))
    }

    /// Whether all directions lie in one octant.
    #[inline(always)]
    pub(super) fn is_one_octant(&self) -> bool {
        self.down.iter().all(|mask| is_uniform::<N>(*mask))
    }
}

/// Whether a mask holds all or none of `N` lanes.
#[inline(always)]
fn is_uniform<const N: usize>(mask: u32) -> bool {
    mask == 0 || mask == (1 << N) - 1
}

/// NaN where a number is infinite, so that it culls nothing, however the products with it are rounded.
#[inline(always)]
fn finite_or_nan<V: Floats<N>, const N: usize>(x: V) -> V {
    x.add(x.sub(x))
}

/// The axis along which a direction is longest, for NaN, too, as the setup finds it.
#[inline(always)]
pub(super) fn major_axis(direction: Vec3) -> usize {
    let [x, y, z] = direction.abs().to_array();
    let larger = if y > z { y } else { z };
    match (larger <= x, z <= y) {
        (true, _) => 0,
        (false, true) => 1,
        (false, false) => 2,
    }
}
