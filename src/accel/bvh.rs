//! The tree and its primitives.

use super::node::Node;
use super::triangle_block::TriangleBlock;
use crate::geometry::Sphere;
use crate::math::Aabb;
use crate::simd::Kernel;

/// Triangles and spheres arranged for ray queries.
#[derive(Debug)]
pub struct Bvh {
    /// The root first; empty if the scene is so small that every primitive is tested.
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<TriangleBlock>,
    pub(super) spheres: Vec<Sphere>,
    /// The number of the first sphere: triangles are numbered before.
    pub(super) first_sphere: u32,
    pub(super) bounds: Aabb,
    /// The largest absolute coordinate.
    pub(super) magnitude: f32,
    pub(super) kernel: Kernel,
    /// Whether random rays mostly find a node in memory, not in a cache.
    pub(super) exceeds_caches: bool,
}

impl Bvh {
    /// The box around all primitives.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The instruction set of its queries.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Whether the scene is large enough for a tree.
    #[cfg(test)]
    pub(crate) fn has_tree(&self) -> bool {
        !self.nodes.is_empty()
    }

    /// Bytes of the tree and its primitives.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + size_of_val(&*self.spheres)
    }
}
