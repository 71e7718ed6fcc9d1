//! Sizes of the tree.

/// The number of children of a node, and of triangles in a block: tested at once.
pub(super) const WIDTH: usize = 8;

/// The largest depth of a leaf.
pub(super) const MAX_DEPTH: usize = 79;

/// More bytes of nodes and blocks than a core finds in its caches.
pub(super) const MAX_CACHED: usize = 1 << 28;
