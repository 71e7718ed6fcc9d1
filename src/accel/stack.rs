//! Traversal stacks, of one ray and of a packet.
//!
//! Entries hold a child with the distance at which the ray, or the first ray of the packet, enters its box,
//! packed so that nearer children are smaller numbers: distances are not negative, so their bits order like
//! the numbers.
//!
//! Indices wrap, so no access needs a check; the builder bounds the depth of trees so that they never do.

use super::constants::{MAX_DEPTH, WIDTH};

/// A node leaves at most seven children on the stack when traversal descends one level.
const STACK_SIZE: usize = 1024;
const _: () = assert!(STACK_SIZE > 7 * MAX_DEPTH && STACK_SIZE.is_power_of_two());

#[inline(always)]
pub(super) fn pack(near: f32, child: u32) -> u64 {
    u64::from(near.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
fn unpack(entry: u64) -> (f32, u32) {
    (f32::from_bits((entry >> 32) as u32), entry as u32)
}

/// The children that one ray has still to visit.
#[derive(Debug)]
pub(super) struct Stack {
    entries: Box<[u64; STACK_SIZE]>,
    len: usize,
}

impl Default for Stack {
    fn default() -> Stack {
        Stack {
            entries: Box::new([0; STACK_SIZE]),
            len: 0,
        }
    }
}

impl Stack {
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Pushes a child, or not, without a branch.
    #[inline(always)]
    pub(super) fn push_if(&mut self, child: u32, is_pushed: bool) {
        self.entries[self.len % STACK_SIZE] = u64::from(child);
        self.len += usize::from(is_pushed);
    }

    /// Pushes the children of a mask, without their distances, but for the last, which it returns.
    #[inline(always)]
    pub(super) fn push(&mut self, children: &[u32; WIDTH], mut mask: u32) -> Option<u32> {
        if mask == 0 {
            return None;
        }
        let highest = 31 - mask.leading_zeros();
        let last = children[highest as usize % WIDTH];
        mask ^= 1 << highest;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % WIDTH;
            mask &= mask - 1;
            self.entries[self.len % STACK_SIZE] = u64::from(children[lane]);
            self.len += 1;
        }
        Some(last)
    }

    /// Pushes the children of a mask, nearest last, but for the nearest, which it returns.
    #[inline(always)]
    pub(super) fn push_sorted(
        &mut self,
        near: &[f32; WIDTH],
        children: &[u32; WIDTH],
        mut mask: u32,
    ) -> Option<u32> {
        if mask == 0 {
            return None;
        }
        let entry = |lane: usize| pack(near[lane % WIDTH], children[lane % WIDTH]);
        let mut nearest = entry(mask.trailing_zeros() as usize);
        mask &= mask - 1;
        let first = self.len;
        while mask != 0 {
            let mut other = entry(mask.trailing_zeros() as usize);
            mask &= mask - 1;
            (nearest, other) = (nearest.min(other), nearest.max(other));
            let mut place = self.len;
            while place > first && self.entries[(place - 1) % STACK_SIZE] < other {
                self.entries[place % STACK_SIZE] = self.entries[(place - 1) % STACK_SIZE];
                place -= 1;
            }
            self.entries[place % STACK_SIZE] = other;
            self.len += 1;
        }
        Some(nearest as u32)
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<(f32, u32)> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        Some(unpack(self.entries[self.len % STACK_SIZE]))
    }

    /// The next child that the ray enters no farther than `limit`.
    #[inline(always)]
    pub(super) fn pop_within(&mut self, limit: f32) -> Option<u32> {
        loop {
            let (near, child) = self.pop()?;
            if near <= limit {
                return Some(child);
            }
        }
    }
}

/// A child with the mask of the rays that enter it.
pub(super) type PacketEntry = (u64, u32);

/// The children that a packet has still to visit.
#[derive(Debug)]
pub(super) struct PacketStack {
    entries: Box<[PacketEntry; STACK_SIZE]>,
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
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Pushes the farther of two children below all entries from `first` on that are nearer; returns the nearer.
    #[inline(always)]
    pub(super) fn push_farther(
        &mut self,
        first: usize,
        nearest: PacketEntry,
        other: PacketEntry,
    ) -> PacketEntry {
        let (nearest, other) = match other.0 < nearest.0 {
            true => (other, nearest),
            false => (nearest, other),
        };
        let mut place = self.len;
        while place > first && self.entries[(place - 1) % STACK_SIZE].0 < other.0 {
            self.entries[place % STACK_SIZE] = self.entries[(place - 1) % STACK_SIZE];
            place -= 1;
        }
        self.entries[place % STACK_SIZE] = other;
        self.len += 1;
        nearest
    }

    /// The nearest distance, the child and the mask of rays.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<(f32, u32, u32)> {
        self.len = self.len.checked_sub(1)?;
        let (key, rays) = self.entries[self.len % STACK_SIZE];
        let (near, child) = unpack(key);
        Some((near, child, rays))
    }
}
