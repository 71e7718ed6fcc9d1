use super::WIDTH;
use super::simd::F32x8;
use crate::math::{Aabb, Ray};
use glam::Vec3;

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
/// Planes are ordered min x, y, z, max x, y, z. Lanes without a child hold the empty box, which
/// no ray enters.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    planes: [[f32; WIDTH]; 6],
    pub(super) children: [u32; WIDTH],
}

impl Node {
    pub(super) fn new(children: &[(Aabb, Child)]) -> Node {
        let mut node = Node {
            planes: [[0.0; WIDTH]; 6],
            children: [0; WIDTH],
        };
        for lane in 0..WIDTH {
            let bounds = children.get(lane).map_or(Aabb::EMPTY, |c| c.0);
            for axis in 0..3 {
                node.planes[axis][lane] = bounds.min[axis];
                node.planes[axis + 3][lane] = bounds.max[axis];
            }
            if let Some((_, child)) = children.get(lane) {
                node.children[lane] = child.pack();
            }
        }
        node
    }

    /// Where the ray enters each box, and a bit for each box that it enters within `0..=t_max`.
    #[inline(always)]
    pub(super) fn enter<V: F32x8>(&self, ray: &BoxRay, t_max: f32) -> ([f32; WIDTH], u32) {
        let mut near = V::splat(0.0);
        let mut far = V::splat(t_max);
        for axis in 0..3 {
            let origin = V::splat(ray.origin[axis]);
            let inverse = V::splat(ray.inverse[axis]);
            let entry = V::load(&self.planes[ray.near[axis]]).sub(origin);
            let exit = V::load(&self.planes[ray.far[axis]]).sub(origin);
            near = entry.mul(inverse).max(near);
            far = exit.mul(inverse).mul(V::splat(PADDING)).min(far);
        }
        (near.store(), near.le(far))
    }
}

/// Each distance to a plane carries three roundings: growing the exit by more than twice that
/// much never misses a box that the exact ray enters (Ize 2013, "Robust BVH Ray Traversal",
/// JCGT 2(2)).
pub(super) const PADDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// What the box test needs of a ray.
pub(super) struct BoxRay {
    origin: Vec3,
    inverse: Vec3,
    /// The plane through which the ray enters a box, for each axis, and through which it leaves.
    near: [usize; 3],
    far: [usize; 3],
}

impl BoxRay {
    pub(super) fn new(ray: &Ray) -> BoxRay {
        let d = ray.direction;
        let inverse = Vec3::new(invert(d.x), invert(d.y), invert(d.z));
        // The planes of least coordinates come first, those of greatest three after.
        let near = |axis: usize| axis + 3 * usize::from(inverse[axis] < 0.0);
        let far = |axis: usize| axis + 3 * usize::from(inverse[axis] >= 0.0);
        BoxRay {
            origin: ray.origin,
            inverse,
            near: [near(0), near(1), near(2)],
            far: [far(0), far(1), far(2)],
        }
    }
}

/// The reciprocal of a component; of zero, a number so large that a ray inside a slab's plane gets
/// 0 * large = 0, where 0 * inf would be NaN.
fn invert(component: f32) -> f32 {
    const SMALLEST: f32 = 1e-30;
    1.0 / if component.abs() < SMALLEST {
        SMALLEST.copysign(component)
    } else {
        component
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
