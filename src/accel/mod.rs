//! Which primitive does a ray meet first, and is anything in its way: an 8-wide bounding volume
//! hierarchy over triangles and spheres.
//!
//! Triangles are tested with the watertight method, boxes are padded by its error bound: a ray
//! that passes through the common edge of two triangles hits at least one. Of several primitives
//! at the same distance the one with the lowest number is hit, so the answer does not depend on
//! the tree. All kernels give the same bits.
//!
//! Knows shapes and boxes, never materials, files or threads.

mod build;
mod bundle;
mod found;
mod kernel;
mod lanes;
mod node;
mod packet;
mod simd;
mod stack;
mod triangle_block;
mod validate;
mod walk;
mod watertight;

use crate::geometry::{Hit, Sphere};
use crate::math::{Aabb, NO_PRIMITIVE, Ray};
use glam::Vec3;
use kernel::Kernel;
use node::Node;
use stack::Stack;
use triangle_block::TriangleBlock;
use watertight::permuted_axes;

pub use packet::PACKET;
pub use validate::TreeFault;

/// Eight children, or eight triangles, are tested at once.
const WIDTH: usize = 8;

/// No leaf lies deeper in a tree.
const MAX_DEPTH: usize = 79;

/// Triangles and spheres arranged for ray queries.
#[derive(Debug)]
pub struct Bvh {
    /// The root first; none if the scene is so small that everything in it is tested.
    nodes: Vec<Node>,
    blocks: Vec<TriangleBlock>,
    spheres: Vec<Sphere>,
    /// The number of the first sphere: triangles are numbered before.
    first_sphere: u32,
    bounds: Aabb,
    /// The largest absolute coordinate.
    magnitude: f32,
    kernel: Kernel,
}

/// Scratch space of ray queries, one for each thread, and the count of its rays.
#[derive(Debug, Default)]
pub struct Traversal {
    stack: Stack,
    packet_stack: packet::PacketStack,
    /// How many queries have been answered.
    pub rays: u64,
}

impl Bvh {
    /// Arranges `triangles`, numbered from 0, and `spheres`, numbered after them.
    ///
    /// Coordinates are finite; there are fewer than 2^30 of either.
    pub fn new(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>) -> Bvh {
        build::build(triangles, spheres, Kernel::detect())
    }

    /// The box around everything.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Bytes of the tree and what hangs in it.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + size_of_val(&*self.spheres)
    }

    /// The nearest primitive that the ray meets, or none. It looks all the way: `t_max` only bounds
    /// [`Bvh::occluded`].
    #[inline]
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Option<Hit> {
        traversal.rays += 1;
        kernel::closest(self, ray, &mut traversal.stack)
    }

    /// The nearest primitive that each ray meets, sixteen at a time, as [`Bvh::closest`].
    ///
    /// Fast if the rays run side by side, with the same results if they do not.
    pub fn closest_of_packet(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        for (rays, hits) in rays.chunks(PACKET).zip(hits.chunks_mut(PACKET)) {
            if !self.try_packet::<false>(rays, traversal, |number, found| {
                hits[number] = (found.primitive != NO_PRIMITIVE).then_some(found);
            }) {
                self.closest_of_wave(rays, hits, traversal);
            }
        }
    }

    /// The nearest primitive that each of any number of rays meets, as [`Bvh::closest`].
    ///
    /// Faster than one ray after the other where there is no tree.
    pub fn closest_of_wave(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        if self.nodes.is_empty() {
            packets_by_axis(rays, |rays, numbers| {
                self.try_packet::<false>(rays, traversal, |lane, found| {
                    hits[numbers[lane]] = (found.primitive != NO_PRIMITIVE).then_some(found);
                });
            });
        } else {
            for (hit, ray) in hits.iter_mut().zip(rays) {
                *hit = self.closest(ray, traversal);
            }
        }
    }

    /// Whether anything lies in the ray's interval.
    #[inline]
    pub fn occluded(&self, ray: &Ray, traversal: &mut Traversal) -> bool {
        traversal.rays += 1;
        kernel::occluded(self, ray, &mut traversal.stack)
    }

    /// Whether anything lies in the interval of each ray, sixteen at a time, as [`Bvh::occluded`].
    pub fn occluded_of_packet(
        &self,
        rays: &[Ray],
        occluded: &mut [bool],
        traversal: &mut Traversal,
    ) {
        for (rays, occluded) in rays.chunks(PACKET).zip(occluded.chunks_mut(PACKET)) {
            if !self.try_packet::<true>(rays, traversal, |number, found| {
                occluded[number] = found.primitive != NO_PRIMITIVE;
            }) {
                self.occluded_of_wave(rays, occluded, traversal);
            }
        }
    }

    /// Whether anything lies in the interval of each of any number of rays, as [`Bvh::occluded`].
    ///
    /// Faster than one ray after the other where there is no tree.
    pub fn occluded_of_wave(&self, rays: &[Ray], occluded: &mut [bool], traversal: &mut Traversal) {
        if self.nodes.is_empty() {
            packets_by_axis(rays, |rays, numbers| {
                self.try_packet::<true>(rays, traversal, |lane, found| {
                    occluded[numbers[lane]] = found.primitive != NO_PRIMITIVE;
                });
            });
        } else {
            for (occluded, ray) in occluded.iter_mut().zip(rays) {
                *occluded = self.occluded(ray, traversal);
            }
        }
    }

    /// Says what each ray of a packet meets, if they have enough in common; otherwise returns false.
    fn try_packet<const ANY: bool>(
        &self,
        rays: &[Ray],
        traversal: &mut Traversal,
        mut say: impl FnMut(usize, Hit),
    ) -> bool {
        if rays.is_empty() {
            return true;
        }
        let mut found = [NOTHING; PACKET];
        let found = &mut found[..rays.len()];
        let is_packet = kernel::packet::<ANY>(self, rays, found, &mut traversal.packet_stack);
        if is_packet {
            traversal.rays += rays.len() as u64;
            for (number, found) in found.iter().enumerate() {
                say(number, *found);
            }
        }
        is_packet
    }
}

/// Hands out packets of rays that have the same main axis, and their numbers in `rays`.
fn packets_by_axis(rays: &[Ray], mut packet: impl FnMut(&[Ray], &[usize])) {
    const MANY: usize = 4 * PACKET;
    for (rays, first) in rays.chunks(MANY).zip((0..).step_by(MANY)) {
        let mut numbers = [[0; MANY]; 3];
        let mut counts = [0; 3];
        for (number, ray) in rays.iter().enumerate() {
            let axis = permuted_axes(ray.direction)[2];
            numbers[axis][counts[axis] % MANY] = number;
            counts[axis] += 1;
        }
        for (numbers, count) in numbers.iter_mut().zip(counts) {
            for numbers in numbers[..count].chunks_mut(PACKET) {
                let mut same = [rays[0]; PACKET];
                for (ray, number) in same.iter_mut().zip(&mut *numbers) {
                    *ray = rays[*number];
                    *number += first;
                }
                packet(&same[..numbers.len()], numbers);
            }
        }
    }
}

/// Farther than any hit.
const NOTHING: Hit = Hit {
    t: f32::MAX as f64,
    primitive: NO_PRIMITIVE,
};

#[cfg(test)]
mod fuzz;
#[cfg(test)]
mod tests;
