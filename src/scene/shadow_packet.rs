//! Shadow rays from a packet of surface points to one light.

use super::surface_point::SurfacePointPacket;
use crate::accel::RayPacket;
use crate::simd::{ALL_LANES, Floats, Kernel, PACKET_WIDTH, SetBits, Simd, WithSimd};
use glam::Vec3;

/// Shadow rays from surface points to a target, with what lighting needs of each.
#[derive(Debug)]
pub struct ShadowPacket {
    /// A ray from each point that faces the target. It stops short of the target by the rounding of
    /// its two ends, so a light on a surface lights the surface's own side.
    pub(super) rays: RayPacket,
    distance: [f32; PACKET_WIDTH],
    cosine: [f32; PACKET_WIDTH],
}

impl ShadowPacket {
    /// The mask of points that have the target in front of their shape and of their shading normal, and do
    /// not coincide with it.
    pub fn facing(&self) -> u32 {
        self.rays.active
    }

    /// The lanes of the points that see the target, given the mask of occluded rays.
    #[inline(always)]
    pub fn unoccluded(&self, occluded: u32) -> impl Iterator<Item = usize> + use<> {
        SetBits(self.facing() & !occluded)
    }

    /// The unit direction from a point that faces the target.
    #[inline(always)]
    pub fn direction(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.rays.direction;
        Vec3::new(x[lane], y[lane], z[lane])
    }

    /// The distance from a point to the target.
    #[inline(always)]
    pub fn distance(&self, lane: usize) -> f32 {
        self.distance[lane]
    }

    /// The cosine of the angle between the direction to the target and a point's geometric normal.
    #[inline(always)]
    pub fn cosine(&self, lane: usize) -> f32 {
        self.cosine[lane]
    }
}

impl SurfacePointPacket {
    /// The shadow rays to a target.
    pub(super) fn shadow_rays_to(&self, target: Vec3, kernel: Kernel) -> ShadowPacket {
        kernel.run(ShadowRays {
            points: self,
            target,
        })
    }
}

/// [`SurfacePointPacket::shadow_rays_to`] for every instruction set.
struct ShadowRays<'a> {
    points: &'a SurfacePointPacket,
    target: Vec3,
}

impl WithSimd for ShadowRays<'_> {
    type Output = ShadowPacket;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> ShadowPacket {
        let ShadowRays { points, target } = self;
        let (splat, load) = (S::F32x16::splat, S::F32x16::load);
        let mut packet = ShadowPacket {
            rays: RayPacket::EMPTY,
            distance: [0.0; PACKET_WIDTH],
            cosine: [0.0; PACKET_WIDTH],
        };
        let zero = splat(0.0);
        let offset = load(&points.offset);
        let mut to_target = [zero; 3];
        // The distance to the target, along the geometric and the shading normal and squared.
        let (mut geometric, mut shading, mut squared) = (zero, zero, zero);
        let mut magnitude = splat(target.abs().max_element());
        for axis in 0..3 {
            let position = load(&points.position[axis]);
            let normal = load(&points.geometric_normal[axis]);
            let d = splat(target[axis]).sub(position);
            to_target[axis] = d;
            geometric = geometric.add(d.mul(normal));
            shading = shading.add(d.mul(load(&points.shading_normal[axis])));
            squared = squared.add(d.mul(d));
            magnitude = magnitude.max(position.abs());
            packet.rays.origin[axis] = position.add(normal.mul(offset)).store();
        }
        let distance = squared.sqrt();
        for (direction, d) in packet.rays.direction.iter_mut().zip(to_target) {
            *direction = d.div(distance).store();
        }
        let rounding = magnitude.mul(splat(4.0 * f32::EPSILON));
        packet.rays.t_max = distance.sub(offset).sub(rounding).max(zero).store();
        packet.rays.exclude = points.exclude;
        let facing = zero.lt(geometric) & zero.lt(shading) & zero.lt(distance);
        packet.rays.active = facing & ((1 << points.count) - 1);
        if packet.rays.active != ALL_LANES {
            packet.rays.fill_inactive();
        }
        packet.distance = distance.store();
        packet.cosine = geometric.div(distance).store();
        packet
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface_point::SurfacePoint;
    use super::*;
    use crate::accel::{Bvh, QueryState};
    use crate::sampling::Random;

    /// Shadow rays of sixteen points or fewer, by hand; with every kernel the same bits; and what occludes
    /// them, as rays find it one by one.
    #[test]
    fn shadow_packets_agree_with_single_rays() {
        let mut random = Random::new(11);
        let triangles: Vec<[Vec3; 3]> = (0..300).map(|_| random.triangle(2.0, 0.5)).collect();
        for (count, triangles) in [(300, &triangles[..]), (9, &triangles[..9])] {
            let bvhs = Kernel::available()
                .into_iter()
                .map(|k| Bvh::new(triangles, vec![], k));
            let bvhs: Vec<Bvh> = bvhs.collect();
            assert_eq!(bvhs[0].has_tree(), count != 9);
            let mut query_state = QueryState::default();
            for round in 0..200 {
                let target = random.vector(2.0);
                // Coherent in half of the rounds, all over the scene in the others.
                let size = if round % 2 == 0 { 0.05 } else { 2.0 };
                let middle = random.vector(2.0);
                let listed: Vec<SurfacePoint> = (0..1 + round % PACKET_WIDTH)
                    .map(|i| SurfacePoint {
                        position: if i == 3 {
                            target
                        } else {
                            middle + random.vector(size)
                        },
                        geometric_normal: random.vector(1.0).normalize(),
                        shading_normal: random.vector(1.0).normalize(),
                        offset: 1e-6,
                        exclude: i as u32,
                    })
                    .collect();
                let mut points = SurfacePointPacket::default();
                listed.iter().for_each(|point| points.push(point));
                let packet_of = |bvh: &Bvh| points.shadow_rays_to(target, bvh.kernel());
                let packets: Vec<ShadowPacket> = bvhs.iter().map(packet_of).collect();
                for (lane, point) in listed.iter().enumerate() {
                    let d = target - point.position;
                    let faces =
                        d.dot(point.geometric_normal) > 0.0 && d.dot(point.shading_normal) > 0.0;
                    assert_eq!(packets[0].facing() >> lane & 1 != 0, faces);
                }
                assert!(packets[0].facing() < 1 << listed.len());
                for (bvh, packet) in bvhs.iter().zip(&packets) {
                    assert_eq!(packet.facing(), packets[0].facing());
                    let occluded = bvh.occluded_coherent(&packet.rays, &mut query_state);
                    let one = [&packet.rays].into_iter();
                    assert_eq!(bvh.occluded_incoherent(one, &mut query_state), [occluded]);
                    for lane in packet.rays.active_lanes() {
                        let (ray, same) = (packet.rays.ray(lane), packets[0].rays.ray(lane));
                        assert_eq!(format!("{ray:?}"), format!("{same:?}"));
                        let point = &listed[lane];
                        let start = point.spawn_ray(ray.direction);
                        assert_eq!((ray.origin, ray.exclude), (start.origin, start.exclude));
                        assert!((ray.at(ray.t_max.into()).as_vec3() - target).length() < 1e-5);
                        assert!(ray.t_max < packet.distance(lane));
                        let cosine = ray.direction.dot(point.geometric_normal);
                        assert!((cosine - packet.cosine(lane)).abs() < 1e-6);
                        assert_eq!(
                            occluded >> lane & 1 != 0,
                            bvh.occluded(&ray, &mut query_state)
                        );
                    }
                }
            }
        }
    }
}
