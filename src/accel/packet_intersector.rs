//! A packet loaded into vectors for tests against triangles and spheres.

use super::ray_packet::RayPacket;
use super::rounding::BOX_PADDING;
use super::watertight::{MIN_SLOPE, ShearedRays, permuted_axes};
use crate::geometry::{Sphere, TrianglePlane};
use crate::simd::{ALL_LANES, Floats, PACKET_WIDTH};
use glam::DVec3;

/// What triangle and sphere tests need of a packet whose rays share their major axis.
pub(super) struct PacketIntersector<'a, V> {
    pub(super) packet: &'a RayPacket,
    pub(super) origin: [V; 3],
    pub(super) direction: [V; 3],
    /// The largest absolute coordinate of each ray's origin.
    pub(super) origin_magnitude: V,
    /// Bounds the absolute coordinates of the scene.
    pub(super) scene_magnitude: f32,
    /// The permutation of the axes, the major one last.
    pub(super) axes: [usize; 3],
    pub(super) sheared: ShearedRays<V>,
}

impl<V: Floats<PACKET_WIDTH>> PacketIntersector<'_, V> {
    /// None if the rays do not share their major axis.
    #[inline(always)]
    pub(super) fn new(
        packet: &RayPacket,
        scene_magnitude: f32,
    ) -> Option<PacketIntersector<'_, V>> {
        let ([ox, oy, oz], [dx, dy, dz]) = (&packet.origin, &packet.direction);
        let origin = [V::load(ox), V::load(oy), V::load(oz)];
        let direction = [V::load(dx), V::load(dy), V::load(dz)];
        let (x, y, z) = (direction[0].abs(), direction[1].abs(), direction[2].abs());
        let mainly_x = y.le(x) & z.le(x);
        let mainly_y = !mainly_x & z.le(y) & ALL_LANES;
        if (mainly_x != 0 && mainly_x != ALL_LANES) || (mainly_y != 0 && mainly_y != ALL_LANES) {
            return None;
        }

        let axes @ [kx, ky, kz] = permuted_axes(packet.ray(0).direction);
        let origin_magnitude = origin[0].abs().max(origin[1].abs()).max(origin[2].abs());
        let padding = origin_magnitude
            .add(V::splat(scene_magnitude))
            .mul(V::splat(BOX_PADDING));
        let inv_dz = V::splat(1.0).div(direction[kz]);
        let sheared = ShearedRays {
            origin: [origin[kx], origin[ky], origin[kz]],
            slopes: [
                direction[kx].div(direction[kz]).zero_below(MIN_SLOPE),
                direction[ky].div(direction[kz]).zero_below(MIN_SLOPE),
            ],
            inv_dz,
            depth_error: padding.mul(inv_dz.abs()),
        };
        Some(PacketIntersector {
            packet,
            origin,
            direction,
            origin_magnitude,
            scene_magnitude,
            axes,
            sheared,
        })
    }

    /// Where each ray meets the triangle's plane, and how far that is outside the triangle's box.
    #[inline(always)]
    pub(super) fn intersect_planes(
        &self,
        triangle: &TrianglePlane,
    ) -> ([f64; PACKET_WIDTH], [f64; PACKET_WIDTH]) {
        let (mut distances, mut outside) = ([0.0; PACKET_WIDTH], [0.0; PACKET_WIDTH]);
        for i in 0..PACKET_WIDTH {
            (distances[i], outside[i]) = self.intersect_plane(triangle, i);
        }
        (distances, outside)
    }

    /// As [`PacketIntersector::intersect_planes`], for one ray.
    #[inline(always)]
    pub(super) fn intersect_plane(&self, triangle: &TrianglePlane, lane: usize) -> (f64, f64) {
        let (origin, direction) = self.line(lane);
        let t = triangle.ray_parameter(origin, direction);
        (t, triangle.distance_outside_box(origin + t * direction))
    }

    /// The mask of rays whose lines pass through the sphere.
    #[inline(always)]
    pub(super) fn lines_through(&self, sphere: &Sphere) -> u32 {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.packet.origin, &self.packet.direction);
        let mut misses = [0_u32; PACKET_WIDTH];
        for i in 0..PACKET_WIDTH {
            let origin = [ox[i].into(), oy[i].into(), oz[i].into()];
            let direction = [dx[i].into(), dy[i].into(), dz[i].into()];
            misses[i] = u32::from(sphere.depth(origin, direction) < 0.0);
        }
        let mut lanes = 0;
        for (i, misses) in misses.into_iter().enumerate() {
            lanes |= (1 - misses) << i;
        }
        lanes
    }

    /// The origin and the direction of a ray, in double precision.
    #[inline(always)]
    pub(super) fn line(&self, lane: usize) -> (DVec3, DVec3) {
        let ray = self.packet.ray(lane);
        (ray.origin.as_dvec3(), ray.direction.as_dvec3())
    }
}
