//! Ray queries over triangles and spheres: an 8-wide bounding volume hierarchy.
//!
//! *Build*: top down by the binned surface area heuristic (Wald 2007), each node split until it has eight
//! children; leaves hold up to eight triangles or one sphere. The smallest scenes have no tree, and all their
//! rays go in packets.
//!
//! *Traversal*: single rays against eight boxes or triangles at once, coherent rays in packets of sixteen. It is
//! written once over [`simd`](crate::simd) lanes and compiled for every instruction set; all kernels give the
//! same bits.
//!
//! *Precision*: triangles are intersected watertight (Woop et al. 2013): a ray that passes through the common
//! edge of two triangles hits at least one. Boxes are padded by the error bounds of both tests (Ize 2013), and
//! distances are in double precision. Of several primitives at the same distance the one with the lowest number
//! is hit, so a hit does not depend on the tree. Error bounds are relative to the coordinates of the ray and of
//! what it hits, not to the whole scene: a padding relative to the scene took 3.6 s a frame in place of 0.07 s
//! with a ground of 1e6 m under a model of 1 m.
//!
//! Knows rays, boxes and primitives, never materials, scenes, files or threads.
//!
//! # What limits single rays
//!
//! Not arithmetic. A diffuse ray in Sponza visits 12 nodes and 3 blocks in 1,600 instructions and 1,100 cycles
//! (Zen 5), and callgrind's model of a processor mispredicts 20 of its branches, most of them on how many boxes
//! are entered and in which order. The time is spent in equal parts on boxes, on sorting them, and on triangles
//! and their exact distances with the setup of the ray. From 10^5 triangles on the tree exceeds the caches, and
//! random rays wait for memory (`cargo bench --bench growth`).
//!
//! # Tried, and no faster
//!
//! * Boxes in a fixed order per octant, without any branch.
//! * Children pushed without a branch: a third slower, as the next box waits for the last.
//! * A sorting network in registers; prefetching; smaller leaves; distances in single precision with error
//!   bounds.
//! * 8 or 16 interleaved rays.
//! * Nodes and blocks of sixteen in AVX-512: -4 to +8 %.
//! * Packets of mixed octants.
//! * Packets of rays sorted by direction that split into single rays when few are left: diffuse rays -10 to +10 %
//!   in windows of 1,024 to 65,536 rays.
//! * Shadow rays after a bounce, sorted by direction, are 1.3 to 1.6 times as fast in windows of 1,024 to 4,096
//!   rays, but sorting, and wavefronts of that size, leave 2 % for a frame.
//! * Spatial splits: diffuse rays in Sponza 1.25 times as fast, in two other scenes no faster, for a build that
//!   takes two to ten times as long.

mod batch;
mod brute_force;
mod build;
mod closest_point;
mod node;
mod packet_hits;
mod packet_intersector;
mod packet_interval;
mod query;
mod ray_packet;
mod rounding;
mod stack;
mod traverse;
mod traverse_packet;
mod triangle_block;
mod validate;
mod watertight;

use crate::geometry::{Hit, Sphere};
use crate::math::{Aabb, Ray};
use crate::simd::Kernel;
use glam::Vec3;
use node::Node;
use stack::{PacketStack, Stack};
use traverse::Traverse;
use triangle_block::TriangleBlock;

pub use brute_force::{SAME_DISTANCE, disagreement, nearest_triangle};
pub use ray_packet::RayPacket;
pub use validate::BvhError;

/// The number of children of a node, and of triangles in a block: tested at once.
const WIDTH: usize = 8;

/// The largest depth of a leaf.
const MAX_DEPTH: usize = 79;

/// Triangles and spheres arranged for ray queries.
#[derive(Debug)]
pub struct Bvh {
    /// The root first; empty if the scene is so small that every primitive is tested.
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
    packet_stack: PacketStack,
    /// How many queries have been answered.
    pub rays: u64,
}

impl Bvh {
    /// Builds the tree over `triangles`, numbered from 0, and `spheres`, numbered after them.
    ///
    /// Coordinates are finite; there are fewer than 2^30 of either.
    pub fn new(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>, kernel: Kernel) -> Bvh {
        build::build(triangles, spheres, kernel)
    }

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

    /// The closest hit of a ray, or none. The ray's `t_max` is ignored: it only bounds [`Bvh::occluded`].
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Option<Hit> {
        self.query::<false>(ray, traversal).found()
    }

    /// Whether any primitive lies in the ray's interval.
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        !self.query::<true>(ray, traversal).is_miss()
    }

    #[inline]
    fn query<const ANY_HIT: bool>(&self, ray: &Ray, traversal: &mut Traversal) -> Hit {
        traversal.rays += 1;
        self.kernel.run(Traverse::<ANY_HIT> {
            bvh: self,
            ray,
            stack: &mut traversal.stack,
        })
    }
}

#[cfg(any(test, fuzzing))]
mod fuzz;
#[cfg(fuzzing)]
pub use fuzz::check_scene_of;
#[cfg(test)]
mod tests;
