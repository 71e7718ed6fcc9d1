//! Points on surfaces that rays leave, one by one and in packets.

use crate::math::{NO_PRIMITIVE, Ray};
use crate::simd::PACKET_WIDTH;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A point of a surface, on one side of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfacePoint {
    /// Relative to the scene's origin.
    pub position: Vec3,
    /// The unit normal of the shape, on the side where rays leave.
    pub geometric_normal: Vec3,
    /// The unit normal for shading, on the same side.
    pub shading_normal: Vec3,
    /// The distance along the geometric normal at which rays start: it bounds the rounding error of the
    /// position, so that they do not hit the surface that they leave.
    pub offset: f32,
    /// The primitive that they cannot hit, or [`NO_PRIMITIVE`].
    pub exclude: u32,
}

impl SurfacePoint {
    /// Where rays leave the surface.
    #[inline]
    pub fn spawn_origin(&self) -> Vec3 {
        self.position + self.geometric_normal * self.offset
    }

    /// An endless ray that leaves the surface.
    #[inline]
    pub fn spawn_ray(&self, direction: Vec3) -> Ray {
        Ray {
            origin: self.spawn_origin(),
            direction,
            t_max: f32::INFINITY,
            exclude: self.exclude,
        }
    }
}

/// Up to sixteen surface points, coordinate by coordinate.
#[derive(Debug)]
#[repr(align(64))]
pub struct SurfacePointPacket {
    pub(super) position: [[f32; PACKET_WIDTH]; 3],
    pub(super) geometric_normal: [[f32; PACKET_WIDTH]; 3],
    pub(super) shading_normal: [[f32; PACKET_WIDTH]; 3],
    pub(super) offset: [f32; PACKET_WIDTH],
    pub(super) exclude: [u32; PACKET_WIDTH],
    pub(super) count: usize,
}

impl Default for SurfacePointPacket {
    fn default() -> SurfacePointPacket {
        SurfacePointPacket {
            position: [[0.0; PACKET_WIDTH]; 3],
            geometric_normal: [[0.0; PACKET_WIDTH]; 3],
            shading_normal: [[0.0; PACKET_WIDTH]; 3],
            offset: [0.0; PACKET_WIDTH],
            exclude: [NO_PRIMITIVE; PACKET_WIDTH],
            count: 0,
        }
    }
}

impl SurfacePointPacket {
    /// Adds a point in the next lane. The packet is not full.
    #[inline]
    pub fn push(&mut self, point: &SurfacePoint) {
        let lane = self.count;
        for axis in 0..3 {
            self.position[axis][lane] = point.position[axis];
            self.geometric_normal[axis][lane] = point.geometric_normal[axis];
            self.shading_normal[axis][lane] = point.shading_normal[axis];
        }
        self.offset[lane] = point.offset;
        self.exclude[lane] = point.exclude;
        self.count += 1;
    }
}
