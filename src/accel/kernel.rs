//! Walks the tree. One generic walk, compiled once for any processor and once for AVX2.
#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::Bvh;
use super::node::{BoxRay, Child, PADDING};
use super::simd::{F32x8, Portable};
use super::stack::Stack;
use super::triangle_block::{ShearedRay, is_before};
use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};

/// The instructions that the walk uses; results do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kernel {
    Portable,
    /// Exists only on a processor that has AVX2: made by [`Kernel::detect`] alone.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Kernel {
    /// The best that this processor has.
    pub(super) fn detect() -> Kernel {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            return Kernel::Avx2;
        }
        Kernel::Portable
    }
}

pub(super) fn closest(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
    match bvh.kernel {
        Kernel::Portable => walk_closest::<Portable>(bvh, ray, stack),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: this kernel is only chosen where AVX2 was detected.
        Kernel::Avx2 => unsafe { avx2::closest(bvh, ray, stack) },
    }
}

pub(super) fn occluded(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> bool {
    match bvh.kernel {
        Kernel::Portable => walk_occluded::<Portable>(bvh, ray, stack),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: this kernel is only chosen where AVX2 was detected.
        Kernel::Avx2 => unsafe { avx2::occluded(bvh, ray, stack) },
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::super::simd::Avx2;
    use super::*;

    #[target_feature(enable = "avx2")]
    pub(super) fn closest(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
        walk_closest::<Avx2>(bvh, ray, stack)
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn occluded(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> bool {
        walk_occluded::<Avx2>(bvh, ray, stack)
    }
}

/// The root is node 0.
const ROOT: u32 = 0;

#[inline(always)]
fn walk_closest<V: F32x8>(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
    let box_ray = BoxRay::new(ray);
    let sheared_ray = ShearedRay::new(ray);
    let mut best = Hit {
        t: f64::from(f32::MAX),
        primitive: NO_PRIMITIVE,
    };
    // Boxes entered behind this hold nothing better: `best`, grown by what entries are rounded.
    let mut limit = f32::MAX;
    stack.clear();
    stack.push(0.0, ROOT);
    while let Some((near, child)) = stack.pop() {
        if near > limit {
            continue;
        }
        match Child::unpack(child) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, mut entered) = node.enter::<V>(&box_ray, limit);
                let first = stack.len();
                while entered != 0 {
                    let lane = entered.trailing_zeros() as usize;
                    entered &= entered - 1;
                    stack.insert(first, near[lane], node.children[lane]);
                }
                continue;
            }
            Child::Triangles(index) => {
                bvh.blocks[index as usize].closest::<V>(ray, &sheared_ray, &mut best);
            }
            Child::Sphere(index) => {
                let primitive = bvh.first_sphere + index;
                if primitive != ray.exclude
                    && let Some(t) = bvh.spheres[index as usize].intersect(ray)
                {
                    let hit = Hit { t, primitive };
                    if is_before(&hit, &best) {
                        best = hit;
                    }
                }
            }
        }
        limit = best.t as f32 * PADDING;
    }
    (best.primitive != NO_PRIMITIVE).then_some(best)
}

#[inline(always)]
fn walk_occluded<V: F32x8>(bvh: &Bvh, ray: &Ray, stack: &mut Stack) -> bool {
    let box_ray = BoxRay::new(ray);
    let sheared_ray = ShearedRay::new(ray);
    let limit = ray.t_max * PADDING;
    stack.clear();
    stack.push(0.0, ROOT);
    while let Some((_, child)) = stack.pop() {
        let found = match Child::unpack(child) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (_, mut entered) = node.enter::<V>(&box_ray, limit);
                while entered != 0 {
                    let lane = entered.trailing_zeros() as usize;
                    entered &= entered - 1;
                    stack.push(0.0, node.children[lane]);
                }
                false
            }
            Child::Triangles(index) => bvh.blocks[index as usize].occludes::<V>(ray, &sheared_ray),
            Child::Sphere(index) => {
                bvh.first_sphere + index != ray.exclude
                    && bvh.spheres[index as usize].intersect(ray).is_some()
            }
        };
        if found {
            return true;
        }
    }
    false
}
