use super::{MAX_DEPTH, WIDTH};

/// What is still to be visited: children with the distance at which the ray enters them, packed
/// so that nearer ones are smaller numbers.
///
/// Indices wrap, so no access needs a check; the builder bounds the depth of trees so that they
/// never do.
#[derive(Debug)]
pub(super) struct Stack {
    entries: Box<[u64; STACK_SIZE]>,
    len: usize,
}

/// A node leaves at most seven children behind when the walk goes down one level.
pub(super) const STACK_SIZE: usize = 1024;
const _: () = assert!(STACK_SIZE > 7 * MAX_DEPTH && STACK_SIZE.is_power_of_two());

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

    /// Pushes the children whose bits are set.
    #[inline(always)]
    pub(super) fn push(&mut self, children: &[u32; WIDTH], mut set: u32) {
        while set != 0 {
            let lane = set.trailing_zeros() as usize % WIDTH;
            set &= set - 1;
            self.entries[self.len % STACK_SIZE] = u64::from(children[lane]);
            self.len += 1;
        }
    }

    /// Pushes the children whose bits are set, nearest last, but for the nearest, which it returns.
    #[inline(always)]
    pub(super) fn push_sorted(
        &mut self,
        near: &[f32; WIDTH],
        children: &[u32; WIDTH],
        mut set: u32,
    ) -> Option<u32> {
        if set == 0 {
            return None;
        }
        // Distances are not negative, so their bits order like numbers.
        let entry = |lane: usize| {
            u64::from(near[lane % WIDTH].to_bits()) << 32 | u64::from(children[lane % WIDTH])
        };
        let mut nearest = entry(set.trailing_zeros() as usize);
        set &= set - 1;
        let first = self.len;
        while set != 0 {
            let mut other = entry(set.trailing_zeros() as usize);
            set &= set - 1;
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
        let entry = self.entries[self.len % STACK_SIZE];
        Some((f32::from_bits((entry >> 32) as u32), entry as u32))
    }
}
