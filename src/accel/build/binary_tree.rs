//! The binary tree, built top down: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies".

use super::super::constants::MAX_DEPTH;
use super::binary_node::{BinaryNode, Content, pair_of};
use super::primitive_ref::{Extent, PrimitiveRef};
use super::split::split;
use crate::math::Aabb;
use rayon::prelude::*;

/// From this depth on ranges are split at the median index, which bounds the depth of any tree: there are
/// fewer than 2^31 references to be halved.
const MAX_SAH_DEPTH: usize = MAX_DEPTH - 31;

/// Ranges of more references are split one level at a time, all of a level in parallel; others become subtrees
/// that are built on one thread each.
const MAX_SEQUENTIAL: usize = 1 << 12;

/// The most triangles of a leaf. Fewer than fill a block: the collapse merges leaves where that is cheaper, and
/// rays visit a tenth fewer nodes and blocks than with leaves of eight.
const MAX_TRIANGLES: usize = 6;

/// References to primitives and the tree over them.
pub(super) struct BinaryTree {
    /// The root is the first; the second is not used, so that siblings are pairs. Empty if nothing is referred to.
    pub(super) nodes: Vec<BinaryNode>,
    /// Those of a leaf are consecutive.
    pub(super) references: Vec<PrimitiveRef>,
    /// The number of the first sphere: triangles are numbered before.
    pub(super) first_sphere: u32,
}

/// References that are to become a node.
struct Range<'a> {
    node: usize,
    references: &'a mut [PrimitiveRef],
    /// The number of the first reference.
    first: usize,
    extent: Extent,
    depth: usize,
}

impl BinaryTree {
    pub(super) fn build(mut references: Vec<PrimitiveRef>, first_sphere: u32) -> BinaryTree {
        let mut nodes = Vec::new();
        if !references.is_empty() {
            let root = Range {
                node: 0,
                extent: Extent::of(&references),
                references: &mut references,
                first: 0,
                depth: 0,
            };
            nodes = build(root, first_sphere);
        }
        BinaryTree {
            nodes,
            references,
            first_sphere,
        }
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, BinaryNode::bounds)
    }

    /// The two children of an inner node.
    pub(super) fn pair(&self, pair: u32) -> &[BinaryNode; 2] {
        pair_of(&self.nodes, pair)
    }

    /// The references of a leaf.
    pub(super) fn leaf(&self, first: u32) -> &[PrimitiveRef] {
        let references = &self.references[first as usize..];
        &references[..references[0].leaf_len()]
    }

    /// The sphere that a leaf is; none if it has triangles.
    pub(super) fn sphere(&self, first: u32) -> Option<u32> {
        self.references[first as usize]
            .id()
            .checked_sub(self.first_sphere)
    }
}

/// The nodes of the tree over a range.
fn build(root: Range, first_sphere: u32) -> Vec<BinaryNode> {
    let mut nodes = vec![BinaryNode::EMPTY; 2];
    let mut small = Vec::new();
    let mut ranges = vec![root];
    while !ranges.is_empty() {
        let is_large = |range: &Range| range.references.len() > MAX_SEQUENTIAL;
        let (large, others): (Vec<_>, Vec<_>) = ranges.into_iter().partition(is_large);
        small.extend(others);
        let parts: Vec<_> = large.into_par_iter().map(Range::split).collect();
        ranges = Vec::with_capacity(2 * parts.len());
        for (node, parts) in parts {
            ranges.extend(add_pair(&mut nodes, node, parts));
        }
    }
    let subtrees: Vec<_> = small
        .into_par_iter()
        .map(|range| {
            let mut subtree = vec![BinaryNode::EMPTY; 2];
            subtree.reserve(range.references.len() / 2);
            let node = range.node;
            add(Range { node: 0, ..range }, first_sphere, &mut subtree);
            (node, subtree)
        })
        .collect();
    nodes.reserve_exact(subtrees.iter().map(|(_, subtree)| subtree.len() - 2).sum());
    for (node, mut subtree) in subtrees {
        // Its first pair is the one after the root's.
        let shift = nodes.len() as u32 / 2 - 1;
        for node in &mut subtree {
            if let Content::Pair(pair) = node.content() {
                node.set_content(Content::Pair(pair + shift));
            }
        }
        nodes[node] = subtree[0];
        nodes.extend_from_slice(&subtree[2..]);
    }
    nodes
}

/// Adds a node over a range and all below it.
fn add(range: Range, first_sphere: u32, nodes: &mut Vec<BinaryNode>) {
    if is_leaf(range.references, first_sphere) {
        let (Extent { min, max, .. }, len) = (range.extent, range.references.len());
        nodes[range.node] = BinaryNode::new(min, max, Content::Leaf(range.first as u32));
        range.references[0].set_leaf_len(len);
    } else {
        let (node, parts) = range.split();
        for part in add_pair(nodes, node, parts) {
            add(part, first_sphere, nodes);
        }
    }
}

/// Makes a node the parent of places for two new ones, over `parts`.
fn add_pair<'a>(
    nodes: &mut Vec<BinaryNode>,
    node: usize,
    [left, right]: [Range<'a>; 2],
) -> [Range<'a>; 2] {
    let first = nodes.len();
    let (a, b) = (&left.extent, &right.extent);
    let (min, max) = (a.min.min(b.min), a.max.max(b.max));
    nodes[node] = BinaryNode::new(min, max, Content::Pair(first as u32 / 2));
    nodes.extend([BinaryNode::EMPTY; 2]);
    let right = Range {
        node: first + 1,
        ..right
    };
    [
        Range {
            node: first,
            ..left
        },
        right,
    ]
}

/// Whether references make a leaf: one sphere, or a few triangles.
fn is_leaf(references: &[PrimitiveRef], first_sphere: u32) -> bool {
    references.len() == 1
        || (references.len() <= MAX_TRIANGLES && references.iter().all(|r| r.id() < first_sphere))
}

impl<'a> Range<'a> {
    /// Splits two or more references; returns the node and its two parts.
    fn split(self) -> (usize, [Range<'a>; 2]) {
        let partition = split(self.references, self.extent, self.depth < MAX_SAH_DEPTH);
        let (left, right) = self.references.split_at_mut(partition.count);
        let part = |references, first, extent| Range {
            node: self.node,
            references,
            first,
            extent,
            depth: self.depth + 1,
        };
        let middle = self.first + partition.count;
        let [a, b] = partition.extents;
        (
            self.node,
            [part(left, self.first, a), part(right, middle, b)],
        )
    }
}
