//! The nodes and blocks that rays traverse, as the collapse chose them, depth first.

use super::super::constants::WIDTH;
use super::super::node::{Child, Node};
use super::super::triangle_block::TriangleBlock;
use super::binary_node::{BinaryNode, Content};
use super::binary_tree::BinaryTree;
use super::collapse::Collapse;
use crate::math::Aabb;
use glam::Vec3;
use rayon::prelude::*;
use std::cmp::Reverse;

/// At most this many blocks and this many spheres are tested one after the other, without a tree.
const MAX_WITHOUT_TREE: usize = 2;

/// Children of nodes above this depth are emitted in parallel.
const MAX_PARALLEL_DEPTH: usize = 1;

pub(super) fn emit(
    tree: &BinaryTree,
    collapse: &Collapse,
    triangles: &[[Vec3; 3]],
) -> (Vec<Node>, Vec<TriangleBlock>) {
    let mut emission = Emission::default();
    if let Some(root) = tree.nodes.first() {
        Emitter { tree, collapse }.add(root, 0, &mut emission);
    }
    let Emission { mut nodes, blocks } = emission;
    let blocks: Vec<_> = blocks
        .par_iter()
        .map(|root| block(tree, root, triangles))
        .collect();
    let spheres = tree.references.len() - triangles.len();
    if blocks.len() <= MAX_WITHOUT_TREE && spheres <= MAX_WITHOUT_TREE {
        nodes.clear();
    }
    let leaf = match blocks.is_empty() {
        true => Child::Sphere(0),
        false => Child::Triangles(0),
    };
    nodes.par_iter_mut().for_each(|node| node.fill_empty(leaf));
    (nodes, blocks)
}

#[derive(Default)]
struct Emission<'a> {
    nodes: Vec<Node>,
    /// The roots of the subtrees that become blocks.
    blocks: Vec<&'a BinaryNode>,
}

impl Emission<'_> {
    /// Appends a subtree that was emitted in parallel; returns its renumbered root.
    fn append(&mut self, mut other: Self, root: Child) -> Child {
        let (nodes, blocks) = (self.nodes.len() as u32, self.blocks.len() as u32);
        for node in &mut other.nodes {
            node.offset_children(nodes, blocks);
        }
        self.nodes.append(&mut other.nodes);
        self.blocks.append(&mut other.blocks);
        root.with_offset(nodes, blocks)
    }
}

struct Emitter<'a> {
    tree: &'a BinaryTree,
    collapse: &'a Collapse,
}

impl<'a> Emitter<'a> {
    /// Adds a subtree as one root.
    fn add(&self, root: &'a BinaryNode, depth: usize, emission: &mut Emission<'a>) -> Child {
        match root.content() {
            Content::Pair(pair) if !self.collapse.is_block(pair) => {
                return self.add_node(root, depth, emission);
            }
            Content::Leaf(first) => {
                if let Some(sphere) = self.tree.sphere(first) {
                    return Child::Sphere(sphere);
                }
            }
            Content::Pair(_) => {}
        }
        emission.blocks.push(root);
        Child::Triangles(emission.blocks.len() as u32 - 1)
    }

    fn add_node(&self, root: &'a BinaryNode, depth: usize, emission: &mut Emission<'a>) -> Child {
        let index = emission.nodes.len();
        emission.nodes.push(Node::new(&[]));
        let mut roots = Vec::with_capacity(WIDTH);
        self.collect(root, WIDTH, &mut roots);
        let children: Vec<Child> = if depth < MAX_PARALLEL_DEPTH {
            let emit = |root: &&'a BinaryNode| {
                let mut emission = Emission::default();
                (self.add(root, depth + 1, &mut emission), emission)
            };
            let parts: Vec<_> = roots.par_iter().map(emit).collect();
            let append = |(child, part)| emission.append(part, child);
            parts.into_iter().map(append).collect()
        } else {
            let add = |root: &&'a BinaryNode| self.add(root, depth + 1, emission);
            roots.iter().map(add).collect()
        };
        let mut children: Vec<_> = roots.into_iter().zip(children).collect();
        // Shadow rays visit the children that they enter from the last to the first: leaves, where they may end
        // at once, then small nodes, where there is less to walk through.
        children.sort_by_key(|(root, child)| {
            let is_leaf = !matches!(child, Child::Node(_));
            (is_leaf, Reverse(root.half_area().to_bits()))
        });
        let bounds = |(root, child): (&BinaryNode, Child)| (root.bounds(), child);
        let children: Vec<(Aabb, Child)> = children.into_iter().map(bounds).collect();
        emission.nodes[index] = Node::new(&children);
        Child::Node(index as u32)
    }

    /// Collects the roots of a subtree that becomes a forest of at most so many.
    fn collect(&self, node: &'a BinaryNode, roots: usize, collected: &mut Vec<&'a BinaryNode>) {
        if let Content::Pair(pair) = node.content()
            && let Some(division) = self.collapse.division(pair, roots)
        {
            for (child, roots) in self.tree.pair(pair).iter().zip(division) {
                self.collect(child, roots, collected);
            }
        } else {
            collected.push(node);
        }
    }
}

/// The block of the triangles of a subtree.
fn block(tree: &BinaryTree, root: &BinaryNode, triangles: &[[Vec3; 3]]) -> TriangleBlock {
    let (mut ids, mut len) = ([u32::MAX; WIDTH], 0);
    add_ids(tree, root, &mut ids, &mut len);
    // Each goes where its rank says: any other sorting has branches that are mispredicted.
    let mut sorted = [0; WIDTH];
    for id in &ids[..len] {
        sorted[ids.iter().filter(|other| *other < id).count()] = *id;
    }
    TriangleBlock::new(&sorted[..len], triangles)
}

fn add_ids(tree: &BinaryTree, node: &BinaryNode, ids: &mut [u32; WIDTH], len: &mut usize) {
    match node.content() {
        Content::Leaf(first) => {
            for reference in tree.leaf(first) {
                ids[*len] = reference.id();
                *len += 1;
            }
        }
        Content::Pair(pair) => {
            for child in tree.pair(pair) {
                add_ids(tree, child, ids, len);
            }
        }
    }
}
