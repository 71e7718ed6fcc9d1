//! Sixteen rays through the tree together.
//!
//! Rays side by side pass through mostly the same boxes: those that the bundle as a whole misses are
//! left out eight at a time, the others are tested with one ray in each lane, and so are triangles.
//! Each ray finds what it would find alone.

use super::bundle::Bundle;
use super::found::Found;
use super::lanes::{Packet, RayLanes};
use super::node::{Child, ROOT};
use super::simd::{Floats, Machine};
use super::stack::STACK_SIZE;
use super::{Bvh, PACKET};
use crate::geometry::Hit;

/// With fewer rays in a block, one ray after the other meets all its triangles.
const FEW: u32 = 3;

/// What is still to be visited: a child, with a distance before which no ray enters it, and a bit for
/// each ray that does.
#[derive(Debug)]
pub(super) struct PacketStack {
    entries: Box<[(u64, u32); STACK_SIZE]>,
    len: usize,
}

impl Default for PacketStack {
    fn default() -> PacketStack {
        PacketStack {
            entries: Box::new([(0, 0); STACK_SIZE]),
            len: 0,
        }
    }
}

impl PacketStack {
    /// Pushes a child below all those after `first` that are nearer.
    #[inline(always)]
    fn insert(&mut self, first: usize, near: f32, child: u32, rays: u32) {
        // Distances are not negative, so their bits order like numbers.
        let key = u64::from(near.to_bits()) << 32 | u64::from(child);
        let mut place = self.len;
        while place > first && self.entries[(place - 1) % STACK_SIZE].0 < key {
            self.entries[place % STACK_SIZE] = self.entries[(place - 1) % STACK_SIZE];
            place -= 1;
        }
        self.entries[place % STACK_SIZE] = (key, rays);
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(f32, u32, u32)> {
        self.len = self.len.checked_sub(1)?;
        let (key, rays) = self.entries[self.len % STACK_SIZE];
        Some((f32::from_bits((key >> 32) as u32), key as u32, rays))
    }
}

/// The answers for up to sixteen rays: [`NOTHING`](super::NOTHING) for none; if `ANY`, anything else if something
/// lies in the ray's interval. None if the rays do not all run along the same main axis or, if there is a
/// tree, into the same octant.
#[inline(always)]
pub(super) fn walk_packet<M: Machine, const ANY: bool>(
    bvh: &Bvh,
    packet: &Packet,
    stack: &mut PacketStack,
) -> Option<[Hit; PACKET]> {
    let lanes = RayLanes::<M::Many>::new(packet, bvh.magnitude)?;
    let mut found = Found::new::<ANY>(packet);
    let all = packet.used;
    if bvh.nodes.is_empty() {
        for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
            found.meet_sphere::<M, ANY>(sphere, primitive, &lanes, all);
        }
        for block in &bvh.blocks {
            let triangles = (1 << block.count()) - 1;
            found.meet_together::<M, ANY>(block, triangles, &lanes, all);
        }
        return Some(found.best);
    }
    let bundle = Bundle::new(&lanes)?;
    let mut farthest = found.farthest::<M>();
    stack.len = 0;
    let (mut next, mut some) = (ROOT, all);
    loop {
        match Child::unpack(next) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, far) = bundle.enter_bundle(&node.planes::<M::One>(), farthest);
                let mut entered = near.le(far);
                let near = near.store();
                let limits = M::Many::load(&found.limits);
                let first = stack.len;
                while entered != 0 {
                    let lane = entered.trailing_zeros() as usize;
                    entered &= entered - 1;
                    let those = some & bundle.enter(node, lane, limits);
                    if those != 0 {
                        stack.insert(first, near[lane], node.children[lane], those);
                    }
                }
            }
            Child::Triangles(index) => {
                let block = &bvh.blocks[index as usize];
                let changed = if some.count_ones() < FEW {
                    found.meet_one_by_one::<M, ANY>(block, &lanes, some)
                } else {
                    let planes = block.planes::<M::One>();
                    let (near, far) = bundle.enter_bundle(&planes, farthest);
                    found.meet_together::<M, ANY>(block, near.le(far), &lanes, some)
                };
                if changed {
                    farthest = found.farthest::<M>();
                }
            }
            Child::Sphere(index) => {
                let sphere = &bvh.spheres[index as usize];
                let primitive = bvh.first_sphere + index;
                found.meet_sphere::<M, ANY>(sphere, primitive, &lanes, some);
                farthest = found.farthest::<M>();
            }
        }
        loop {
            let Some((near, child, those)) = stack.pop().filter(|_| farthest >= 0.0) else {
                return Some(found.best);
            };
            if near <= farthest {
                (next, some) = (child, those);
                break;
            }
        }
    }
}
