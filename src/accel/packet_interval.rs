//! Box tests of a packet: for each ray, and for the packet as a whole by interval arithmetic (Boulos et al.
//! 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets").

use super::constants::WIDTH;
use super::node::{MIN_DIRECTION, Node};
use super::packet_intersector::PacketIntersector;
use super::rounding::BOX_PADDING;
use crate::simd::{ALL_LANES, Floats, PACKET_WIDTH};

/// What box tests need of rays whose directions lie in one octant: each ray, and the intervals of origins
/// and reciprocal directions of all.
pub(super) struct PacketInterval<V> {
    /// Axis by axis: t = plane * inverse - offset.
    inverse: [V; 3],
    near_offset: [V; 3],
    far_offset: [V; 3],
    /// The index of the plane through which rays enter a box, for each axis, and of that through which
    /// they leave.
    near: [usize; 3],
    far: [usize; 3],
    /// The origin farthest along the direction, and the one farthest back, padded outwards.
    last_origin: [f32; 3],
    first_origin: [f32; 3],
    /// The interval of the reciprocals of directions.
    min_inverse: [f32; 3],
    max_inverse: [f32; 3],
}

impl<V: Floats<PACKET_WIDTH>> PacketInterval<V> {
    /// None if the directions do not lie in one octant.
    #[inline(always)]
    pub(super) fn new(rays: &PacketIntersector<V>) -> Option<PacketInterval<V>> {
        let (origin, direction) = (rays.origin, rays.direction);
        let zero = V::splat(0.0);
        let down = [
            direction[0].lt(zero),
            direction[1].lt(zero),
            direction[2].lt(zero),
        ];
        for lanes in down {
            if lanes != 0 && lanes != ALL_LANES {
                return None;
            }
        }
        let sizes = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
        let smallest = sizes[0]
            .max(sizes[1])
            .max(sizes[2])
            .mul(V::splat(MIN_DIRECTION));
        let padding = rays.origin_magnitude.mul(V::splat(BOX_PADDING));
        let max_padding = padding.reduce_max();
        let mut interval = PacketInterval {
            inverse: [zero; 3],
            near_offset: [zero; 3],
            far_offset: [zero; 3],
            near: [0; 3],
            far: [0; 3],
            last_origin: [0.0; 3],
            first_origin: [0.0; 3],
            min_inverse: [0.0; 3],
            max_inverse: [0.0; 3],
        };
        for axis in 0..3 {
            let down = down[axis] != 0;
            let size = sizes[axis].max(smallest);
            let inverse = V::splat(if down { -1.0 } else { 1.0 }).div(size);
            let (center, around) = (origin[axis].mul(inverse), padding.mul(inverse.abs()));
            interval.inverse[axis] = inverse;
            interval.near_offset[axis] = center.add(around);
            interval.far_offset[axis] = center.sub(around);
            // The lower planes come first, the upper ones three after.
            interval.near[axis] = axis + 3 * usize::from(down);
            interval.far[axis] = axis + 3 * usize::from(!down);
            let lowest = origin[axis].reduce_min() - max_padding;
            let highest = origin[axis].reduce_max() + max_padding;
            let [first, last] = if down {
                [highest, lowest]
            } else {
                [lowest, highest]
            };
            interval.first_origin[axis] = first;
            interval.last_origin[axis] = last;
            interval.min_inverse[axis] = inverse.reduce_min();
            interval.max_inverse[axis] = inverse.reduce_max();
        }
        Some(interval)
    }

    /// As [`Node::intersect_boxes`], for the packet as a whole: bounds of where the first ray enters each
    /// box, and of where the last one leaves it.
    #[inline(always)]
    pub(super) fn intersect_boxes<W: Floats<WIDTH>>(
        &self,
        planes: &[W; 6],
        max_limit: f32,
    ) -> (W, W) {
        let mut near = W::splat(0.0);
        let mut far = W::splat(max_limit);
        for axis in 0..3 {
            let min = W::splat(self.min_inverse[axis]);
            let max = W::splat(self.max_inverse[axis]);
            let entry = planes[self.near[axis]].sub(W::splat(self.last_origin[axis]));
            let exit = planes[self.far[axis]].sub(W::splat(self.first_origin[axis]));
            near = entry.mul(min).min(entry.mul(max)).max(near);
            far = exit.mul(min).max(exit.mul(max)).min(far);
        }
        (near, far)
    }

    /// The mask of rays that may enter the box of a child within their limits.
    #[inline(always)]
    pub(super) fn intersect_child(&self, node: &Node, child: usize, limits: V) -> u32 {
        let mut near = V::splat(0.0);
        let mut far = limits;
        for axis in 0..3 {
            let inverse = self.inverse[axis];
            let entry = V::splat(node.planes[self.near[axis]][child]);
            let exit = V::splat(node.planes[self.far[axis]][child]);
            near = entry.mul_sub(inverse, self.near_offset[axis]).max(near);
            far = exit.mul_sub(inverse, self.far_offset[axis]).min(far);
        }
        near.le(far)
    }
}
