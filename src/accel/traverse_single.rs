//! Traversal by one ray, eight boxes or triangles at once (Dammertz et al. 2008, "Shallow Bounding Volume
//! Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays"; Wald, Benthin and Boulos 2008, "Getting Rid of
//! Packets").

use super::bvh::Bvh;
use super::hit_filter::{DISTANCE_PADDING, accept_hit};
use super::node::{Child, ROOT};
use super::ray_setup::RaySetup;
use super::single_ray::SingleRay;
use super::stack::Stack;
use crate::geometry::Hit;
use crate::math::Ray;
use crate::simd::{Floats, Scalar, Simd, WithSimd};

/// The closest hit of a ray, or, if `ANY_HIT`, some hit in its interval; [`Hit::MISS`] if there is none.
pub(super) struct TraverseSingle<'a, const ANY_HIT: bool> {
    pub(super) bvh: &'a Bvh,
    pub(super) ray: &'a Ray,
    pub(super) stack: &'a mut Stack,
}

impl<const ANY_HIT: bool> WithSimd for TraverseSingle<'_, ANY_HIT> {
    type Output = Hit;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Hit {
        let TraverseSingle { bvh, ray, stack } = self;
        let scalars = |[x, y, z]: [f32; 3]| [Scalar::splat(x), Scalar::splat(y), Scalar::splat(z)];
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let setup = RaySetup::<1>::new(scalars(origin), scalars(direction), bvh.magnitude);
        let ray = SingleRay::<S>::new(ray, &setup, 0);
        let mut best = Hit::MISS;
        if bvh.nodes.is_empty() {
            test_all::<S, ANY_HIT>(bvh, &ray, &mut best);
        } else {
            stack.clear();
            traverse::<S, ANY_HIT>(bvh, &ray, ROOT, stack, &mut best);
        }
        best
    }
}

/// Without a tree.
#[inline(always)]
fn test_all<S: Simd, const ANY_HIT: bool>(bvh: &Bvh, ray: &SingleRay<S>, best: &mut Hit) {
    for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
        if let Some(t) = sphere.intersect(ray.ray)
            && accept_hit::<ANY_HIT>(ray.ray, t, primitive, best)
        {
            return;
        }
    }
    for block in &bvh.blocks {
        if block.intersect::<S, ANY_HIT>(ray, best) {
            return;
        }
    }
}

/// Updates the best hit with all below a child and below what the stack holds.
#[inline(always)]
pub(super) fn traverse<S: Simd, const ANY_HIT: bool>(
    bvh: &Bvh,
    ray: &SingleRay<S>,
    child: u32,
    stack: &mut Stack,
    best: &mut Hit,
) {
    // Boxes entered beyond this hold nothing that counts.
    let mut limit = if ANY_HIT {
        ray.ray.t_max * DISTANCE_PADDING
    } else {
        best.t as f32 * DISTANCE_PADDING
    };
    let mut next = child;
    loop {
        match Child::unpack(next) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, far) = node.intersect_boxes(&ray.boxes, limit);
                let entered = near.le(far);
                let nearest = if ANY_HIT {
                    // In the builder's order: any hit ends the traversal, and sorting costs more than it saves.
                    stack.push(&node.children, entered)
                } else {
                    stack.push_sorted(&near.store(), &node.children, entered)
                };
                if let Some(nearest) = nearest {
                    next = nearest;
                    continue;
                }
            }
            Child::Triangles(index) => {
                let block = &bvh.blocks[index as usize];
                if block.intersect::<S, ANY_HIT>(ray, best) {
                    return;
                }
                if !ANY_HIT {
                    limit = best.t as f32 * DISTANCE_PADDING;
                }
            }
            Child::Sphere(index) => {
                if let Some(t) = bvh.spheres[index as usize].intersect(ray.ray) {
                    if accept_hit::<ANY_HIT>(ray.ray, t, bvh.first_sphere + index, best) {
                        return;
                    }
                    if !ANY_HIT {
                        limit = best.t as f32 * DISTANCE_PADDING;
                    }
                }
            }
        }
        // Children of a query for any hit are pushed without their distances: as 0.
        match stack.pop_within(limit) {
            Some(child) => next = child,
            None => return,
        }
    }
}
