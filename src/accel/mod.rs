//! Ray queries over triangles and spheres: an 8-wide bounding volume hierarchy.
//!
//! *Build*: a binary tree by the binned surface area heuristic (Wald 2007), improved by reinsertion of its largest
//! nodes (Bittner et al. 2013), of which the cheapest choice of nodes gets eight children (Ylitie et al. 2017);
//! leaves hold up to eight triangles or one sphere. The smallest scenes have no tree, and all their rays go in
//! packets.
//!
//! *Traversal*: rays come sixteen at a time and are prepared together (`ray_setup`). Coherent rays go on as a
//! packet; others one by one against eight boxes or triangles at once, shadow rays after a shared look at the top of
//! the tree (`traverse_shared`). It is written once over [`simd`](crate::simd) lanes and compiled for every
//! instruction set; all kernels give the same bits.
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
//! # What limits rays
//!
//! Instructions, mispredicted branches and misses of the first-level cache for each ray in Sponza, counted by callgrind
//! with AVX2, beside Embree 3.13 (`ROBUST`; packets of eight there, of sixteen here):
//!
//! | | primary, single | packets | diffuse, single | packets | shadow after a bounce, single | packets |
//! |---|---|---|---|---|---|---|
//! | instructions | 1430 | 533 | 1636 | 1584 | 773 | 908 |
//! | Embree | 1839 | 690 | 1919 | 1882 | 778 | 784 |
//! | mispredictions | 8.7 | 2.4 | 16.0 | 16.5 | 6.9 | 6.6 |
//! | Embree | 15.1 | 3.4 | 22.2 | 23.0 | 8.9 | 9.7 |
//! | cache misses | 0.5 | 0.6 | 7.0 | 7.4 | 4.9 | 5.6 |
//! | Embree | 0.7 | 0.7 | 7.0 | 7.1 | 4.8 | 4.9 |
//!
//! Mispredictions are most of an incoherent ray's time: how many boxes it enters, in which order, and which triangles
//! pass. They cannot be removed (below), only the visits that cause them. A packet of camera rays spends over half of
//! its time on triangles, a third of that on exact distances, which Embree does not compute: with AVX-512 that leaves it at
//! 0.92 to 0.96 of Embree's packets of sixteen. Beyond the caches random rays wait for memory, from 10^6
//! triangles on; scattered rays in the largest trees take turns (`traverse_interleaved`, `cargo bench --bench growth`).
//!
//! # Tried, and no faster
//!
//! * A cull of triangles by an f32 distance with a proven bound before the exact ones: 45 instructions on every
//!   triangle that passes cost more than they save, single rays -2 to -10 %, packets -3 to -12 %. Exact distances of a
//!   whole block take 95 instructions with AVX-512.
//! * Triangles of a block in the order of their boxes; all tests of a block before its exact distances; planes of a
//!   whole block for a packet: 0 to -8 %.
//! * Packets without the box test of each ray: -16 to -60 % where an interval holds a direction near 0.
//! * A shared top of the tree for closest hits: -1 to -11 %.
//! * Rays after a bounce sorted by direction in windows of 256 to 65,536: diffuse rays +1 to -28 %, shadow rays 0 to
//!   +13 % up to 4,096, for 30 ns a ray of sorting.
//! * Prefetching what is pushed: random rays +9 to +14 % at 10^7 triangles, all others -5 %. Huge pages: nothing.
//!   Rays in turn where the tree fits in the caches: -20 to -25 %.
//! * Boxes in a fixed order per octant, without any branch.
//! * Children pushed without a branch: a third slower, as the next box waits for the last.
//! * A sorting network in registers; distances in single precision with error bounds.
//! * Nodes and blocks of sixteen in AVX-512: -4 to +8 %.
//! * Spatial splits: diffuse rays in Sponza 1.25 times as fast, in two other scenes no faster, for a build that
//!   takes two to ten times as long.

mod brute_force;
mod build;
mod bvh;
mod clearance;
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
mod traverse_interleaved;
mod traverse_packet;
mod traverse_shared;
mod traverse_single;
mod triangle_block;
mod triangle_planes;
mod validate;
mod watertight;

pub use brute_force::{DISTANCE_TOLERANCE, disagreement, nearest_triangle};
pub use bvh::Bvh;
pub use clearance::ClearanceCone;
pub use query_state::QueryState;
pub use ray_packet::RayPacket;
pub use validate::BvhError;

#[cfg(any(test, fuzzing))]
mod fuzz;
#[cfg(fuzzing)]
pub use fuzz::check_scene_of;
#[cfg(test)]
mod setup_tests;
#[cfg(test)]
mod tests;
