//! Traversal by a packet of sixteen rays (packets: Wald et al. 2001, "Interactive Rendering with Coherent Ray
//! Tracing").
//!
//! Coherent rays pass through mostly the same boxes: boxes that the packet as a whole misses are culled eight
//! at a time, the others are tested with one ray in each lane, and so are triangles. Each ray finds what it
//! would find alone.

use super::bvh::Bvh;
use super::node::{Child, ROOT};
use super::packet_boxes::PacketBoxes;
use super::packet_hits::PacketHits;
use super::packet_intersector::PacketIntersector;
use super::packet_interval::PacketInterval;
use super::query_state::QueryState;
use super::ray_packet::RayPacket;
use super::stack::{PacketStack, pack};
use super::traverse_interleaved::{closest_interleaved, pays as interleaving_pays};
use super::traverse_shared::{MIN_RAYS, occluded_shared};
use crate::math::Ray;
use crate::simd::{Floats, PACKET_WIDTH, Simd, WithSimd};

/// With fewer active rays at a block, one ray after the other meets all its triangles.
const MIN_RAYS_FOR_PACKET_TRIANGLES: u32 = 3;

/// How the rays of a packet are traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coherence {
    /// Together if they have one octant and one major axis.
    Coherent,
    /// Each alone where there is a tree, shadow rays from below its top on.
    Incoherent,
}

/// Finds the hits of the active rays of a packet: closest hits, or, if `ANY_HIT`, some hit in each ray's interval.
///
/// False if there is no tree and the rays do not share their major axis: then they are not traced.
pub(super) struct TraversePacket<'a, const ANY_HIT: bool> {
    pub(super) bvh: &'a Bvh,
    pub(super) packet: &'a RayPacket,
    pub(super) coherence: Coherence,
    pub(super) query_state: &'a mut QueryState,
    pub(super) hits: &'a mut PacketHits,
}

impl<const ANY_HIT: bool> WithSimd for TraversePacket<'_, ANY_HIT> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> bool {
        let TraversePacket {
            bvh,
            packet,
            coherence,
            query_state,
            hits,
        } = self;
        let setup = packet.setup::<S>(bvh.magnitude);
        let rays = PacketIntersector::<S>::new(packet, &setup);
        let is_coherent = coherence == Coherence::Coherent && setup.is_one_octant();
        if bvh.nodes.is_empty() {
            if !setup.is_one_major_axis() {
                return false;
            }
            test_all::<S, ANY_HIT>(bvh, &rays, hits);
        } else if is_coherent && setup.is_one_major_axis() {
            traverse_coherent::<S, ANY_HIT>(bvh, &rays, &mut query_state.packet_stack, hits);
        } else if ANY_HIT && packet.active.count_ones() >= MIN_RAYS {
            occluded_shared::<S>(bvh, &rays, &mut query_state.stack, hits);
        } else if !ANY_HIT && interleaving_pays(bvh, &rays) {
            closest_interleaved::<S>(bvh, &rays, &mut query_state.interleaved_stacks, hits);
        } else {
            let stack = &mut query_state.stack;
            hits.traverse_by_ray::<S, ANY_HIT>(bvh, &rays, stack);
        }
        query_state.rays += u64::from(packet.active.count_ones());
        true
    }
}

/// As [`TraversePacket`], of sixteen rays that it packs: their closest hits.
pub(super) struct ClosestOfRays<'a> {
    pub(super) bvh: &'a Bvh,
    pub(super) rays: &'a [Ray; PACKET_WIDTH],
    pub(super) coherence: Coherence,
    pub(super) query_state: &'a mut QueryState,
    pub(super) hits: &'a mut PacketHits,
}

impl WithSimd for ClosestOfRays<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> bool {
        let ClosestOfRays {
            bvh,
            rays,
            coherence,
            query_state,
            hits,
        } = self;
        TraversePacket::<false> {
            bvh,
            packet: &RayPacket::of::<S>(rays),
            coherence,
            query_state,
            hits,
        }
        .with_simd::<S>()
    }
}

/// Without a tree.
#[inline(always)]
fn test_all<S: Simd, const ANY_HIT: bool>(
    bvh: &Bvh,
    rays: &PacketIntersector<S>,
    hits: &mut PacketHits,
) {
    let active = rays.packet.active;
    for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
        hits.intersect_sphere::<S, ANY_HIT>(sphere, primitive, rays, active);
    }
    for block in &bvh.blocks {
        let triangles = (1 << block.count()) - 1;
        hits.intersect_block::<S, ANY_HIT>(block, triangles, rays, active);
    }
}

/// Rays of one octant that share their major axis.
#[inline(always)]
fn traverse_coherent<S: Simd, const ANY_HIT: bool>(
    bvh: &Bvh,
    rays: &PacketIntersector<S>,
    stack: &mut PacketStack,
    hits: &mut PacketHits,
) {
    let interval = PacketInterval::new::<S::F32x16>(rays.packet, rays.setup);
    let boxes = PacketBoxes::<S::F32x16>::new(rays.setup);
    let mut max_limit = hits.max_limit::<S>();
    stack.clear();
    let (mut next, mut active) = (ROOT, rays.packet.active);
    loop {
        match Child::unpack(next) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, far) = interval.intersect_boxes(&node.planes::<S::F32x8>(), max_limit);
                let mut entered = near.le(far);
                let near = near.store();
                let limits = S::F32x16::load(&hits.limits);
                let (first, mut nearest) = (stack.len(), None);
                while entered != 0 {
                    let lane = entered.trailing_zeros() as usize;
                    entered &= entered - 1;
                    let entering = active & boxes.intersect_child(node, lane, limits);
                    if entering != 0 {
                        let entry = (pack(near[lane], node.children[lane]), entering);
                        nearest = match nearest {
                            None => Some(entry),
                            Some(nearest) => Some(stack.push_farther(first, nearest, entry)),
                        };
                    }
                }
                if let Some((key, entering)) = nearest {
                    (next, active) = (key as u32, entering);
                    continue;
                }
            }
            Child::Triangles(index) => {
                let block = &bvh.blocks[index as usize];
                let changed = if active.count_ones() < MIN_RAYS_FOR_PACKET_TRIANGLES {
                    hits.intersect_block_by_ray::<S, ANY_HIT>(block, rays, active)
                } else {
                    let planes = block.planes::<S::F32x8>();
                    let (near, far) = interval.intersect_boxes(&planes, max_limit);
                    hits.intersect_block::<S, ANY_HIT>(block, near.le(far), rays, active)
                };
                if changed {
                    max_limit = hits.max_limit::<S>();
                }
            }
            Child::Sphere(index) => {
                let sphere = &bvh.spheres[index as usize];
                let primitive = bvh.first_sphere + index;
                hits.intersect_sphere::<S, ANY_HIT>(sphere, primitive, rays, active);
                max_limit = hits.max_limit::<S>();
            }
        }
        loop {
            let Some((near, child, entering)) = stack.pop().filter(|_| max_limit >= 0.0) else {
                return;
            };
            if near <= max_limit {
                (next, active) = (child, entering);
                break;
            }
        }
    }
}
