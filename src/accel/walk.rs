//! One ray through the tree, eight boxes or triangles at once.

use super::node::{BoxRay, Child, ROOT};
use super::simd::{Floats, Machine};
use super::stack::Stack;
use super::triangle_block::{PADDING, is_in_the_way, take_nearer};
use super::watertight::{ShearedRays, permuted_axes};
use super::{Bvh, NOTHING};
use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};

#[inline(always)]
pub(super) fn walk_closest<M: Machine>(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
    let axes = permuted_axes(ray.direction);
    let sheared = ShearedRays::<M::One>::splat(ray, axes, bvh.magnitude);
    let mut best = NOTHING;
    if bvh.nodes.is_empty() {
        for block in &bvh.blocks {
            block.closest(ray, axes, &sheared, &mut best);
        }
        for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
            if let Some(t) = sphere.intersect(ray) {
                take_nearer(ray, t, primitive, &mut best);
            }
        }
        return (best.primitive != NO_PRIMITIVE).then_some(best);
    }
    let box_ray = BoxRay::new(ray);
    // Boxes entered behind this hold nothing better: `best`, grown by what it was rounded.
    let mut limit = f32::MAX;
    stack.clear();
    let mut next = ROOT;
    loop {
        match Child::unpack(next) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, far) = node.enter::<M::One>(&box_ray, limit);
                let entered = near.le(far);
                if let Some(nearest) = stack.push_sorted(&near.store(), &node.children, entered) {
                    next = nearest;
                    continue;
                }
            }
            Child::Triangles(index) => {
                bvh.blocks[index as usize].closest(ray, axes, &sheared, &mut best);
                limit = best.t as f32 * PADDING;
            }
            Child::Sphere(index) => {
                if let Some(t) = bvh.spheres[index as usize].intersect(ray) {
                    take_nearer(ray, t, bvh.first_sphere + index, &mut best);
                    limit = best.t as f32 * PADDING;
                }
            }
        }
        next = loop {
            match stack.pop() {
                None => return (best.primitive != NO_PRIMITIVE).then_some(best),
                Some((near, child)) if near <= limit => break child,
                _ => {}
            }
        };
    }
}

#[inline(always)]
pub(super) fn walk_occluded<M: Machine>(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> bool {
    let axes = permuted_axes(ray.direction);
    let sheared = ShearedRays::<M::One>::splat(ray, axes, bvh.magnitude);
    if bvh.nodes.is_empty() {
        let mut spheres = bvh.spheres.iter().zip(bvh.first_sphere..);
        return spheres.any(|(sphere, primitive)| {
            let hit = sphere.intersect(ray);
            hit.is_some_and(|t| is_in_the_way(ray, t, primitive))
        }) || bvh
            .blocks
            .iter()
            .any(|block| block.occludes(ray, axes, &sheared));
    }
    let box_ray = BoxRay::new(ray);
    let limit = ray.t_max * PADDING;
    stack.clear();
    let mut next = ROOT;
    loop {
        match Child::unpack(next) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, far) = node.enter::<M::One>(&box_ray, limit);
                stack.push(&node.children, near.le(far));
            }
            Child::Triangles(index) => {
                if bvh.blocks[index as usize].occludes(ray, axes, &sheared) {
                    return true;
                }
            }
            Child::Sphere(index) => {
                if let Some(t) = bvh.spheres[index as usize].intersect(ray)
                    && is_in_the_way(ray, t, bvh.first_sphere + index)
                {
                    return true;
                }
            }
        }
        match stack.pop() {
            None => return false,
            Some((_, child)) => next = child,
        }
    }
}
