//! Builds the tree in four steps, each in parallel and each the same for any number of threads:
//!
//! 1. a binary tree, top down, by the surface area heuristic over bins (Wald 2007, [`binary_tree`]);
//! 2. reinsertion of its largest nodes where they cost least (Bittner et al. 2013, [`reinsertion`]);
//! 3. the cheapest choice of its nodes for a tree of eight children (Ylitie et al. 2017, [`collapse`]);
//! 4. the nodes and blocks that rays traverse ([`emission`]).
//!
//! # Tried, and no better
//!
//! By nodes and one and a half times blocks that rays visit in Sponza, a kitchen, and it with a million triangles:
//!
//! * Leaves of 3 to 5 triangles before the collapse: -1 to +3 %, for a longer build. Leaves of 8: +11 %.
//! * 32 bins, or more bins for few references: -0.5 to +4 %.
//! * In the heuristic, blocks of four or six triangles: +4 and +7 %.
//! * Reinsertion of eight times as many nodes: -3 %, for a build that takes twice as long. Half the passes: +3 %.
//!   Reinsertion above ancestors, too: -0.6 %.
//! * Bins filled from both halves of a range in turn, so that few references in a row fall into the same: no faster.

mod binary_node;
mod binary_tree;
mod collapse;
mod emission;
mod primitive_ref;
mod reinsertion;
mod split;
#[cfg(test)]
mod tests;

use super::bvh::Bvh;
use super::constants::MAX_CACHED;
use crate::geometry::Sphere;
use crate::math::Aabb;
use crate::simd::Kernel;
use binary_tree::BinaryTree;
use collapse::Collapse;
use emission::emit;
use glam::Vec3;
use primitive_ref::PrimitiveRef;
use rayon::prelude::*;
use reinsertion::reinsert;

impl Bvh {
    /// Builds the tree over `triangles`, numbered from 0, and `spheres`, numbered after them.
    ///
    /// Coordinates are finite; there are fewer than 2^30 of either.
    pub fn new(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>, kernel: Kernel) -> Bvh {
        let first_sphere = triangles.len() as u32;
        let mut tree = BinaryTree::build(references(triangles, &spheres), first_sphere);
        reinsert(&mut tree.nodes);
        let collapse = Collapse::of(&tree);
        let (nodes, blocks) = emit(&tree, &collapse, triangles);
        let exceeds_caches = size_of_val(&*nodes) + size_of_val(&*blocks) > MAX_CACHED;
        let bounds = tree.bounds();
        Bvh {
            nodes,
            blocks,
            spheres,
            first_sphere,
            bounds,
            magnitude: bounds.max.max(-bounds.min).max_element().max(0.0),
            kernel,
            exceeds_caches,
        }
    }
}

fn references(triangles: &[[Vec3; 3]], spheres: &[Sphere]) -> Vec<PrimitiveRef> {
    let boxes = triangles.par_iter().map(|vertices| Aabb::of(*vertices));
    let numbers = 0..(triangles.len() + spheres.len()) as u32;
    boxes
        .chain(spheres.par_iter().map(Sphere::bounds))
        .zip(numbers)
        .map(|(bounds, id)| PrimitiveRef::new(bounds, id))
        .collect()
}
