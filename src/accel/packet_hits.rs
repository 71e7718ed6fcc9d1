//! The results of a packet query while it traverses the tree.

use super::constants::WIDTH;
use super::hit_filter::{DISTANCE_PADDING, accept_hit};
use super::packet_intersector::PacketIntersector;
use super::ray_packet::RayPacket;
use super::single_ray::SingleRay;
use super::triangle_block::TriangleBlock;
use super::triangle_planes::{TrianglePlanes, clamp_to_box};
use crate::geometry::{Hit, Sphere};
use crate::math::Ray;
use crate::simd::{Floats, PACKET_WIDTH, Scalar, SetBits, Simd};

/// The hits of a packet, and the distance up to which each ray still looks: negative if it is done.
pub(super) struct PacketHits {
    pub(super) best: [Hit; PACKET_WIDTH],
    pub(super) limits: [f32; PACKET_WIDTH],
}

impl PacketHits {
    #[inline(always)]
    pub(super) fn new<const ANY_HIT: bool>(packet: &RayPacket) -> PacketHits {
        let mut hits = PacketHits {
            best: [Hit::MISS; PACKET_WIDTH],
            limits: [f32::MAX; PACKET_WIDTH],
        };
        for (lane, limit) in hits.limits.iter_mut().enumerate() {
            if packet.active >> lane & 1 == 0 {
                *limit = -1.0;
            } else if ANY_HIT {
                *limit = packet.t_max[lane] * DISTANCE_PADDING;
            }
        }
        hits
    }

    /// The largest limit of all rays; negative if all are done.
    #[inline(always)]
    pub(super) fn max_limit<S: Simd>(&self) -> f32 {
        S::F32x16::load(&self.limits).reduce_max()
    }

    #[inline(always)]
    fn accept_hit<const ANY_HIT: bool>(&mut self, ray: &Ray, lane: usize, t: f64, primitive: u32) {
        if accept_hit::<ANY_HIT>(ray, t, primitive, &mut self.best[lane]) {
            self.limits[lane] = -1.0;
        } else if !ANY_HIT {
            self.limits[lane] = self.best[lane].t as f32 * DISTANCE_PADDING;
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
                self.accept_hit::<ANY_HIT>(&ray, lane, t, primitive);
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
        while triangles != 0 {
            let triangle = triangles.trailing_zeros() as usize % WIDTH;
            triangles &= triangles - 1;
            let primitive = block.ids()[triangle];
            let vertices = block.splat_triangle::<S::F32x16, PACKET_WIDTH>(triangle, rays.axes);
            let limits = S::F32x16::load(&self.limits);
            let passed = active & rays.sheared.intersect(&vertices, limits);
            if passed == 0 {
                continue;
            }
            changed = true;
            let vertices = block.splat_triangle::<Scalar, 1>(triangle, [0, 1, 2]);
            let plane = TrianglePlanes::through(vertices);
            let (mut distances, inside) = rays.intersect_plane(&plane, passed);
            for lane in SetBits(passed & !inside) {
                let (ray, vertices) = (rays.packet.ray(lane), block.triangle(triangle));
                distances[lane] = clamp_to_box(&ray, vertices, distances[lane]);
            }
            for lane in SetBits(passed) {
                let ray = rays.packet.ray(lane);
                self.accept_hit::<ANY_HIT>(&ray, lane, distances[lane], primitive);
            }
        }
        changed
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
            let before = self.best[lane];
            if block.intersect::<S, ANY_HIT>(&ray, &mut self.best[lane]) {
                self.limits[lane] = -1.0;
            } else if !ANY_HIT {
                self.limits[lane] = self.best[lane].t as f32 * DISTANCE_PADDING;
            }
            changed |= before != self.best[lane];
        }
        changed
    }
}
