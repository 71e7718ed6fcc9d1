//! The state of a thread between ray queries.

use super::stack::{PacketStack, Stack};

/// Scratch space of ray queries, one for each thread, and the count of its rays.
#[derive(Debug, Default)]
pub struct QueryState {
    pub(super) stack: Stack,
    pub(super) packet_stack: PacketStack,
    /// None until rays take turns.
    pub(super) interleaved_stacks: Vec<Stack>,
    /// How many queries have been answered.
    pub rays: u64,
}
