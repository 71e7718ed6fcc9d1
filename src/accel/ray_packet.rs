//! Packets of up to sixteen rays, as a structure of arrays.

use super::ray_setup::RaySetup;
use crate::math::{NO_PRIMITIVE, Ray};
use crate::simd::{ALL_LANES, Floats, PACKET_WIDTH, SetBits, Simd};
use glam::Vec3;

/// Up to sixteen rays, coordinate by coordinate.
///
/// Inactive lanes must hold copies of active rays, as [`RayPacket::fill_inactive`] makes them.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct RayPacket {
    /// `origin[axis][lane]`.
    pub origin: [[f32; PACKET_WIDTH]; 3],
    /// `direction[axis][lane]`.
    pub direction: [[f32; PACKET_WIDTH]; 3],
    /// The ends of the rays' intervals.
    pub t_max: [f32; PACKET_WIDTH],
    /// What each ray cannot hit, or [`NO_PRIMITIVE`].
    pub exclude: [u32; PACKET_WIDTH],
    /// The mask of active lanes: a bit for each lane that holds a ray.
    pub active: u32,
}

impl RayPacket {
    /// No active lanes.
    pub const EMPTY: RayPacket = RayPacket {
        origin: [[0.0; PACKET_WIDTH]; 3],
        direction: [[0.0; PACKET_WIDTH]; 3],
        t_max: [0.0; PACKET_WIDTH],
        exclude: [NO_PRIMITIVE; PACKET_WIDTH],
        active: 0,
    };

    /// Packs one to sixteen rays.
    pub fn new(rays: &[Ray]) -> RayPacket {
        let mut packet = RayPacket::EMPTY;
        packet.active = (1 << rays.len()) - 1;
        let mut ray = &rays[0];
        for lane in 0..PACKET_WIDTH {
            ray = rays.get(lane).unwrap_or(ray);
            packet.set(lane, ray);
        }
        packet
    }

    /// As [`RayPacket::new`], of sixteen rays, by vectors.
    #[inline(always)]
    pub(super) fn of<S: Simd>(rays: &[Ray; PACKET_WIDTH]) -> RayPacket {
        // The words of a ray in the order of its fields; numbers of primitives pass unchanged.
        let [low, high]: &[[[f32; 8]; 8]; 2] = bytemuck::must_cast_ref(rays);
        let [ax, ay, az, au, av, aw, at, ae] = columns::<S>(low);
        let [bx, by, bz, bu, bv, bw, bt, be] = columns::<S>(high);
        RayPacket {
            origin: [
                S::join(ax, bx).store(),
                S::join(ay, by).store(),
                S::join(az, bz).store(),
            ],
            direction: [
                S::join(au, bu).store(),
                S::join(av, bv).store(),
                S::join(aw, bw).store(),
            ],
            t_max: S::join(at, bt).store(),
            exclude: S::join(ae, be).store().map(f32::to_bits),
            active: ALL_LANES,
        }
    }

    /// Puts a ray into the next lane of a packet that is filled lane by lane and not full.
    #[inline(always)]
    pub(super) fn push(&mut self, ray: &Ray) {
        let lane = self.active.count_ones() as usize % PACKET_WIDTH;
        self.set(lane, ray);
        self.active |= 1 << lane;
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

    /// Copies the first active ray into each inactive lane.
    pub fn fill_inactive(&mut self) {
        let first = self.ray(self.active.trailing_zeros() as usize % PACKET_WIDTH);
        for lane in SetBits(!self.active & ALL_LANES) {
            self.set(lane, &first);
        }
    }

    /// The active lanes.
    #[inline(always)]
    pub(crate) fn active_lanes(&self) -> SetBits {
        SetBits(self.active)
    }

    /// The active rays with their lanes.
    pub(super) fn active_rays(&self) -> impl Iterator<Item = (usize, Ray)> {
        self.active_lanes().map(|lane| (lane, self.ray(lane)))
    }

    /// What box and triangle tests need of the rays; `scene_magnitude` bounds the absolute coordinates of the
    /// scene.
    #[inline(always)]
    pub(super) fn setup<S: Simd>(&self, scene_magnitude: f32) -> RaySetup<PACKET_WIDTH> {
        let load = |[x, y, z]: &[[f32; PACKET_WIDTH]; 3]| {
            [S::F32x16::load(x), S::F32x16::load(y), S::F32x16::load(z)]
        };
        RaySetup::new(load(&self.origin), load(&self.direction), scene_magnitude)
    }

    /// The ray of a lane.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> Ray {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        Ray {
            origin: Vec3::new(ox[lane], oy[lane], oz[lane]),
            direction: Vec3::new(dx[lane], dy[lane], dz[lane]),
            t_max: self.t_max[lane],
            exclude: self.exclude[lane],
        }
    }
}

/// The columns of eight rows.
#[inline(always)]
fn columns<S: Simd>([a, b, c, d, e, f, g, h]: &[[f32; 8]; 8]) -> [S::F32x8; 8] {
    let load = S::F32x8::load;
    S::transpose([
        load(a),
        load(b),
        load(c),
        load(d),
        load(e),
        load(f),
        load(g),
        load(h),
    ])
}
