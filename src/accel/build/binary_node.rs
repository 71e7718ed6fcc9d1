//! Nodes of the binary tree that is built first.

use crate::math::Aabb;
use glam::{Vec3, Vec4};

/// What a node of the binary tree is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// An inner node: its children are the nodes of this pair, `2 * pair` and `2 * pair + 1`.
    Pair(u32),
    /// A leaf: the number of its first reference.
    Leaf(u32),
}

/// Marks leaves among packed contents. There are fewer than 2^31 references, and pairs.
const LEAF: u32 = 1 << 31;

/// A box, half its surface area, and what is in it.
///
/// Four lanes, so that unions of boxes are vector instructions; the fourth of `min` holds the content, that of
/// `max` the area.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    min: Vec4,
    max: Vec4,
}

impl BinaryNode {
    /// A leaf of nothing, for places that hold no node, or none yet.
    pub(super) const EMPTY: BinaryNode = BinaryNode {
        min: Vec4::new(
            f32::INFINITY,
            f32::INFINITY,
            f32::INFINITY,
            f32::from_bits(LEAF),
        ),
        max: Vec4::NEG_INFINITY,
    };

    #[inline(always)]
    pub(super) fn new(min: Vec4, max: Vec4, content: Content) -> BinaryNode {
        let mut node = BinaryNode {
            min,
            max: max.truncate().extend(half_area(min, max)),
        };
        node.set_content(content);
        node
    }

    #[inline(always)]
    pub(super) fn content(&self) -> Content {
        let word = self.min.w.to_bits();
        match word & LEAF {
            0 => Content::Pair(word),
            _ => Content::Leaf(word & !LEAF),
        }
    }

    pub(super) fn set_content(&mut self, content: Content) {
        let word = match content {
            Content::Pair(pair) => pair,
            Content::Leaf(first) => LEAF | first,
        };
        self.min.w = f32::from_bits(word);
    }

    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        self.max.w
    }

    /// Half the surface area of the box around this node and another.
    #[inline(always)]
    pub(super) fn half_area_with(&self, other: &BinaryNode) -> f32 {
        half_area(self.min.min(other.min), self.max.max(other.max))
    }

    /// The parent of two nodes.
    #[inline(always)]
    pub(super) fn around(children: &[BinaryNode; 2], pair: u32) -> BinaryNode {
        let [a, b] = children;
        BinaryNode::new(a.min.min(b.min), a.max.max(b.max), Content::Pair(pair))
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb {
            min: self.min.truncate(),
            max: self.max.truncate(),
        }
    }
}

/// The nodes of a pair.
#[inline(always)]
pub(super) fn pair_of(nodes: &[BinaryNode], pair: u32) -> &[BinaryNode; 2] {
    &nodes.as_chunks().0[pair as usize]
}

/// Half the surface area of a box that is not empty; at most the largest number.
#[inline(always)]
pub(super) fn half_area(min: Vec4, max: Vec4) -> f32 {
    let e: Vec3 = (max - min).truncate();
    let area = e.x * e.y + e.y * e.z + e.z * e.x;
    // Also in place of NaN, of sides that overflow and of 0: areas are compared and subtracted.
    if area < f32::MAX { area } else { f32::MAX }
}
