//! A packet loaded into vectors for tests against triangles and spheres.

use super::constants::WIDTH;
use super::ray_packet::RayPacket;
use super::ray_setup::RaySetup;
use super::rounding::TRIANGLE_PADDING;
use super::triangle_planes::{TrianglePlanes, clamp_to_box};
use super::watertight::ShearedRays;
use crate::geometry::Sphere;
use crate::simd::{Doubles, Floats, PACKET_WIDTH, ScalarDouble, SetBits, Simd};
use glam::Vec3;

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

    /// The distances at which half of the rays hit a triangle, of those that [`ShearedRays::intersect`] lets pass:
    /// as [`TriangleBlock::intersect`](super::triangle_block::TriangleBlock::intersect) finds them.
    #[inline(always)]
    pub(super) fn distances(
        &self,
        plane: &TrianglePlanes<ScalarDouble>,
        vertices: [Vec3; 3],
        half: usize,
        passed: u32,
    ) -> S::F64x8 {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.packet.origin, &self.packet.direction);
        let origin = [
            load::<S>(ox, half),
            load::<S>(oy, half),
            load::<S>(oz, half),
        ];
        let direction = [
            load::<S>(dx, half),
            load::<S>(dy, half),
            load::<S>(dz, half),
        ];
        let (t, outside) = plane.splat().intersect(origin, direction);
        let magnitude = load::<S>(&self.setup.origin_magnitude, half);
        let padding = magnitude.mul(S::F64x8::splat(TRIANGLE_PADDING));
        // Not where that is NaN.
        let unsure = passed & !outside.le(padding);
        if unsure == 0 {
            return t;
        }
        let mut distances = t.store();
        for lane in SetBits(unsure) {
            let ray = self.packet.ray(half * WIDTH + lane);
            distances[lane] = clamp_to_box(&ray, vertices, distances[lane]);
        }
        S::F64x8::load(&distances)
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
