//! Box tests of a packet as a whole, by interval arithmetic (Boulos et al. 2006, "Geometric and Arithmetic Culling
//! Methods for Entire Ray Packets").

use super::constants::WIDTH;
use super::ray_packet::RayPacket;
use super::ray_setup::RaySetup;
use super::rounding::BOX_PADDING;
use crate::simd::{Floats, PACKET_WIDTH};

/// Rays whose directions lie in one octant: the intervals of their origins and reciprocal directions.
pub(super) struct PacketInterval {
    /// Whether the rays descend: they enter boxes through their upper planes.
    down: [bool; 3],
    /// The origin farthest along the direction, and the one farthest back, padded outwards.
    last_origin: [f32; 3],
    first_origin: [f32; 3],
    /// The interval of the reciprocals of directions.
    min_inverse: [f32; 3],
    max_inverse: [f32; 3],
}

impl PacketInterval {
    /// Of a packet whose directions lie in one octant.
    #[inline(always)]
    pub(super) fn new<V: Floats<PACKET_WIDTH>>(
        packet: &RayPacket,
        setup: &RaySetup<PACKET_WIDTH>,
    ) -> PacketInterval {
        let padding = BOX_PADDING * V::load(&setup.origin_magnitude).reduce_max();
        let mut interval = PacketInterval {
            down: [false; 3],
            last_origin: [0.0; 3],
            first_origin: [0.0; 3],
            min_inverse: [0.0; 3],
            max_inverse: [0.0; 3],
        };
        for axis in 0..3 {
            let down = setup.down[axis] != 0;
            let inverse = V::load(&setup.inverse[axis]);
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
            let (min, max) = (inverse.reduce_min(), inverse.reduce_max());
            interval.min_inverse[axis] = min;
            interval.max_inverse[axis] = max;
            if min.is_infinite() || max.is_infinite() {
                // Its products bound nothing: NaN culls nothing.
                interval.first_origin[axis] = f32::NAN;
                interval.last_origin[axis] = f32::NAN;
            }
        }
        interval
    }

    /// Bounds of where the first ray enters each of eight boxes, and of where the last one leaves it.
    #[inline(always)]
    pub(super) fn intersect_boxes<W: Floats<WIDTH>>(
        &self,
        planes: &[[W; 2]; 3],
        max_limit: f32,
    ) -> (W, W) {
        let mut near = W::splat(0.0);
        let mut far = W::splat(max_limit);
        for (axis, [lower, upper]) in planes.iter().enumerate() {
            let min = W::splat(self.min_inverse[axis]);
            let max = W::splat(self.max_inverse[axis]);
            let (entry, exit) = match self.down[axis] {
                false => (lower, upper),
                true => (upper, lower),
            };
            let entry = entry.sub(W::splat(self.last_origin[axis]));
            let exit = exit.sub(W::splat(self.first_origin[axis]));
            near = entry.mul(min).min(entry.mul(max)).max(near);
            far = exit.mul(min).max(exit.mul(max)).min(far);
        }
        (near, far)
    }
}
