use super::PACKET;
use super::rounding::GROWTH;
use super::simd::Floats;
use super::watertight::{LEAST_SLOPE, ShearedRays, permuted_axes};
use crate::geometry::{Sphere, TrianglePlane};
use crate::math::{NO_PRIMITIVE, Ray};
use glam::{DVec3, Vec3};

/// Up to sixteen rays, coordinate by coordinate; lanes that hold none repeat one that does.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Packet {
    /// Axis by axis.
    pub(super) origin: [[f32; PACKET]; 3],
    pub(super) direction: [[f32; PACKET]; 3],
    pub(super) t_max: [f32; PACKET],
    pub(super) exclude: [u32; PACKET],
    /// A bit for each lane that holds a ray.
    pub(super) used: u32,
}

impl Packet {
    /// For rays to come.
    pub(super) const EMPTY: Packet = Packet {
        origin: [[0.0; PACKET]; 3],
        direction: [[0.0; PACKET]; 3],
        t_max: [0.0; PACKET],
        exclude: [NO_PRIMITIVE; PACKET],
        used: 0,
    };

    /// One to sixteen rays.
    #[inline(always)]
    pub(super) fn of(rays: &[Ray]) -> Packet {
        // All lanes at once, so that it becomes vector code.
        let mut packet = Packet::EMPTY;
        packet.used = (1 << rays.len()) - 1;
        let mut ray = &rays[0];
        for lane in 0..PACKET {
            ray = rays.get(lane).unwrap_or(ray);
            packet.set(lane, ray);
        }
        packet
    }

    /// Puts a ray into the next lane; those before are used. There is room for it.
    #[inline(always)]
    pub(super) fn push(&mut self, ray: &Ray) {
        let lane = self.used.count_ones() as usize % PACKET;
        self.set(lane, ray);
        self.used |= 1 << lane;
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.t_max[lane] = ray.t_max;
        self.exclude[lane] = ray.exclude;
    }

    /// Puts a copy of a ray into each lane that is not used.
    pub(super) fn fill(&mut self) {
        let first = self.ray(self.used.trailing_zeros() as usize % PACKET);
        for lane in Lanes(!self.used & ALL) {
            self.set(lane, &first);
        }
    }

    /// The lanes that hold rays.
    #[inline(always)]
    pub(super) fn lanes(&self) -> Lanes {
        Lanes(self.used)
    }

    /// The rays with their lanes.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (usize, Ray)> {
        self.lanes().map(|lane| (lane, self.ray(lane)))
    }

    /// One of the rays.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> Ray {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        Ray {
            origin: Vec3::new(ox[lane], oy[lane], oz[lane]),
            direction: Vec3::new(dx[lane], dy[lane], dz[lane]),
            t_max: self.t_max[lane],
            exclude: self.exclude[lane],
        }
    }
}

/// The numbers of bits that are set, rising.
pub(super) struct Lanes(pub(super) u32);

impl Iterator for Lanes {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize % PACKET;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

/// What triangles and spheres need of a packet whose rays have one main axis.
pub(super) struct RayLanes<'a, V> {
    pub(super) packet: &'a Packet,
    pub(super) origin: [V; 3],
    pub(super) direction: [V; 3],
    /// The largest coordinate of the start of each ray.
    pub(super) reach: V,
    /// Bounds all coordinates of the scene.
    pub(super) magnitude: f32,
    /// The order of axes, the main one last.
    pub(super) axes: [usize; 3],
    pub(super) sheared: ShearedRays<V>,
}

impl<V: Floats<PACKET>> RayLanes<'_, V> {
    /// None if the rays do not have the same main axis. `magnitude` bounds all coordinates of the scene.
    #[inline(always)]
    pub(super) fn new(packet: &Packet, magnitude: f32) -> Option<RayLanes<'_, V>> {
        let ([ox, oy, oz], [dx, dy, dz]) = (&packet.origin, &packet.direction);
        let origin = [V::load(ox), V::load(oy), V::load(oz)];
        let direction = [V::load(dx), V::load(dy), V::load(dz)];
        let (x, y, z) = (size(direction[0]), size(direction[1]), size(direction[2]));
        let mainly_x = y.le(x) & z.le(x);
        let mainly_y = !mainly_x & z.le(y) & ALL;
        if (mainly_x != 0 && mainly_x != ALL) || (mainly_y != 0 && mainly_y != ALL) {
            return None;
        }

        let axes @ [kx, ky, kz] = permuted_axes(packet.ray(0).direction);
        let reach = size(origin[0]).max(size(origin[1])).max(size(origin[2]));
        let growth = reach.add(V::splat(magnitude)).mul(V::splat(GROWTH));
        let stretch = V::splat(1.0).div(direction[kz]);
        let sheared = ShearedRays {
            origin: [origin[kx], origin[ky], origin[kz]],
            slopes: [
                direction[kx].div(direction[kz]).zero_below(LEAST_SLOPE),
                direction[ky].div(direction[kz]).zero_below(LEAST_SLOPE),
            ],
            stretch,
            slack: growth.mul(size(stretch)),
        };
        Some(RayLanes {
            packet,
            origin,
            direction,
            reach,
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
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.packet.origin, &self.packet.direction);
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
        let ray = self.packet.ray(i);
        (ray.origin.as_dvec3(), ray.direction.as_dvec3())
    }
}

/// A bit for each lane.
pub(super) const ALL: u32 = (1 << PACKET) - 1;

#[inline(always)]
pub(super) fn size<V: Floats<PACKET>>(lanes: V) -> V {
    lanes.max(V::splat(0.0).sub(lanes))
}
