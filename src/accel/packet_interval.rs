//! Box tests of a packet: for each ray, and for the packet as a whole by interval arithmetic (Boulos et al.
//! 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets").

use super::constants::WIDTH;
use super::node::Node;
use super::ray_packet::RayPacket;
use super::ray_setup::RaySetup;
use super::rounding::BOX_PADDING;
use crate::simd::{Floats, PACKET_WIDTH};

/// What box tests need of rays whose directions lie in one octant: each ray, and the intervals of origins
/// and reciprocal directions of all.
pub(super) struct PacketInterval<V> {
    /// Axis by axis: t = plane * inverse - offset.
    inverse: [V; 3],
    near_offset: [V; 3],
    far_offset: [V; 3],
    /// Whether the rays descend: they enter boxes through their upper planes.
    down: [bool; 3],
    /// The origin farthest along the direction, and the one farthest back, padded outwards.
    last_origin: [f32; 3],
    first_origin: [f32; 3],
    /// The interval of the reciprocals of directions.
    min_inverse: [f32; 3],
    max_inverse: [f32; 3],
}

impl<V: Floats<PACKET_WIDTH>> PacketInterval<V> {
    /// Of a packet whose directions lie in one octant.
    #[inline(always)]
    pub(super) fn new(packet: &RayPacket, setup: &RaySetup<PACKET_WIDTH>) -> PacketInterval<V> {
        let zero = V::splat(0.0);
        let padding = BOX_PADDING * V::load(&setup.origin_magnitude).reduce_max();
        let mut interval = PacketInterval {
            inverse: [zero; 3],
            near_offset: [zero; 3],
            far_offset: [zero; 3],
            down: [false; 3],
            last_origin: [0.0; 3],
            first_origin: [0.0; 3],
            min_inverse: [0.0; 3],
            max_inverse: [0.0; 3],
        };
        for axis in 0..3 {
            let down = setup.down[axis] != 0;
            let inverse = V::load(&setup.inverse[axis]);
            interval.inverse[axis] = inverse;
            interval.near_offset[axis] = V::load(&setup.near_offset[axis]);
            interval.far_offset[axis] = V::load(&setup.far_offset[axis]);
            interval.down[axis] = down;
            let origin = V::load(&packet.origin[axis]);
            let lowest = origin.reduce_min() - padding;
            let highest = origin.reduce_max() + padding;
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
        interval
    }

    /// As [`Node::intersect_boxes`], for the packet as a whole: bounds of where the first ray enters each
    /// box, and of where the last one leaves it.
    #[inline(always)]
    pub(super) fn intersect_boxes<W: Floats<WIDTH>>(
        &self,
        planes: &[[W; 2]; 3],
        max_limit: f32,
    ) -> (W, W) {
        let mut near = W::splat(0.0);
        let mut far = W::splat(max_limit);
        for axis in 0..3 {
            let min = W::splat(self.min_inverse[axis]);
            let max = W::splat(self.max_inverse[axis]);
            let [mut entry, mut exit] = planes[axis];
            if self.down[axis] {
                (entry, exit) = (exit, entry);
            }
            let entry = entry.sub(W::splat(self.last_origin[axis]));
            let exit = exit.sub(W::splat(self.first_origin[axis]));
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
            let sides = &node.planes[axis];
            let entry = V::splat(sides[usize::from(self.down[axis])][child]);
            let exit = V::splat(sides[usize::from(!self.down[axis])][child]);
            near = entry.mul_sub(inverse, self.near_offset[axis]).max(near);
            far = exit.mul_sub(inverse, self.far_offset[axis]).min(far);
        }
        near.le(far)
    }
}

