//! Any hits of rays that have little in common: the top of the tree is tested for a whole packet, then each ray goes
//! on alone (Benthin et al. 2012, "Combining Single and Packet-Ray Tracing for Arbitrary Ray Distributions on the
//! Intel MIC Architecture").
//!
//! For shadow rays from scattered points: they share their target. Closest hits gain nothing: their rays would have
//! to visit boxes in an order of their own.

use super::bvh::Bvh;
use super::constants::WIDTH;
use super::node::{Child, ROOT};
use super::packet_boxes::PacketBoxes;
use super::packet_hits::PacketHits;
use super::packet_intersector::PacketIntersector;
use super::single_ray::SingleRay;
use super::stack::Stack;
use super::traverse_single::traverse;
use crate::simd::{Floats, PACKET_WIDTH, SetBits, Simd};

/// Nodes that fewer rays enter are left to each.
const MIN_RAYS: u32 = 8;

/// At most this many nodes are tested for all.
const MAX_NODES: usize = 8;

/// Children that rays of a mask enter.
#[derive(Clone, Copy)]
struct Subtree {
    child: u32,
    rays: u32,
}

#[inline(always)]
pub(super) fn occluded_shared<S: Simd>(
    bvh: &Bvh,
    rays: &PacketIntersector<S>,
    stack: &mut Stack,
    hits: &mut PacketHits,
) {
    let boxes = PacketBoxes::<S::F32x16>::new(rays.setup);
    let limits = S::F32x16::load(&hits.limits);
    // Each node adds at most eight, so indices never wrap.
    let mut subtrees = [Subtree { child: 0, rays: 0 }; MAX_NODES * WIDTH];
    subtrees[0] = Subtree {
        child: ROOT,
        rays: rays.packet.active,
    };
    // Those before `first` are left to each ray.
    let (mut first, mut len) = (0, 1);
    for _ in 0..MAX_NODES {
        while first < len && !is_shared(&subtrees[first % (MAX_NODES * WIDTH)]) {
            first += 1;
        }
        if first == len {
            break;
        }
        len -= 1;
        let node = subtrees[first % (MAX_NODES * WIDTH)];
        subtrees[first % (MAX_NODES * WIDTH)] = subtrees[len % (MAX_NODES * WIDTH)];
        let parent = &bvh.nodes[(node.child >> 2) as usize];
        let mut occupied = parent.occupied::<S::F32x8>();
        while occupied != 0 {
            let lane = occupied.trailing_zeros() as usize % WIDTH;
            occupied &= occupied - 1;
            let entering = node.rays & boxes.intersect_child(parent, lane, limits);
            if entering != 0 {
                subtrees[len % (MAX_NODES * WIDTH)] = Subtree {
                    child: parent.children[lane],
                    rays: entering,
                };
                len += 1;
            }
        }
    }
    let mut any = 0;
    for subtree in &subtrees[..len] {
        any |= subtree.rays;
    }
    for lane in SetBits(any) {
        stack.clear();
        for subtree in &subtrees[..len] {
            stack.push_if(subtree.child, subtree.rays >> lane & 1 != 0);
        }
        let ray = &rays.packet.ray(lane);
        let ray = SingleRay::<S>::new(ray, rays.setup, lane);
        let mut best = hits.hit(lane);
        if let Some((_, next)) = stack.pop() {
            traverse::<S, true>(bvh, &ray, next, stack, &mut best);
        }
        hits.update::<true>(lane, best);
    }
}

#[inline(always)]
fn is_shared(subtree: &Subtree) -> bool {
    matches!(Child::unpack(subtree.child), Child::Node(_)) && subtree.rays.count_ones() >= MIN_RAYS
}
