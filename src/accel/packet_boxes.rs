//! Box tests of a packet: one ray in each lane, whatever their directions.

use super::constants::WIDTH;
use super::node::Node;
use super::ray_setup::RaySetup;
use crate::simd::{Floats, PACKET_WIDTH};

/// What box tests need of each ray: t = plane * inverse - offset, axis by axis.
pub(super) struct PacketBoxes<V> {
    inverse: [V; 3],
    near_offset: [V; 3],
    far_offset: [V; 3],
}

impl<V: Floats<PACKET_WIDTH>> PacketBoxes<V> {
    #[inline(always)]
    pub(super) fn new(setup: &RaySetup<PACKET_WIDTH>) -> PacketBoxes<V> {
        PacketBoxes {
            inverse: load(&setup.inverse),
            near_offset: load(&setup.near_offset),
            far_offset: load(&setup.far_offset),
        }
    }

    /// The mask of rays that may enter the box of a child within their limits.
    #[inline(always)]
    pub(super) fn intersect_child(&self, node: &Node, child: usize, limits: V) -> u32 {
        let mut near = V::splat(0.0);
        let mut far = limits;
        for axis in 0..3 {
            let [lower, upper] = &node.planes[axis];
            let lower = V::splat(lower[child % WIDTH]).mul(self.inverse[axis]);
            let upper = V::splat(upper[child % WIDTH]).mul(self.inverse[axis]);
            near = lower.min(upper).sub(self.near_offset[axis]).max(near);
            far = lower.max(upper).sub(self.far_offset[axis]).min(far);
        }
        near.le(far)
    }
}

#[inline(always)]
fn load<V: Floats<PACKET_WIDTH>>([x, y, z]: &[[f32; PACKET_WIDTH]; 3]) -> [V; 3] {
    [V::load(x), V::load(y), V::load(z)]
}
