//! The results of a packet query while it traverses the tree.

use super::bvh::Bvh;
use super::constants::WIDTH;
use super::hit_filter::{DISTANCE_PADDING, accept_hit};
use super::node::ROOT;
use super::packet_intersector::PacketIntersector;
use super::ray_packet::RayPacket;
use super::single_ray::SingleRay;
use super::stack::Stack;
use super::traverse_single::traverse;
use super::triangle_block::TriangleBlock;
use super::triangle_planes::TrianglePlanes;
use crate::geometry::{Hit, Sphere};
use crate::simd::{Doubles, Floats, PACKET_WIDTH, Scalar, SetBits, Simd};

/// The hits of a packet, and the distance up to which each ray still looks: negative if it is done.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct PacketHits {
    distances: [f64; PACKET_WIDTH],
    primitives: [u32; PACKET_WIDTH],
    pub(super) limits: [f32; PACKET_WIDTH],
}

impl PacketHits {
    #[inline(always)]
    pub(super) fn new<const ANY_HIT: bool>(active: u32, t_max: &[f32; PACKET_WIDTH]) -> PacketHits {
        let mut hits = PacketHits {
            distances: [Hit::MISS.t; PACKET_WIDTH],
            primitives: [Hit::MISS.primitive; PACKET_WIDTH],
            limits: [f32::INFINITY; PACKET_WIDTH],
        };
        for (lane, limit) in hits.limits.iter_mut().enumerate() {
            if active >> lane & 1 == 0 {
                *limit = -1.0;
            } else if ANY_HIT {
                // -1 for NaN, which would hide other rays' limits in the largest.
                *limit = (t_max[lane] * DISTANCE_PADDING).max(-1.0);
            }
        }
        hits
    }

