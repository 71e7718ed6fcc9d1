use super::WIDTH;
use super::rounding::{GROWTH, grown, reach};
use super::simd::Floats;
use crate::math::{Aabb, Ray};
use glam::{Vec3, Vec4};

/// The node that holds all.
pub(super) const ROOT: u32 = 0;

/// A word that says what a child is: two bits of kind, thirty of index.
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

    /// The same child after `nodes` nodes and `blocks` blocks were put before.
    pub(super) fn shifted(self, nodes: u32, blocks: u32) -> Child {
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
            let bounds = child.map_or(Aabb::EMPTY, |c| grown(c.0));
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

    /// Puts a leaf where there is no child. Rays that are no numbers enter even boxes of nothing, and must
    /// find an end.
    pub(super) fn fill(&mut self, leaf: Child) {
        for lane in 0..WIDTH {
            if self.bounds(lane) == Aabb::EMPTY {
                self.children[lane] = leaf.pack();
            }
        }
    }

    /// Renumbers children after `nodes` nodes and `blocks` blocks were put before.
    pub(super) fn shift(&mut self, nodes: u32, blocks: u32) {
        for word in &mut self.children {
            *word = Child::unpack(*word).shifted(nodes, blocks).pack();
        }
    }

    /// The planes of all children.
    #[inline(always)]
    pub(super) fn planes<V: Floats<WIDTH>>(&self) -> [V; 6] {
        let [a, b, c, d, e, f] = &self.planes;
        let load = V::load;
        [load(a), load(b), load(c), load(d), load(e), load(f)]
    }

    /// A number no greater than where the ray enters each box, and one no less than where it leaves;
    /// the first is greater for a box that it does not enter within `0..=t_max`.
    #[inline(always)]
    pub(super) fn enter<V: Floats<WIDTH>>(&self, ray: &BoxRay, t_max: f32) -> (V, V) {
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

/// Components of a direction that are smaller, as a share of the largest, count as this much: their
/// reciprocals would overflow. Such a ray leaves its plane by less than boxes are grown.
pub(super) const SMALLEST: f32 = 1e-18;

/// What the box test needs of a ray: t = plane * inverse - offset.
pub(super) struct BoxRay {
    inverse: Vec3,
    /// The origin's part of t where the ray enters a box that is grown, and where it leaves.
    near_offset: Vec3,
    far_offset: Vec3,
    /// The plane through which the ray enters a box, for each axis, and through which it leaves.
    near: [usize; 3],
    far: [usize; 3],
}

impl BoxRay {
    pub(super) fn new(ray: &Ray) -> BoxRay {
        // Four lanes, of which the last does not matter: one division in place of three.
        let (d, origin) = (ray.direction.extend(0.0), ray.origin.extend(0.0));
        let size = d.abs();
        let smallest = Vec4::splat(SMALLEST * size.max_element());
        let d = Vec4::select(size.cmplt(smallest), smallest.copysign(d), d);
        let inverse = Vec4::ONE / d;
        let growth = GROWTH * reach(ray);
        let (center, grown) = (origin * inverse, growth * inverse.abs());
        // The planes of least coordinates come first, those of greatest three after.
        let down = inverse.is_negative_bitmask();
        let near = |axis: u32| (axis + 3 * (down >> axis & 1)) as usize;
        let far = |axis: u32| (axis + 3 - 3 * (down >> axis & 1)) as usize;
        BoxRay {
            inverse: inverse.truncate(),
            near_offset: (center + grown).truncate(),
            far_offset: (center - grown).truncate(),
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
