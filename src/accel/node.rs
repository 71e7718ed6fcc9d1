//! Nodes of eight children, and the ray-box test (slabs with conservative rounding: Ize 2013, "Robust BVH Ray
//! Traversal", JCGT 2(2)).

use super::constants::WIDTH;
use super::rounding::{BOX_PADDING, origin_magnitude, padded};
use crate::math::{Aabb, Ray};
use crate::simd::Floats;
use glam::{Vec3, Vec4};

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
/// Planes are ordered min x, y, z, max x, y, z, of boxes that are grown in proportion to their
/// coordinates. Lanes without a child hold the empty box, which no ray enters.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) planes: [[f32; WIDTH]; 6],
    pub(super) children: [u32; WIDTH],
}

impl Node {
    pub(super) fn new(children: &[(Aabb, Child)]) -> Node {
        let mut node = Node {
            planes: [[0.0; WIDTH]; 6],
            children: [0; WIDTH],
        };
        for lane in 0..WIDTH {
            let child = children.get(lane);
            let bounds = child.map_or(Aabb::EMPTY, |c| padded(c.0));
            for axis in 0..3 {
                node.planes[axis][lane] = bounds.min[axis];
                node.planes[axis + 3][lane] = bounds.max[axis];
            }
            if let Some((_, child)) = child {
                node.children[lane] = child.pack();
            }
        }
        node
    }

    /// The box of a child; empty where there is none.
    pub(super) fn bounds(&self, lane: usize) -> Aabb {
        let corner = |first: usize| {
            Vec3::new(
                self.planes[first][lane],
                self.planes[first + 1][lane],
                self.planes[first + 2][lane],
            )
        };
        Aabb {
            min: corner(0),
            max: corner(3),
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

    /// The planes of all children.
    #[inline(always)]
    pub(super) fn planes<V: Floats<WIDTH>>(&self) -> [V; 6] {
        let [a, b, c, d, e, f] = &self.planes;
        let load = V::load;
        [load(a), load(b), load(c), load(d), load(e), load(f)]
    }

    /// A lower bound of where the ray enters each box, and an upper bound of where it leaves; the first is
    /// greater for a box that the ray does not enter within `0..=t_max`.
    #[inline(always)]
    pub(super) fn intersect_boxes<V: Floats<WIDTH>>(&self, ray: &BoxRay, t_max: f32) -> (V, V) {
        let mut near = V::splat(0.0);
        let mut far = V::splat(t_max);
        for axis in 0..3 {
            let inverse = V::splat(ray.inverse[axis]);
            let entry = V::load(&self.planes[ray.near[axis]]);
            let exit = V::load(&self.planes[ray.far[axis]]);
            near = entry
                .mul_sub(inverse, V::splat(ray.near_offset[axis]))
                .max(near);
            far = exit
                .mul_sub(inverse, V::splat(ray.far_offset[axis]))
                .min(far);
        }
        (near, far)
    }
}

/// Components of a direction that are smaller than this, relative to the largest, count as this much: their
/// reciprocals would overflow. That moves a ray by less than boxes are padded.
pub(super) const MIN_DIRECTION: f32 = 1e-18;

/// What the box test needs of a ray: t = plane * inverse - offset.
pub(super) struct BoxRay {
    inverse: Vec3,
    /// The origin's part of t where the ray enters a padded box, and where it leaves.
    near_offset: Vec3,
    far_offset: Vec3,
    /// The index of the plane through which the ray enters a box, for each axis, and of that through which it
    /// leaves.
    near: [usize; 3],
    far: [usize; 3],
}

impl BoxRay {
    pub(super) fn new(ray: &Ray) -> BoxRay {
        // Four lanes, the last unused: one division in place of three.
        let (d, origin) = (ray.direction.extend(0.0), ray.origin.extend(0.0));
        let size = d.abs();
        let smallest = Vec4::splat(MIN_DIRECTION * size.max_element());
        let d = Vec4::select(size.cmplt(smallest), smallest.copysign(d), d);
        let inverse = Vec4::ONE / d;
        let padding = BOX_PADDING * origin_magnitude(ray);
        let (center, around) = (origin * inverse, padding * inverse.abs());
        // The lower planes come first, the upper ones three after.
        let down = inverse.is_negative_bitmask();
        let near = |axis: u32| (axis + 3 * (down >> axis & 1)) as usize;
        let far = |axis: u32| (axis + 3 - 3 * (down >> axis & 1)) as usize;
        BoxRay {
            inverse: inverse.truncate(),
            near_offset: (center + around).truncate(),
            far_offset: (center - around).truncate(),
            near: [near(0), near(1), near(2)],
            far: [far(0), far(1), far(2)],
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
