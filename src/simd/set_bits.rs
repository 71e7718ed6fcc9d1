//! Iterates over the lanes of a mask.

use super::floats::PACKET_WIDTH;

/// The indices of the set bits of a packet's lane mask, ascending.
pub(crate) struct SetBits(pub(crate) u32);

impl Iterator for SetBits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize % PACKET_WIDTH;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
