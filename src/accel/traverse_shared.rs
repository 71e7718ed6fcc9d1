//! Any hits of rays that have little in common but their target, as shadow rays from scattered points: the top of the
//! tree is tested for a whole packet, then each ray goes on alone (Benthin et al. 2012, "Combining Single and Packet-Ray
//! Tracing for Arbitrary Ray Distributions on the Intel MIC Architecture").
//!
//! Closest hits gain nothing: each ray has to visit boxes in an order of its own.

use super::bvh::Bvh;
use super::constants::WIDTH;
use super::node::{Child, ROOT};
use super::packet_boxes::PacketBoxes;
use super::packet_hits::PacketHits;
use super::packet_intersector::PacketIntersector;
use super::single_ray::SingleRay;
use super::stack::Stack;
use super::traverse_single::traverse;
use crate::simd::{Floats, SetBits, Simd};

/// Nodes that fewer rays enter are left to each.
pub(super) const MIN_RAYS: u32 = 8;

/// At most this many nodes are tested for all rays.
const MAX_NODES: usize = 8;

/// Children with the masks of the rays that enter them: of so many nodes, so that indices never wrap.
struct Entered {
    children: [(u32, u32); MAX_NODES * WIDTH],
    len: usize,
}

impl Entered {
    const NONE: Entered = Entered {
        children: [(0, 0); MAX_NODES * WIDTH],
        len: 0,
    };

    #[inline(always)]
    fn push(&mut self, child: u32, rays: u32) {
        self.children[self.len % (MAX_NODES * WIDTH)] = (child, rays);
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(u32, u32)> {
        self.len = self.len.checked_sub(1)?;
        Some(self.children[self.len % (MAX_NODES * WIDTH)])
    }
}

/// Finds some hit in the interval of each active ray.
#[inline(always)]
pub(super) fn occluded_shared<S: Simd>(
    bvh: &Bvh,
    rays: &PacketIntersector<S>,
    stack: &mut Stack,
    hits: &mut PacketHits,
) {
    let boxes = PacketBoxes::<S::F32x16>::new(rays.setup);
    let limits = S::F32x16::load(&hits.limits);
    let (mut shared, mut own) = (Entered::NONE, Entered::NONE);
    let (mut nodes, mut entering_own) = (0, 0);
    shared.push(ROOT, rays.packet.active);
    while let Some((child, active)) = shared.pop() {
        let index = match Child::unpack(child) {
            Child::Node(index) if nodes < MAX_NODES && active.count_ones() >= MIN_RAYS => index,
            _ => {
                own.push(child, active);
                entering_own |= active;
                continue;
            }
        };
        nodes += 1;
        let node = &bvh.nodes[index as usize];
        let mut occupied = node.occupied::<S::F32x8>();
        while occupied != 0 {
            let lane = occupied.trailing_zeros() as usize % WIDTH;
            occupied &= occupied - 1;
            let entering = active & boxes.intersect_child(node, lane, limits);
            if entering != 0 {
                shared.push(node.children[lane], entering);
            }
        }
    }
    for lane in SetBits(entering_own) {
        stack.clear();
        for (child, entering) in own.children.iter().take(own.len) {
            stack.push_if(*child, entering >> lane & 1 != 0);
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
