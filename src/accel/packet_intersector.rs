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

    /// Where half of the rays meet the triangle's plane, and the mask of those that are there inside the
    /// triangle's box.
    #[inline(always)]
    pub(super) fn intersect_plane(
        &self,
        triangle: &TrianglePlanes<ScalarDouble>,
        half: usize,
    ) -> (S::F64x8, u32) {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.packet.origin, &self.packet.direction);
        let (origin, direction) = (
            [
                load::<S>(ox, half),
                load::<S>(oy, half),
                load::<S>(oz, half),
            ],
            [
                load::<S>(dx, half),
                load::<S>(dy, half),
                load::<S>(dz, half),
            ],
        );
        let (t, outside) = triangle
            .splat::<S::F64x8, WIDTH>()
            .intersect(origin, direction);
        let magnitude = load::<S>(&self.setup.origin_magnitude, half);
        (
            t,
            outside.le(magnitude.mul(S::F64x8::splat(triangle_padding(1.0)))),
        )
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

/// Half of the lanes.
#[inline(always)]
fn load<S: Simd>(lanes: &[f32; PACKET_WIDTH], half: usize) -> S::F64x8 {
    S::F64x8::widen(S::F32x8::load(&lanes.as_chunks().0[half]))
}
