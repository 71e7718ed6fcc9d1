//! Moves the largest nodes to where they cost least: Bittner, Hapala and Havran 2013, "Fast Insertion-Based
//! Optimization of Bounding Volume Hierarchies"; searches in parallel as Meister and Bittner 2018, "Parallel
//! Reinsertion for Bounding Volume Hierarchy Optimization".

use super::super::constants::MAX_DEPTH;
use super::binary_node::{BinaryNode, Content, pair_of};
use rayon::prelude::*;
use std::collections::BinaryHeap;

/// Many passes of few moves are better than few of many: each starts from what the last has found.
const PASSES: usize = 8;

/// In each pass one of so many nodes is moved, if that helps.
const NODES_PER_MOVE: usize = 32;

/// The most nodes that are moved in a pass: nearly all of the area is in the largest.
const MAX_MOVES: usize = 4096;

const ROOT: u32 = 0;

/// Improves a tree: the sum of the areas of its nodes falls.
pub(super) fn reinsert(nodes: &mut Vec<BinaryNode>) {
    if nodes.is_empty() {
        return;
    }
    let mut tree = LinkedTree::new(std::mem::take(nodes));
    for _ in 0..PASSES {
        let candidates = tree.largest(MAX_MOVES.min(tree.nodes.len() / NODES_PER_MOVE));
        let places: Vec<_> = candidates
            .par_iter()
            .map_init(Vec::new, |stack, &node| tree.best_place(node, stack))
            .collect();
        // One after the other: earlier moves may have made later ones bad, or impossible.
        for (node, place) in candidates.into_iter().zip(places) {
            if let Some(place) = place {
                tree.try_move(node, place);
            }
        }
    }
    *nodes = tree.nodes;
}

/// A tree with links to parents.
struct LinkedTree {
    nodes: Vec<BinaryNode>,
    /// The parent of each pair.
    parents: Vec<u32>,
    /// The height of a tree with the pair below its root.
    heights: Vec<u8>,
}

impl LinkedTree {
    fn new(nodes: Vec<BinaryNode>) -> LinkedTree {
        let mut tree = LinkedTree {
            parents: vec![ROOT; nodes.len() / 2],
            heights: vec![0; nodes.len() / 2],
            nodes,
        };
        // Backwards, as parents come before their children.
        for node in (0..tree.nodes.len() as u32).rev() {
            if let Content::Pair(pair) = tree.nodes[node as usize].content() {
                tree.parents[pair as usize] = node;
                tree.heights[pair as usize] = tree.height_above(pair);
            }
        }
        tree
    }

    fn pair(&self, pair: u32) -> &[BinaryNode; 2] {
        pair_of(&self.nodes, pair)
    }

    /// The parent of a node other than the root.
    fn parent(&self, node: u32) -> u32 {
        self.parents[node as usize / 2]
    }

    /// The height of the parent of a pair.
    fn height_above(&self, pair: u32) -> u8 {
        let height = |node: &BinaryNode| match node.content() {
            Content::Leaf(_) => 0,
            Content::Pair(pair) => self.heights[pair as usize],
        };
        let [left, right] = self.pair(pair);
        1 + height(left).max(height(right))
    }

    /// The `count` nodes of the largest area below the root, the largest first.
    fn largest(&self, count: usize) -> Vec<u32> {
        // No node is larger than its parent. Areas are not negative: their bits order like the numbers.
        let mut heap = BinaryHeap::new();
        let mut largest = Vec::with_capacity(count);
        let mut node = ROOT;
        while largest.len() < count {
            if let Content::Pair(pair) = self.nodes[node as usize].content() {
                for child in [2 * pair, 2 * pair + 1] {
                    heap.push((self.nodes[child as usize].half_area().to_bits(), child));
                }
            }
            let Some((_, next)) = heap.pop() else { break };
            largest.push(next);
            node = next;
        }
        largest
    }

