//! Which nodes of the binary tree become nodes and blocks: the choice of the least cost by the surface area
//! heuristic, by dynamic programming (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs").
//!
//! A subtree is turned into a forest of at most so many trees, whose roots will be children of one node: either
//! of one tree, or of what its left and right child are turned into. One tree is a node over a forest of eight, or
//! a block. A block costs as much as a node: ratios from 0.7 to 1.5 give the same visits within 0.1 %.

use super::super::constants::WIDTH;
use super::binary_node::{BinaryNode, Content};
use super::binary_tree::BinaryTree;
use std::sync::atomic::{AtomicU32, Ordering};

/// Subtrees up to this depth are worked on in parallel.
const MAX_PARALLEL_DEPTH: usize = 8;

/// The choice for every inner node.
pub(super) struct Collapse {
    /// For each pair and number of roots from 1 to 8 four bits: how many of the roots the left child gets, or 0 for
    /// a single root. In the place of one root: whether it is a block.
    choices: Vec<AtomicU32>,
}

/// What a subtree costs as a forest of at most 1 to 7 roots, and its triangles; more than eight if it has spheres.
struct Forest {
    costs: [f32; WIDTH - 1],
    triangles: usize,
}

impl Collapse {
    pub(super) fn of(tree: &BinaryTree) -> Collapse {
        let pairs = tree.nodes.len() / 2;
        let collapse = Collapse {
            choices: (0..pairs).map(|_| AtomicU32::new(0)).collect(),
        };
        if let Some(root) = tree.nodes.first() {
            collapse.choose(tree, root, 0);
        }
        collapse
    }

    /// Whether a pair becomes one block where it becomes one root.
    pub(super) fn is_block(&self, pair: u32) -> bool {
        self.choice(pair, 1) != 0
    }

    /// How many of at most `roots` roots the left of a pair gets and how many the right; none if the whole is one.
    pub(super) fn division(&self, pair: u32, roots: usize) -> Option<[usize; 2]> {
        let left = self.choice(pair, roots);
        (roots > 1 && left > 0).then(|| [left, roots - left])
    }

    fn choice(&self, pair: u32, roots: usize) -> usize {
        let choices = self.choices[pair as usize].load(Ordering::Relaxed);
        (choices >> shift(roots)) as usize & 15
    }

    /// Chooses for a node and all below it.
    fn choose(&self, tree: &BinaryTree, node: &BinaryNode, depth: usize) -> Forest {
        let pair = match node.content() {
            Content::Leaf(first) => return Forest::of_leaf(tree, node, first),
            Content::Pair(pair) => pair,
        };
        let [left, right] = tree.pair(pair);
        let (left, right) = if depth < MAX_PARALLEL_DEPTH {
            rayon::join(
                || self.choose(tree, left, depth + 1),
                || self.choose(tree, right, depth + 1),
            )
        } else {
            let left = self.choose(tree, left, depth + 1);
            (left, self.choose(tree, right, depth + 1))
        };
        let (forest, choices) = Forest::join(&left, &right, node.half_area());
        self.choices[pair as usize].store(choices, Ordering::Relaxed);
        forest
    }
}

impl Forest {
    fn of_leaf(tree: &BinaryTree, node: &BinaryNode, first: u32) -> Forest {
        Forest {
            costs: [node.half_area(); WIDTH - 1],
            triangles: match tree.sphere(first) {
                Some(_) => WIDTH + 1,
                None => tree.leaf(first).len(),
            },
        }
    }

    /// The forest of a node of this area over two forests, and the packed choices that make it.
    fn join(left: &Forest, right: &Forest, area: f32) -> (Forest, u32) {
        let mut choices = 0;
        let mut costs = [f32::MAX; WIDTH + 1];
        for (roots, cost) in costs.iter_mut().enumerate().skip(2) {
            let mut best = 1;
            for count in 1..roots {
                let other = left.costs[count - 1] + right.costs[roots - count - 1];
                if other < *cost {
                    (best, *cost) = (count, other);
                }
            }
            choices |= (best as u32) << shift(roots);
        }
        let triangles = left.triangles + right.triangles;
        costs[1] = area;
        if triangles <= WIDTH {
            choices |= 1 << shift(1);
        } else {
            costs[1] += costs[WIDTH];
        }
        for roots in 2..WIDTH {
            if costs[1] <= costs[roots] {
                costs[roots] = costs[1];
                choices &= !(15 << shift(roots));
            }
        }
        let forest = Forest {
            costs: std::array::from_fn(|i| costs[i + 1]),
            triangles,
        };
        (forest, choices)
    }
}

/// Where the choice for so many roots is packed.
fn shift(roots: usize) -> usize {
    4 * (roots - 1)
}
