use super::node::GROWTH;
use super::packet::PACKET;
use super::simd::Floats;
use super::watertight::{LEAST_SLOPE, ShearedRays, permuted_axes};
use crate::geometry::{Sphere, TrianglePlane};
use crate::math::Ray;
use glam::DVec3;

/// Up to sixteen rays with one main axis, one in each lane; lanes that are not needed repeat the last.
pub(super) struct RayLanes<V> {
    /// Axis by axis.
    pub(super) origin: [[f32; PACKET]; 3],
    pub(super) direction: [[f32; PACKET]; 3],
    /// The largest coordinates of each ray and the scene.
    pub(super) reach: [f32; PACKET],
    /// Bounds all coordinates of the scene.
    pub(super) magnitude: f32,
    /// The order of axes, the main one last.
    pub(super) axes: [usize; 3],
    pub(super) sheared: ShearedRays<V>,
}

impl<V: Floats<PACKET>> RayLanes<V> {
    /// None if the rays do not have the same main axis. `magnitude` bounds all coordinates of the scene.
    #[inline(always)]
    pub(super) fn new(rays: &[Ray], magnitude: f32) -> Option<RayLanes<V>> {
        let (mut origins, mut directions) = ([[0.0; PACKET]; 3], [[0.0; PACKET]; 3]);
        let mut ray = &rays[0];
        for lane in 0..PACKET {
            ray = rays.get(lane).unwrap_or(ray);
            for axis in 0..3 {
                origins[axis][lane] = ray.origin[axis];
                directions[axis][lane] = ray.direction[axis];
            }
        }
        let ([ox, oy, oz], [dx, dy, dz]) = (&origins, &directions);
        let origin = [V::load(ox), V::load(oy), V::load(oz)];
        let direction = [V::load(dx), V::load(dy), V::load(dz)];
        let (x, y, z) = (size(direction[0]), size(direction[1]), size(direction[2]));
        let mainly_x = y.le(x) & z.le(x);
        let mainly_y = !mainly_x & z.le(y) & ALL;
        if (mainly_x != 0 && mainly_x != ALL) || (mainly_y != 0 && mainly_y != ALL) {
            return None;
        }

        let axes @ [kx, ky, kz] = permuted_axes(rays[0].direction);
        let reach = size(origin[0]).max(size(origin[1])).max(size(origin[2]));
        let reach = reach.add(V::splat(magnitude));
        let stretch = V::splat(1.0).div(direction[kz]);
        let sheared = ShearedRays {
            origin: [origin[kx], origin[ky], origin[kz]],
            slopes: [
                direction[kx].div(direction[kz]).zero_below(LEAST_SLOPE),
                direction[ky].div(direction[kz]).zero_below(LEAST_SLOPE),
            ],
            stretch,
            slack: reach.mul(V::splat(GROWTH)).mul(size(stretch)),
        };
        Some(RayLanes {
            reach: reach.store(),
            origin: origins,
            direction: directions,
            magnitude,
            axes,
            sheared,
        })
    }

    /// Where each meets the triangle's plane, and how far that is outside its box.
    #[inline(always)]
    pub(super) fn meet(&self, triangle: &TrianglePlane) -> ([f64; PACKET], [f64; PACKET]) {
        let (mut distances, mut outside) = ([0.0; PACKET], [0.0; PACKET]);
        for i in 0..PACKET {
            (distances[i], outside[i]) = self.meet_one(triangle, i);
        }
        (distances, outside)
    }

    /// As [`RayLanes::meet`], for one ray.
    #[inline(always)]
    pub(super) fn meet_one(&self, triangle: &TrianglePlane, i: usize) -> (f64, f64) {
        let (origin, direction) = self.line(i);
        let t = triangle.distance(origin, direction);
        (t, triangle.outside(origin + t * direction))
    }

    /// A bit for each ray whose line passes through the sphere.
    #[inline(always)]
    pub(super) fn pass_through(&self, sphere: &Sphere) -> u32 {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        let mut passed_by = [0_u32; PACKET];
        for i in 0..PACKET {
            let origin = [ox[i].into(), oy[i].into(), oz[i].into()];
            let direction = [dx[i].into(), dy[i].into(), dz[i].into()];
            passed_by[i] = u32::from(sphere.depth(origin, direction) < 0.0);
        }
        let mut lanes = 0;
        for (i, passed_by) in passed_by.into_iter().enumerate() {
            lanes |= (1 - passed_by) << i;
        }
        lanes
    }

    /// The origin and the direction of one.
    #[inline(always)]
    pub(super) fn line(&self, i: usize) -> (DVec3, DVec3) {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        (
            DVec3::new(ox[i].into(), oy[i].into(), oz[i].into()),
            DVec3::new(dx[i].into(), dy[i].into(), dz[i].into()),
        )
    }
}

/// A bit for each lane.
pub(super) const ALL: u32 = (1 << PACKET) - 1;

#[inline(always)]
pub(super) fn size<V: Floats<PACKET>>(lanes: V) -> V {
    lanes.max(V::splat(0.0).sub(lanes))
}
