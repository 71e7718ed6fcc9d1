//! Shadow rays: from points of surfaces to one light.

use super::PACKET;
use super::lanes::{ALL, Lanes, Packet, size};
use super::simd::Floats;
use crate::math::{NO_PRIMITIVE, Ray};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A point of a surface that rays leave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Where it is.
    pub position: Vec3,
    /// The unit normal of the shape, on the side where rays leave.
    pub geometric_normal: Vec3,
    /// The unit normal for shading, on the same side.
    pub shading_normal: Vec3,
    /// How far rays start from the point along the geometric normal.
    pub offset: f32,
    /// What they cannot hit, or [`NO_PRIMITIVE`].
    pub exclude: u32,
}

impl Point {
    /// A ray that leaves.
    #[inline]
    pub fn leave(&self, direction: Vec3) -> Ray {
        Ray {
            origin: self.position + self.geometric_normal * self.offset,
            direction,
            t_max: f32::INFINITY,
            exclude: self.exclude,
        }
    }
}

/// Up to sixteen points, coordinate by coordinate.
#[derive(Debug)]
#[repr(align(64))]
pub struct Points {
    position: [[f32; PACKET]; 3],
    geometric_normal: [[f32; PACKET]; 3],
    shading_normal: [[f32; PACKET]; 3],
    offset: [f32; PACKET],
    exclude: [u32; PACKET],
    count: usize,
}

impl Default for Points {
    fn default() -> Points {
        Points {
            position: [[0.0; PACKET]; 3],
            geometric_normal: [[0.0; PACKET]; 3],
            shading_normal: [[0.0; PACKET]; 3],
            offset: [0.0; PACKET],
            exclude: [NO_PRIMITIVE; PACKET],
            count: 0,
        }
    }
}

impl Points {
    /// Adds a point in the next lane. There is room for it.
    #[inline]
    pub fn push(&mut self, point: &Point) {
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

/// How points see a target if nothing is in the way.
#[derive(Debug)]
pub struct Sight {
    /// A ray from each point that faces the target. It stops short of the target by the rounding of
    /// its two ends, so a light on a surface lights the surface's own side.
    pub(super) rays: Packet,
    distance: [f32; PACKET],
    cosine: [f32; PACKET],
}

impl Sight {
    /// A bit for each point that has the target before its shape and before its shading normal, and is
    /// not there.
    pub fn facing(&self) -> u32 {
        self.rays.used
    }

    /// The lanes of the points that see the target, given those of which something is in the way.
    #[inline]
    pub fn clear(&self, occluded: u32) -> impl Iterator<Item = usize> + use<> {
        Lanes(self.facing() & !occluded)
    }

    /// The unit direction from a point that faces the target.
    #[inline]
    pub fn direction(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.rays.direction;
        Vec3::new(x[lane], y[lane], z[lane])
    }

    /// How far the target is from a point.
    #[inline]
    pub fn distance(&self, lane: usize) -> f32 {
        self.distance[lane]
    }

    /// The cosine of the angle between the target and a point's geometric normal.
    #[inline]
    pub fn cosine(&self, lane: usize) -> f32 {
        self.cosine[lane]
    }
}

/// How `points` see `target`.
#[inline(always)]
pub(super) fn look<V: Floats<PACKET>>(points: &Points, target: Vec3) -> Sight {
    let mut sight = Sight {
        rays: Packet::EMPTY,
        distance: [0.0; PACKET],
        cosine: [0.0; PACKET],
    };
    let zero = V::splat(0.0);
    let offset = V::load(&points.offset);
    let mut to_target = [zero; 3];
    let (mut height, mut lean, mut squared) = (zero, zero, zero);
    let mut largest = V::splat(target.abs().max_element());
    for axis in 0..3 {
        let position = V::load(&points.position[axis]);
        let normal = V::load(&points.geometric_normal[axis]);
        let way = V::splat(target[axis]).sub(position);
        to_target[axis] = way;
        height = height.add(way.mul(normal));
        lean = lean.add(way.mul(V::load(&points.shading_normal[axis])));
        squared = squared.add(way.mul(way));
        largest = largest.max(size(position));
        sight.rays.origin[axis] = position.add(normal.mul(offset)).store();
    }
    let distance = squared.sqrt();
    for (direction, way) in sight.rays.direction.iter_mut().zip(to_target) {
        *direction = way.div(distance).store();
    }
    let rounding = largest.mul(V::splat(4.0 * f32::EPSILON));
    sight.rays.t_max = distance.sub(offset).sub(rounding).max(zero).store();
    sight.rays.exclude = points.exclude;
    let facing = zero.lt(height) & zero.lt(lean) & zero.lt(distance);
    sight.rays.used = facing & ((1 << points.count) - 1);
    if sight.rays.used != ALL {
        sight.rays.fill();
    }
    sight.distance = distance.store();
    sight.cosine = height.div(distance).store();
    sight
}
