//! Checks of a tree's invariants.

use super::bvh::Bvh;
use super::constants::{MAX_DEPTH, WIDTH};
use super::node::{Child, ROOT};
use super::rounding::padded;
use crate::math::Aabb;
use glam::Vec3;
use thiserror::Error;

/// A violated invariant of a tree.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum BvhError {
    /// A child points at something that does not exist.
    #[error("child {lane} of node {node} does not exist")]
    Dangling {
        /// The node's index.
        node: usize,
        /// The child's lane.
        lane: usize,
    },
    /// A child holds something that its box does not.
    #[error("the box of child {lane} of node {node} is too small for what is in it")]
    Outside {
        /// The node's index.
        node: usize,
        /// The child's lane.
        lane: usize,
    },
    /// Deeper than the traversal stacks allow.
    #[error("node {node} lies too deep")]
    TooDeep {
        /// The node's index.
        node: usize,
    },
    /// A primitive cannot be reached, or in more than one way.
    #[error("primitive {primitive} is in {leaves} leaves")]
    Primitive {
        /// The primitive's number.
        primitive: usize,
        /// How many leaves hold it.
        leaves: usize,
    },
}

impl Bvh {
    /// Checks what traversal relies on: every box holds all that is below it, every primitive is in
    /// exactly one leaf, and no leaf lies too deep.
    ///
    /// # Errors
    ///
    /// The first violation that is found.
    pub fn validate(&self) -> Result<(), BvhError> {
        let mut leaves = vec![0; self.first_sphere as usize + self.spheres.len()];
        if self.nodes.is_empty() {
            for block in 0..self.blocks.len() {
                self.count_block(block, &mut leaves);
            }
            for sphere in 0..self.spheres.len() {
                leaves[self.first_sphere as usize + sphere] += 1;
            }
        } else {
            self.validate_node(ROOT as usize, 0, &mut leaves)?;
        }
        match leaves.iter().position(|count| *count != 1) {
            Some(primitive) => Err(BvhError::Primitive {
                primitive,
                leaves: leaves[primitive],
            }),
            None => Ok(()),
        }
    }

    /// Counts the leaves of each primitive below a node; returns the box around them.
    fn validate_node(
        &self,
        node: usize,
        depth: usize,
        leaves: &mut [usize],
    ) -> Result<Aabb, BvhError> {
        if depth > MAX_DEPTH {
            return Err(BvhError::TooDeep { node });
        }
        let mut all = Aabb::EMPTY;
        for lane in 0..WIDTH {
            let bounds = self.nodes[node].bounds(lane);
            if bounds == Aabb::EMPTY {
                continue;
            }
            let dangling = BvhError::Dangling { node, lane };
            let inside = match Child::unpack(self.nodes[node].children[lane]) {
                Child::Node(index) if index == ROOT => return Err(dangling),
                Child::Node(index) if (index as usize) < self.nodes.len() => {
                    self.validate_node(index as usize, depth + 1, leaves)?
                }
                Child::Triangles(index) if (index as usize) < self.blocks.len() => {
                    padded(self.count_block(index as usize, leaves))
                }
                Child::Sphere(index) if (index as usize) < self.spheres.len() => {
                    leaves[self.first_sphere as usize + index as usize] += 1;
                    padded(self.spheres[index as usize].bounds())
                }
                _ => return Err(dangling),
            };
            if inside.union(bounds) != bounds {
                return Err(BvhError::Outside { node, lane });
            }
            all = all.union(bounds);
        }
        Ok(all)
    }

    /// Counts the triangles of a block; returns the box around them.
    fn count_block(&self, index: usize, leaves: &mut [usize]) -> Aabb {
        let block = &self.blocks[index];
        let mut vertices: Vec<Vec3> = Vec::new();
        for lane in 0..block.count() {
            leaves[block.ids()[lane] as usize] += 1;
            vertices.extend(block.triangle(lane));
        }
        Aabb::of(vertices)
    }
}
