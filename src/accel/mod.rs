//! Which primitive does a ray meet first, and is anything in its way: an 8-wide bounding volume
//! hierarchy over triangles and spheres.
//!
//! Triangles are tested with the watertight method, boxes are padded by its error bound: a ray
//! that passes through the common edge of two triangles hits at least one. Of several primitives
//! at the same distance the one with the lowest number is hit, so the answer does not depend on
//! the tree. All kernels give the same bits.
//!
//! Knows shapes and boxes, never materials, files or threads.

mod batch;
mod build;
mod bundle;
mod found;
mod kernel;
mod lanes;
mod nearest;
mod node;
mod oracle;
mod packet;
mod rounding;
mod sight;
mod simd;
mod stack;
mod triangle_block;
mod validate;
mod walk;
mod watertight;

use crate::geometry::{Hit, Sphere};
use crate::math::{Aabb, NO_PRIMITIVE, Ray};
use glam::Vec3;
use node::Node;
use stack::Stack;
use triangle_block::TriangleBlock;

pub use kernel::Kernel;
pub use oracle::{SAME_DISTANCE, disagreement, nearest_triangle};
pub use sight::{Point, Points, Sight};
pub use validate::TreeFault;

/// Eight children, or eight triangles, are tested at once.
const WIDTH: usize = 8;

/// How many rays go through the tree together.
pub const PACKET: usize = 16;

/// No leaf lies deeper in a tree.
const MAX_DEPTH: usize = 79;

/// Triangles and spheres arranged for ray queries.
#[derive(Debug)]
pub struct Bvh {
    /// The root first; none if the scene is so small that everything in it is tested.
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
    spheres: Vec<Sphere>,
    /// The number of the first sphere: triangles are numbered before.
    first_sphere: u32,
    bounds: Aabb,
    /// The largest absolute coordinate.
    magnitude: f32,
    kernel: Kernel,
}

/// Scratch space of ray queries, one for each thread, and the count of its rays.
#[derive(Debug, Default)]
pub struct Traversal {
    stack: Stack,
    packet_stack: packet::PacketStack,
    /// How many queries have been answered.
    pub rays: u64,
}

impl Bvh {
    /// Arranges `triangles`, numbered from 0, and `spheres`, numbered after them.
    ///
    /// Coordinates are finite; there are fewer than 2^30 of either.
    pub fn new(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>, kernel: Kernel) -> Bvh {
        build::build(triangles, spheres, kernel)
    }

    /// The box around everything.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Bytes of the tree and what hangs in it.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + size_of_val(&*self.spheres)
    }

    /// The nearest primitive that the ray meets, or none. It looks all the way: `t_max` only bounds
    /// [`Bvh::occluded`].
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Option<Hit> {
        traversal.rays += 1;
        kernel::closest(self, ray, &mut traversal.stack)
    }

    /// Whether anything lies in the ray's interval.
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        traversal.rays += 1;
        kernel::occluded(self, ray, &mut traversal.stack)
    }
}

/// Farther than any hit.
const NOTHING: Hit = Hit {
    t: f32::MAX as f64,
    primitive: NO_PRIMITIVE,
};

#[cfg(any(test, fuzzing))]
mod fuzz;
#[cfg(fuzzing)]
pub use fuzz::check_scene_of;
#[cfg(test)]
mod tests;
