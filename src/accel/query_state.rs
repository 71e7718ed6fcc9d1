//! The state of a thread between ray queries.

use super::stack::{PacketStack, Stack};

/// Scratch space of ray queries, one for each thread, and the count of its rays.
#[derive(Debug)]
pub struct QueryState {
    pub(super) stack: Stack,
    pub(super) packet_stack: PacketStack,
    pub(super) lists: [[u32; 64]; 16],
    /// How many queries have been answered.
    pub rays: u64,
}

impl Default for QueryState { fn default() -> Self { QueryState { stack: Default::default(), packet_stack: Default::default(), lists: [[0; 64]; 16], rays: 0 } } }
