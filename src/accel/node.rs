//! Nodes of eight children, and the ray-box test (slabs with conservative rounding: Ize 2013, "Robust BVH Ray
//! Traversal", JCGT 2(2)).

use super::constants::WIDTH;
use super::ray_setup::RaySetup;
use super::rounding::padded;
use crate::math::Aabb;
use crate::simd::Floats;
use glam::Vec3;

/// The index of the root node.
pub(super) const ROOT: u32 = 0;

/// A child of a node; packed into a word of two bits of kind and thirty of index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    Node(u32),
    Triangles(u32),
    Sphere(u32),
}

impl Child {
    pub(super) fn pack(self) -> u32 {
        match self {
            Child::Node(index) => index << 2,
            Child::Triangles(index) => index << 2 | 1,
            Child::Sphere(index) => index << 2 | 2,
        }
    }

    /// The same child after `nodes` nodes and `blocks` blocks were inserted before it.
    pub(super) fn with_offset(self, nodes: u32, blocks: u32) -> Child {
        match self {
            Child::Node(index) => Child::Node(index + nodes),
            Child::Triangles(index) => Child::Triangles(index + blocks),
            Child::Sphere(index) => Child::Sphere(index),
        }
    }

    #[inline(always)]
    pub(super) fn unpack(word: u32) -> Child {
        let index = word >> 2;
        match word & 3 {
            0 => Child::Node(index),
            1 => Child::Triangles(index),
            _ => Child::Sphere(index),
        }
    }
}

/// The boxes of up to eight children, plane by plane, and what they are.
///
/// Boxes are grown in proportion to their coordinates. Lanes without a child hold the empty box, which no ray
/// enters.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// `planes[axis][side][lane]`, the lower side first.
    pub(super) planes: [[[f32; WIDTH]; 2]; 3],
    pub(super) children: [u32; WIDTH],
}

impl Node {
    pub(super) fn new(children: &[(Aabb, Child)]) -> Node {
        let mut node = Node {
            planes: [[[0.0; WIDTH]; 2]; 3],
            children: [0; WIDTH],
        };
        for lane in 0..WIDTH {
            let child = children.get(lane);
            let bounds = child.map_or(Aabb::EMPTY, |c| padded(c.0));
            for axis in 0..3 {
                node.planes[axis][0][lane] = bounds.min[axis];
                node.planes[axis][1][lane] = bounds.max[axis];
            }
            if let Some((_, child)) = child {
                node.children[lane] = child.pack();
            }
        }
        node
    }

    /// The box of a child; empty where there is none.
    pub(super) fn bounds(&self, lane: usize) -> Aabb {
        let corner = |side: usize| Vec3::from_array(self.planes.map(|sides| sides[side][lane]));
        Aabb {
            min: corner(0),
            max: corner(1),
        }
    }

    /// Puts a leaf into lanes without a child: rays with NaN enter even empty boxes, and their traversal must
    /// end.
    pub(super) fn fill_empty(&mut self, leaf: Child) {
        for lane in 0..WIDTH {
            if self.bounds(lane) == Aabb::EMPTY {
                self.children[lane] = leaf.pack();
            }
        }
    }

    /// Renumbers the children after `nodes` nodes and `blocks` blocks were inserted before them.
    pub(super) fn offset_children(&mut self, nodes: u32, blocks: u32) {
        for word in &mut self.children {
            *word = Child::unpack(*word).with_offset(nodes, blocks).pack();
        }
    }

    /// The mask of lanes with a child.
    #[inline(always)]
    pub(super) fn occupied<V: Floats<WIDTH>>(&self) -> u32 {
        let [lower, upper] = &self.planes[0];
        V::load(lower).le(V::load(upper))
    }

    /// The planes of all children.
    #[inline(always)]
    pub(super) fn planes<V: Floats<WIDTH>>(&self) -> [[V; 2]; 3] {
        let [[a, b], [c, d], [e, f]] = &self.planes;
        let load = V::load;
        [[load(a), load(b)], [load(c), load(d)], [load(e), load(f)]]
    }

    /// A lower bound of where the ray enters each box, and an upper bound of where it leaves; the first is
    /// greater for a box that the ray does not enter within `0..=t_max`.
    #[inline(always)]
    pub(super) fn intersect_boxes<V: Floats<WIDTH>>(&self, ray: &BoxRay<V>, t_max: f32) -> (V, V) {
        let mut near = V::splat(0.0);
        let mut far = V::splat(t_max);
        for axis in 0..3 {
            let (inverse, sides) = (ray.inverse[axis], &self.planes[axis]);
            let entry = V::load(&sides[usize::from(ray.down[axis])]);
            let exit = V::load(&sides[usize::from(!ray.down[axis])]);
            near = entry.mul_sub(inverse, ray.near_offset[axis]).max(near);
            far = exit.mul_sub(inverse, ray.far_offset[axis]).min(far);
        }
        (near, far)
    }
}

/// What the box test needs of a ray: t = plane * inverse - offset, axis by axis.
pub(super) struct BoxRay<V> {
    inverse: [V; 3],
    near_offset: [V; 3],
    far_offset: [V; 3],
    /// Whether the ray descends: it enters boxes through their upper planes.
    down: [bool; 3],
}

impl<V: Floats<WIDTH>> BoxRay<V> {
    #[inline(always)]
    pub(super) fn splat<const RAYS: usize>(setup: &RaySetup<RAYS>, lane: usize) -> BoxRay<V> {
        let lane = lane % RAYS;
        let splat = |[x, y, z]: &[[f32; RAYS]; 3]| {
            [V::splat(x[lane]), V::splat(y[lane]), V::splat(z[lane])]
        };
        BoxRay {
            inverse: splat(&setup.inverse),
            near_offset: splat(&setup.near_offset),
            far_offset: splat(&setup.far_offset),
            down: setup.down.map(|mask| mask >> lane & 1 != 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_survive_packing() {
        for child in [
            Child::Node(0),
            Child::Triangles(7),
            Child::Sphere((1 << 30) - 1),
        ] {
            assert_eq!(Child::unpack(child.pack()), child);
        }
    }
}