    /// The hit of a ray, or, of a query for any, one of them; [`Hit::MISS`] for none.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize) -> Hit {
        Hit {
            t: self.distances[lane],
            primitive: self.primitives[lane],
        }
    }

    #[inline(always)]
    fn set_hit<const ANY_HIT: bool>(&mut self, lane: usize, hit: Hit) {
        self.distances[lane] = hit.t;
        self.primitives[lane] = hit.primitive;
        self.limits[lane] = match ANY_HIT {
            true => -1.0,
            false => hit.t as f32 * DISTANCE_PADDING,
        };
    }

    /// The largest limit of all rays; negative if all are done.
    #[inline(always)]
    pub(super) fn max_limit<S: Simd>(&self) -> f32 {
        S::F32x16::load(&self.limits).reduce_max()
    }

    /// Takes over what a query made of a ray's hit; returns whether that is another one.
    #[inline(always)]
    pub(super) fn update<const ANY_HIT: bool>(&mut self, lane: usize, best: Hit) -> bool {
        let is_better = best != self.hit(lane);
        if is_better {
            self.set_hit::<ANY_HIT>(lane, best);
        }
        is_better
    }

    /// Traverses the tree by the active rays, one after the other.
    #[inline(always)]
    pub(super) fn traverse_by_ray<S: Simd, const ANY_HIT: bool>(
        &mut self,
        bvh: &Bvh,
        rays: &PacketIntersector<'_, S>,
        stack: &mut Stack,
    ) {
        for lane in rays.packet.active_lanes() {
            let ray = &rays.packet.ray(lane);
            let ray = SingleRay::<S>::new(ray, rays.setup, lane);
            let mut best = self.hit(lane);
            stack.clear();
            traverse::<S, ANY_HIT>(bvh, &ray, ROOT, stack, &mut best);
            self.update::<ANY_HIT>(lane, best);
        }
    }

    /// Intersects the rays of a mask with a sphere.
    #[inline(always)]
    pub(super) fn intersect_sphere<S: Simd, const ANY_HIT: bool>(
        &mut self,
        sphere: &Sphere,
        primitive: u32,
        rays: &PacketIntersector<'_, S>,
        active: u32,
    ) {
        let active = active & rays.lines_through(sphere);
        for lane in SetBits(active) {
            let ray = rays.packet.ray(lane);
            if let Some(t) = sphere.intersect(&ray) {
                let mut best = self.hit(lane);
                accept_hit::<ANY_HIT>(&ray, t, primitive, &mut best);
                self.update::<ANY_HIT>(lane, best);
            }
        }
    }

    /// Intersects the rays of a mask with the triangles of a mask, one triangle after the other; returns
    /// whether a limit may have changed.
    #[inline(always)]
    pub(super) fn intersect_block<S: Simd, const ANY_HIT: bool>(
        &mut self,
        block: &TriangleBlock,
        mut triangles: u32,
        rays: &PacketIntersector<'_, S>,
        active: u32,
    ) -> bool {
        let mut changed = false;
        let depth_error = S::F32x16::load(&rays.setup.depth_error);
        while triangles != 0 {
            let triangle = triangles.trailing_zeros() as usize % WIDTH;
            triangles &= triangles - 1;
            let primitive = block.ids()[triangle];
            let vertices = block.splat_triangle::<S::F32x16, PACKET_WIDTH>(triangle, rays.axes);
            let limits = S::F32x16::load(&self.limits).add(depth_error);
            let passed = active & rays.sheared.intersect(&vertices, limits);
            if passed == 0 {
                continue;
            }
            changed = true;
            let vertices = block.splat_triangle::<Scalar, 1>(triangle, [0, 1, 2]);
            let plane = TrianglePlanes::through(vertices);
            for half in [0, 1] {
                let passed = passed >> (half * WIDTH) & 0xff;
                if passed == 0 {
                    continue;
                }
                let t = rays.distances(&plane, block.triangle(triangle), half, passed);
                let accepted =
                    passed & self.accepted::<S, ANY_HIT>(rays.packet, half, t, primitive);
                let distances = t.store();
                for lane in SetBits(accepted) {
                    let (t, lane) = (distances[lane], half * WIDTH + lane);
                    if primitive != rays.packet.exclude[lane] {
                        self.set_hit::<ANY_HIT>(lane, Hit { t, primitive });
                    }
                }
            }
        }
        changed
    }

    /// As [`accept_hit`], for half of a packet: the mask of rays whose query accepts a primitive at `t` but for what
    /// they exclude.
    #[inline(always)]
    fn accepted<S: Simd, const ANY_HIT: bool>(
        &self,
        packet: &RayPacket,
        half: usize,
        t: S::F64x8,
        primitive: u32,
    ) -> u32 {
        let positive = S::F64x8::splat(0.0).lt(t);
        if ANY_HIT {
            let t_max = S::F64x8::widen(S::F32x8::load(&packet.t_max.as_chunks().0[half]));
            return positive & t.lt(t_max);
        }
        let best = S::F64x8::load(&self.distances.as_chunks().0[half]);
        let (rounded, best_rounded) = (t.round_for_order(), best.round_for_order());
        let mut accepted = rounded.lt(best_rounded);
        let same = rounded.le(best_rounded) & !accepted;
        for lane in SetBits(same & positive) {
            let is_lower = primitive < self.primitives[half * WIDTH + lane];
            accepted |= u32::from(is_lower) << lane;
        }
        accepted & positive
    }

    /// As [`PacketHits::intersect_block`], with all triangles, one ray after the other.
    #[inline(always)]
    pub(super) fn intersect_block_by_ray<S: Simd, const ANY_HIT: bool>(
        &mut self,
        block: &TriangleBlock,
        rays: &PacketIntersector<'_, S>,
        active: u32,
    ) -> bool {
        let mut changed = false;
        for lane in SetBits(active) {
            let ray = &rays.packet.ray(lane);
            if self.limits[lane] < 0.0 {
                continue;
            }
            let ray = SingleRay::<S>::new(ray, rays.setup, lane);
            let mut best = self.hit(lane);
            block.intersect::<S, ANY_HIT>(&ray, &mut best);
            changed |= self.update::<ANY_HIT>(lane, best);
        }
        changed
    }
}