    /// Where a node below the root would save most as the sibling of another; none if it does nowhere.
    fn best_place(&self, moved: u32, stack: &mut Vec<(f32, u32)>) -> Option<u32> {
        let mut search = Search {
            tree: self,
            node: self.nodes[moved as usize],
            stack,
            best: (0.0, None),
        };
        let (mut sibling, mut ancestor) = (moved ^ 1, self.parent(moved));
        // What is saved without the node: the parent, and what the other ancestors below this one lose.
        let mut saved = self.nodes[ancestor as usize].half_area();
        let mut rest = self.nodes[sibling as usize];
        search.below(sibling, saved);
        while ancestor != ROOT {
            sibling = ancestor ^ 1;
            ancestor = self.parent(ancestor);
            search.below(sibling, saved);
            rest = BinaryNode::around(&[rest, self.nodes[sibling as usize]], 0);
            saved += self.nodes[ancestor as usize].half_area() - rest.half_area();
        }
        search.best.1
    }

    /// Makes a node the sibling of `place`, if that is possible and lowers the sum of all areas.
    fn try_move(&mut self, node: u32, place: u32) {
        let (parent, sibling) = (self.parent(node), node ^ 1);
        let mut ancestor = place;
        while ancestor != ROOT && ancestor != node {
            ancestor = self.parent(ancestor);
        }
        if ancestor == node || place == parent || place == sibling {
            return;
        }
        let slots = [parent, sibling, place];
        let [p, s, t] = slots.map(|slot| self.nodes[slot as usize]);
        let change = self.replace(slots, [s, t, p], place);
        let too_high = self.height() > MAX_DEPTH;
        // False for NaN.
        let better = change < 0.0;
        if !better || too_high {
            self.replace(slots, [p, s, t], parent);
        }
    }

    /// Puts contents into slots, of which `above` becomes the parent of the second, and fits all boxes above. Returns
    /// by how much the sum of areas grows.
    fn replace(&mut self, slots: [u32; 3], contents: [BinaryNode; 3], above: u32) -> f64 {
        for (slot, content) in slots.into_iter().zip(contents) {
            self.nodes[slot as usize] = content;
            if let Content::Pair(pair) = content.content() {
                self.parents[pair as usize] = slot;
            }
        }
        let mut change = self.refit(above).1;
        for slot in [slots[0], slots[2]] {
            let mut node = slot;
            // The parent of a slot has to be fitted even if the content is as large as what was there.
            while node != ROOT {
                node = self.parent(node);
                let (changed, by) = self.refit(node);
                change += by;
                if !changed {
                    break;
                }
            }
        }
        change
    }

    /// Fits an inner node around its children; returns whether its box or height changed, and by how much its area
    /// grew.
    fn refit(&mut self, node: u32) -> (bool, f64) {
        let before = self.nodes[node as usize];
        let Content::Pair(pair) = before.content() else {
            return (false, 0.0);
        };
        let after = BinaryNode::around(self.pair(pair), pair);
        let height = self.height_above(pair);
        let changed = after.bounds() != before.bounds() || height != self.heights[pair as usize];
        self.nodes[node as usize] = after;
        self.heights[pair as usize] = height;
        let growth = f64::from(after.half_area()) - f64::from(before.half_area());
        (changed, growth)
    }

    fn height(&self) -> usize {
        match self.nodes[ROOT as usize].content() {
            Content::Leaf(_) => 0,
            Content::Pair(pair) => self.heights[pair as usize].into(),
        }
    }
}

/// A search for the best place of a node, by branch and bound.
struct Search<'a> {
    tree: &'a LinkedTree,
    node: BinaryNode,
    /// Pairs still to be searched, and what is saved before their place is paid for.
    stack: &'a mut Vec<(f32, u32)>,
    /// What is saved in all, and where.
    best: (f32, Option<u32>),
}

impl Search<'_> {
    /// Considers a place and all below it.
    fn below(&mut self, place: u32, saved: f32) {
        self.visit(place, saved);
        while let Some((saved, pair)) = self.stack.pop() {
            if saved - self.node.half_area() > self.best.0 {
                self.visit(2 * pair, saved);
                self.visit(2 * pair + 1, saved);
            }
        }
    }

    /// Considers a place, and notes what is below it if that may be better: the new parent is at least as large as
    /// the node.
    fn visit(&mut self, place: u32, saved: f32) {
        let other = &self.tree.nodes[place as usize];
        let gain = saved - self.node.half_area_with(other);
        if gain > self.best.0 {
            self.best = (gain, Some(place));
        }
        if let Content::Pair(pair) = other.content() {
            let saved = gain + other.half_area();
            if saved - self.node.half_area() > self.best.0 {
                self.stack.push((saved, pair));
            }
        }
    }
}
