//! A packet loaded into vectors for tests against triangles and spheres.

use super::constants::WIDTH;
use super::ray_packet::RayPacket;
use super::ray_setup::RaySetup;
use super::rounding::triangle_padding;
use super::triangle_planes::TrianglePlanes;
use super::watertight::ShearedRays;
use crate::geometry::Sphere;
use crate::simd::{Doubles, Floats, PACKET_WIDTH, ScalarDouble, Simd};

/// What triangle and sphere tests need of a packet whose rays share the permutation of their axes.
pub(super) struct PacketIntersector<'a, S: Simd> {
    pub(super) packet: &'a RayPacket,
    pub(super) setup: &'a RaySetup<PACKET_WIDTH>,
    pub(super) axes: [usize; 3],
    pub(super) sheared: ShearedRays<S::F32x16>,
}

impl<S: Simd> PacketIntersector<'_, S> {
    #[inline(always)]
    pub(super) fn new<'a>(
        packet: &'a RayPacket,
        setup: &'a RaySetup<PACKET_WIDTH>,
    ) -> PacketIntersector<'a, S> {
        PacketIntersector {
            packet,
            setup,
            axes: setup.axes(0),
            sheared: ShearedRays::load(setup),
        }
    }

    /// Where the rays of a mask meet the triangle's plane; and which of them are there inside the triangle's box.
    /// Those of other rays mean nothing.
    #[inline(always)]
    pub(super) fn intersect_plane(
        &self,
        triangle: &TrianglePlanes<ScalarDouble>,
        rays: u32,
    ) -> ([f64; PACKET_WIDTH], u32) {
        let triangles = triangle.splat::<S::F64x8, WIDTH>();
        let (mut distances, mut inside) = ([0.0; PACKET_WIDTH], 0);
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.packet.origin, &self.packet.direction);
        for first in [0, WIDTH] {
            if rays >> first & 0xff == 0 {
                continue;
            }
            let half = |lanes: &[f32; PACKET_WIDTH]| {
                S::F64x8::widen(S::F32x8::load(&lanes.as_chunks::<WIDTH>().0[first / WIDTH]))
            };
            let (origin, direction) = ([half(ox), half(oy), half(oz)], [half(dx), half(dy), half(dz)]);
            let (t, outside) = triangles.intersect(origin, direction);
            let padding = half(&self.setup.origin_magnitude).mul(S::F64x8::splat(triangle_padding(1.0)));
            distances[first..first + WIDTH].copy_from_slice(&t.store());
            inside |= outside.le(padding) << first;
        }
        (distances, inside)
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
}
