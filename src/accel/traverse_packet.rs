//! Traversal by a packet of sixteen rays (packets: Wald et al. 2001, "Interactive Rendering with Coherent Ray
//! Tracing").
//!
//! Coherent rays pass through mostly the same boxes: boxes that the packet as a whole misses are culled eight
//! at a time, the others are tested with one ray in each lane, and so are triangles. Each ray finds what it
//! would find alone.

use super::bvh::Bvh;
use super::node::{Child, ROOT};
use super::packet_hits::PacketHits;
use super::packet_intersector::PacketIntersector;
use super::packet_interval::PacketInterval;
use super::ray_packet::RayPacket;
use super::single_ray::SingleRay;
use super::stack::{PacketStack, Stack};
use super::traverse_single::traverse;
use crate::geometry::Hit;
use crate::simd::{Floats, PACKET_WIDTH, Simd, WithSimd};

/// With fewer active rays at a block, one ray after the other meets all its triangles.
const MIN_RAYS_FOR_PACKET_TRIANGLES: u32 = 3;

/// The hits of the active rays of a packet, [`Hit::MISS`] for none: closest hits, or, if `ANY_HIT`, some hit
/// in each ray's interval.
///
/// None if the rays do not share their major axis or, if there is a tree, their octant.
pub(super) struct TraversePacket<'a, const ANY_HIT: bool> {
    pub(super) bvh: &'a Bvh,
    pub(super) packet: &'a RayPacket,
    pub(super) stack: &'a mut PacketStack,
    pub(super) single_stack: &'a mut Stack,
}

impl<const ANY_HIT: bool> WithSimd for TraversePacket<'_, ANY_HIT> {
    type Output = Option<[Hit; PACKET_WIDTH]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Option<[Hit; PACKET_WIDTH]> {
        let TraversePacket { bvh, packet, stack, single_stack } = self;
        let setup = packet.setup::<S>(bvh.magnitude);
        if !bvh.nodes.is_empty() && !(setup.is_one_octant() && setup.is_one_major_axis()) {
            let mut best = [Hit::MISS; PACKET_WIDTH];
            for lane in packet.active_lanes() {
                let ray = packet.ray(lane);
                let ray = SingleRay::<S>::new(&ray, &setup, lane);
                traverse::<S, ANY_HIT>(bvh, &ray, ROOT, single_stack, &mut best[lane]);
            }
            return Some(best);
        }
        if !setup.is_one_major_axis() {
            return None;
        }
        let rays = PacketIntersector::<S>::new(packet, &setup);
        let mut hits = PacketHits::new::<ANY_HIT>(packet);
        if bvh.nodes.is_empty() {
            for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
                hits.intersect_sphere::<S, ANY_HIT>(sphere, primitive, &rays, packet.active);
            }
            for block in &bvh.blocks {
                let triangles = (1 << block.count()) - 1;
                hits.intersect_block::<S, ANY_HIT>(block, triangles, &rays, packet.active);
            }
            return Some(hits.best);
        }
        let interval = PacketInterval::<S::F32x16>::new(packet, &setup);
        let mut max_limit = hits.max_limit::<S>();
        stack.clear();
        let (mut next, mut active) = (ROOT, packet.active);
        loop {
            match Child::unpack(next) {
                Child::Node(index) => {
                    let node = &bvh.nodes[index as usize];
                    let (near, far) =
                        interval.intersect_boxes(&node.planes::<S::F32x8>(), max_limit);
                    let mut entered = near.le(far);
                    let near = near.store();
                    let limits = S::F32x16::load(&hits.limits);
                    let first = stack.len();
                    while entered != 0 {
                        let lane = entered.trailing_zeros() as usize;
                        entered &= entered - 1;
                        let entering = active & interval.intersect_child(node, lane, limits);
                        if entering != 0 {
                            stack.insert(first, near[lane], node.children[lane], entering);
                        }
                    }
                }
                Child::Triangles(index) => {
                    let block = &bvh.blocks[index as usize];
                    let changed = if active.count_ones() < MIN_RAYS_FOR_PACKET_TRIANGLES {
                        hits.intersect_block_by_ray::<S, ANY_HIT>(block, &rays, active)
                    } else {
                        let planes = block.planes::<S::F32x8>();
                        let (near, far) = interval.intersect_boxes(&planes, max_limit);
                        hits.intersect_block::<S, ANY_HIT>(block, near.le(far), &rays, active)
                    };
                    if changed {
                        max_limit = hits.max_limit::<S>();
                    }
                }
                Child::Sphere(index) => {
                    let sphere = &bvh.spheres[index as usize];
                    let primitive = bvh.first_sphere + index;
                    hits.intersect_sphere::<S, ANY_HIT>(sphere, primitive, &rays, active);
                    max_limit = hits.max_limit::<S>();
                }
            }
            loop {
                let Some((near, child, entering)) = stack.pop().filter(|_| max_limit >= 0.0) else {
                    return Some(hits.best);
                };
                if near <= max_limit {
                    (next, active) = (child, entering);
                    break;
                }
            }
        }
    }
}
