use super::MAX_DEPTH;

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
const STACK_SIZE: usize = 1024;
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

    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub(super) fn push(&mut self, near: f32, child: u32) {
        // Distances are not negative, so their bits order like numbers.
        let entry = u64::from(near.to_bits()) << 32 | u64::from(child);
        self.entries[self.len % STACK_SIZE] = entry;
        self.len += 1;
    }

    /// Pushes a child below all those after `first` that are nearer.
    #[inline(always)]
    pub(super) fn insert(&mut self, first: usize, near: f32, child: u32) {
        let entry = u64::from(near.to_bits()) << 32 | u64::from(child);
        let mut place = self.len;
        while place > first && self.entries[(place - 1) % STACK_SIZE] < entry {
            self.entries[place % STACK_SIZE] = self.entries[(place - 1) % STACK_SIZE];
            place -= 1;
        }
        self.entries[place % STACK_SIZE] = entry;
        self.len += 1;
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
