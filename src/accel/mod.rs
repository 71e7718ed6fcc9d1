//! Ray queries over triangles and spheres: an 8-wide bounding volume hierarchy.
//!
//! *Build*: a binary tree by the binned surface area heuristic (Wald 2007), improved by reinsertion of its largest
//! nodes (Bittner et al. 2013), of which the cheapest choice of nodes gets eight children (Ylitie et al. 2017);
//! leaves hold up to eight triangles or one sphere. The smallest scenes have no tree, and all their rays go in
//! packets.
//!
//! *Traversal*: single rays against eight boxes or triangles at once, coherent rays in packets of sixteen. It is
//! written once over [`simd`](crate::simd) lanes and compiled for every instruction set; all kernels give the
//! same bits.
//!
//! *Precision*: triangles are intersected watertight (Woop et al. 2013): a ray that passes through the common
//! edge of two triangles hits at least one. Boxes are padded by the error bounds of both tests (Ize 2013), and
//! distances are in double precision. Of several primitives at the same distance the one with the lowest number
//! is hit, so a hit does not depend on the tree. Error bounds are relative to the coordinates of the ray and of
//! what it hits, not to the whole scene: a padding relative to the scene took 3.6 s a frame in place of 0.07 s
//! with a ground of 1e6 m under a model of 1 m.
//!
//! Knows rays, boxes and primitives, never materials, scenes, files or threads.
//!
//! # What limits single rays
//!
//! Not arithmetic. A diffuse ray in Sponza visits 12 nodes and 3 blocks in 1,600 instructions and 1,100 cycles
//! (Zen 5), and callgrind's model of a processor mispredicts 20 of its branches, most of them on how many boxes
//! are entered and in which order. The time is spent in equal parts on boxes, on sorting them, and on triangles
//! and their exact distances with the setup of the ray. From 10^5 triangles on the tree exceeds the caches, and
//! random rays wait for memory (`cargo bench --bench growth`).
//!
//! # Tried, and no faster
//!
//! * Boxes in a fixed order per octant, without any branch.
//! * Children pushed without a branch: a third slower, as the next box waits for the last.
//! * A sorting network in registers; prefetching; smaller leaves; distances in single precision with error
//!   bounds.
//! * 8 or 16 interleaved rays.
//! * Nodes and blocks of sixteen in AVX-512: -4 to +8 %.
//! * Packets of mixed octants.
//! * Packets of rays sorted by direction that split into single rays when few are left: diffuse rays -10 to +10 %
//!   in windows of 1,024 to 65,536 rays.
//! * Shadow rays after a bounce, sorted by direction, are 1.3 to 1.6 times as fast in windows of 1,024 to 4,096
//!   rays, but sorting, and wavefronts of that size, leave 2 % for a frame.
//! * Spatial splits: diffuse rays in Sponza 1.25 times as fast, in two other scenes no faster, for a build that
//!   takes two to ten times as long.

mod brute_force;
mod build;
mod bvh;
mod closest_point;
mod constants;
mod hit_filter;
mod node;
mod packet_boxes;
mod packet_hits;
mod packet_intersector;
mod packet_interval;
mod query_batch;
mod query_single;
mod query_state;
mod ray_packet;
mod ray_setup;
mod rounding;
mod single_ray;
mod stack;
mod traverse_packet;
mod traverse_shared;
mod traverse_single;
mod triangle_block;
mod triangle_planes;
mod validate;
mod watertight;

pub use brute_force::{DISTANCE_TOLERANCE, disagreement, nearest_triangle};
pub use bvh::Bvh;
pub use query_state::QueryState;
pub use ray_packet::RayPacket;
pub use validate::BvhError;

#[cfg(any(test, fuzzing))]
mod fuzz;
#[cfg(fuzzing)]
pub use fuzz::check_scene_of;
#[cfg(test)]
mod tests;
