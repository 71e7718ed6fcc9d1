//! Traversal by one ray, eight boxes or triangles at once (Dammertz et al. 2008, "Shallow Bounding Volume
//! Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays"; Wald, Benthin and Boulos 2008, "Getting Rid of
//! Packets").

use super::bvh::Bvh;
use super::hit_filter::{DISTANCE_PADDING, accept_hit};
use super::node::{BoxRay, Child, ROOT};
use super::stack::Stack;
use super::watertight::{ShearedRays, permuted_axes};
use crate::geometry::Hit;
use crate::math::Ray;
use crate::simd::{Floats, Simd, WithSimd};

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
        let axes = permuted_axes(ray.direction);
        let sheared = ShearedRays::<S::F32x8>::splat(ray, axes, bvh.magnitude);
        let mut best = Hit::MISS;
        if bvh.nodes.is_empty() {
            for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
                if let Some(t) = sphere.intersect(ray)
                    && accept_hit::<ANY_HIT>(ray, t, primitive, &mut best)
                {
                    return best;
                }
            }
            for block in &bvh.blocks {
                if block.intersect::<_, ANY_HIT>(ray, axes, &sheared, &mut best) {
                    return best;
                }
            }
            return best;
        }
        let box_ray = BoxRay::new(ray);
        // Boxes entered beyond this hold nothing that counts.
        let mut limit = if ANY_HIT {
            ray.t_max * DISTANCE_PADDING
        } else {
            f32::MAX
        };
        stack.clear();
        let mut next = ROOT;
        loop {
            match Child::unpack(next) {
                Child::Node(index) => {
                    let node = &bvh.nodes[index as usize];
                    let (near, far) = node.intersect_boxes::<S::F32x8>(&box_ray, limit);
                    let entered = near.le(far);
                    if ANY_HIT {
                        // In no order: any hit ends the traversal, and sorting costs more than it saves.
                        stack.push(&node.children, entered);
                    } else if let Some(nearest) =
                        stack.push_sorted(&near.store(), &node.children, entered)
                    {
                        next = nearest;
                        continue;
                    }
                }
                Child::Triangles(index) => {
                    let block = &bvh.blocks[index as usize];
                    if block.intersect::<_, ANY_HIT>(ray, axes, &sheared, &mut best) {
                        return best;
                    }
                    if !ANY_HIT {
                        limit = best.t as f32 * DISTANCE_PADDING;
                    }
                }
                Child::Sphere(index) => {
                    if let Some(t) = bvh.spheres[index as usize].intersect(ray) {
                        if accept_hit::<ANY_HIT>(ray, t, bvh.first_sphere + index, &mut best) {
                            return best;
                        }
                        if !ANY_HIT {
                            limit = best.t as f32 * DISTANCE_PADDING;
                        }
                    }
                }
            }
            next = loop {
                match stack.pop() {
                    None => return best,
                    Some((near, child)) if ANY_HIT || near <= limit => break child,
                    _ => {}
                }
            };
        }
    }
}
