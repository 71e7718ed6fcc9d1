//! Builds the tree top down by the surface area heuristic over bins (Wald 2007, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies"): the child with the largest surface is split in two until a node has eight.

mod primitive_ref;
mod split;

use super::bvh::Bvh;
use super::constants::{MAX_DEPTH, WIDTH};
use super::node::{Child, Node};
use super::triangle_block::TriangleBlock;
use crate::geometry::Sphere;
use crate::math::Aabb;
use crate::simd::Kernel;
use glam::Vec3;
use primitive_ref::{Extent, PrimitiveRef};
use rayon::prelude::*;
use split::split;

/// From this depth on ranges are split at the median index, which bounds the depth of any tree: there are
/// fewer than 2^31 references to be halved.
const MAX_SAH_DEPTH: usize = MAX_DEPTH - 31;

/// The children of a node with more references are built in parallel.
const MIN_PARALLEL_REFERENCES: usize = 1 << 16;

/// At most this many blocks and this many spheres are tested one after the other, without a tree.
const MAX_WITHOUT_TREE: usize = 2;

impl Bvh {
    /// Builds the tree over `triangles`, numbered from 0, and `spheres`, numbered after them.
    ///
    /// Coordinates are finite; there are fewer than 2^30 of either.
    pub fn new(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>, kernel: Kernel) -> Bvh {
        build(triangles, spheres, kernel)
    }
}

fn build(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>, kernel: Kernel) -> Bvh {
    let first_sphere = triangles.len() as u32;
    let boxes = triangles.par_iter().map(|vertices| Aabb::of(*vertices));
    let mut references: Vec<PrimitiveRef> = boxes
        .chain(spheres.par_iter().map(Sphere::bounds))
        .zip(0..first_sphere + spheres.len() as u32)
        .map(|(bounds, id)| PrimitiveRef::new(bounds, id))
        .collect();
    let extent = Extent::of(&references);
    let bounds = extent.bounds();
    let mut tree = Tree::with_capacity(references.len());
    let builder = Builder {
        triangles,
        first_sphere,
    };
    let root = Range {
        begin: 0,
        end: references.len(),
        depth: 0,
        extent,
    };
    builder.add_node(&mut references, root, &mut tree);
    if tree.blocks.len() <= MAX_WITHOUT_TREE && spheres.len() <= MAX_WITHOUT_TREE {
        tree.nodes.clear();
    }
    let leaf = match tree.blocks.is_empty() {
        true => Child::Sphere(0),
        false => Child::Triangles(0),
    };
    for node in &mut tree.nodes {
        node.fill_empty(leaf);
    }
    Bvh {
        nodes: tree.nodes,
        blocks: tree.blocks,
        spheres,
        first_sphere,
        bounds,
        magnitude: bounds.max.max(-bounds.min).max_element().max(0.0),
        kernel,
    }
}

/// A range of references in a slice, with its bounds.
#[derive(Clone, Copy)]
struct Range {
    begin: usize,
    end: usize,
    depth: usize,
    extent: Extent,
}

struct Tree {
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
}

impl Tree {
    /// Blocks are mostly more than half full and nodes more than that, so vectors of this capacity rarely grow;
    /// what is not used is not touched.
    fn with_capacity(references: usize) -> Tree {
        Tree {
            nodes: Vec::with_capacity(references / 16),
            blocks: Vec::with_capacity(references / 4),
        }
    }

    /// Appends a subtree that was built in parallel.
    fn append(&mut self, other: Tree) {
        let (nodes, blocks) = (self.nodes.len() as u32, self.blocks.len() as u32);
        self.blocks.extend(other.blocks);
        self.nodes.extend(other.nodes.into_iter().map(|mut node| {
            node.offset_children(nodes, blocks);
            node
        }));
    }
}

struct Builder<'a> {
    triangles: &'a [[Vec3; 3]],
    first_sphere: u32,
}

impl Builder<'_> {
    /// Adds a node over `range` of `references` and all below it; returns the node's index.
    fn add_node(&self, references: &mut [PrimitiveRef], range: Range, tree: &mut Tree) -> u32 {
        let index = tree.nodes.len();
        tree.nodes.push(Node::new(&[]));
        let ranges = self.children(references, range);
        let mut children = Vec::with_capacity(WIDTH);
        if range.end - range.begin > MIN_PARALLEL_REFERENCES {
            let mut rest = references;
            let mut parts = Vec::with_capacity(WIDTH);
            for child in ranges {
                let (part, others) = rest.split_at_mut(child.end - child.begin);
                rest = others;
                parts.push((part, child));
            }
            let subtrees: Vec<_> = parts
                .into_par_iter()
                .map(|(part, child)| {
                    let mut subtree = Tree::with_capacity(part.len());
                    let own = Range {
                        begin: 0,
                        end: part.len(),
                        ..child
                    };
                    (self.add_child(part, own, &mut subtree), subtree)
                })
                .collect();
            for (mut child, subtree) in subtrees {
                let (nodes, blocks) = (tree.nodes.len() as u32, tree.blocks.len() as u32);
                child.1 = child.1.with_offset(nodes, blocks);
                children.push(child);
                tree.append(subtree);
            }
        } else {
            for child in ranges {
                children.push(self.add_child(references, child, tree));
            }
        }
        tree.nodes[index] = Node::new(&children);
        index as u32
    }

    fn add_child(
        &self,
        references: &mut [PrimitiveRef],
        range: Range,
        tree: &mut Tree,
    ) -> (Aabb, Child) {
        let own = &references[range.begin..range.end];
        let child = if !self.is_leaf(own) {
            Child::Node(self.add_node(references, range, tree))
        } else if own[0].id() >= self.first_sphere {
            Child::Sphere(own[0].id() - self.first_sphere)
        } else {
            let mut ids = [u32::MAX; WIDTH];
            for (id, reference) in ids.iter_mut().zip(own) {
                *id = reference.id();
            }
            ids.sort_unstable();
            let block = TriangleBlock::new(&ids[..own.len()], self.triangles);
            tree.blocks.push(block);
            Child::Triangles(tree.blocks.len() as u32 - 1)
        };
        (range.extent.bounds(), child)
    }

    /// Up to eight parts of a range, in order: the part with the largest surface is split until there are
    /// eight.
    fn children(&self, references: &mut [PrimitiveRef], range: Range) -> Vec<Range> {
        let mut parts = Vec::with_capacity(WIDTH);
        if range.begin < range.end {
            parts.push(range);
        }
        while parts.len() < WIDTH {
            let largest = (0..parts.len())
                .filter(|&i| !self.is_leaf(&references[parts[i].begin..parts[i].end]))
                .max_by(|&a, &b| {
                    let area = |i: usize| parts[i].extent.half_area();
                    area(a).total_cmp(&area(b))
                });
            let Some(i) = largest else { break };
            let part = parts[i];
            let own = &mut references[part.begin..part.end];
            let partition = split(own, part.extent, part.depth < MAX_SAH_DEPTH);
            let middle = part.begin + partition.count;
            let [left, right] = partition.extents;
            parts[i] = Range {
                end: middle,
                depth: part.depth + 1,
                extent: left,
                ..part
            };
            let right = Range {
                begin: middle,
                depth: part.depth + 1,
                extent: right,
                ..part
            };
            parts.insert(i + 1, right);
        }
        parts
    }

    /// Whether references make a leaf: one sphere, or one to eight triangles.
    fn is_leaf(&self, references: &[PrimitiveRef]) -> bool {
        references.len() == 1
            || (references.len() <= WIDTH && references.iter().all(|r| r.id() < self.first_sphere))
    }
}
