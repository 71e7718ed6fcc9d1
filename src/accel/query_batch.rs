//! Queries of many rays: coherent rays in packets as they come, incoherent rays one by one or, where there is
//! no tree, gathered into packets.

use super::bvh::Bvh;
use super::packet_hits::PacketHits;
use super::query_state::QueryState;
use super::ray_packet::RayPacket;
use super::traverse_packet::TraversePacket;
use super::ray_setup::major_axis;
use crate::geometry::Hit;
use crate::math::Ray;
use crate::simd::{ALL_LANES, PACKET_WIDTH};
use std::borrow::Borrow;

impl Bvh {
    /// The closest hit of each ray, sixteen at a time, as [`Bvh::closest`].
    ///
    /// Fast for coherent rays, with the same results for any.
    pub fn closest_coherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        for (rays, hits) in rays.chunks(PACKET_WIDTH).zip(hits.chunks_mut(PACKET_WIDTH)) {
            let (packet, rays) = (RayPacket::new(rays), rays.iter().enumerate());
            let emit = |lane: usize, hit: Hit| hits[lane] = hit.found();
            self.query_packet::<false, _>(&packet, rays, query_state, emit);
        }
    }

    /// The closest hit of each of any number of rays, as [`Bvh::closest`].
    ///
    /// Faster than one ray after the other where there is no tree.
    pub fn closest_incoherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        let rays = rays.iter().enumerate();
        self.query_incoherent::<false, _>(rays, query_state, |index, hit| {
            hits[index] = hit.found()
        });
    }

    /// The mask of the active rays of a packet that have something in their interval, as [`Bvh::occluded`].
    ///
    /// Fast for coherent rays, with the same result for any.
    pub fn occluded_coherent(&self, packet: &RayPacket, query_state: &mut QueryState) -> u32 {
        let mut occluded = 0;
        if packet.active != 0 {
            let rays = packet.active_rays();
            self.query_packet::<true, _>(packet, rays, query_state, |lane, hit| {
                occluded |= u32::from(!hit.is_miss()) << lane;
            });
        }
        occluded
    }

    /// As [`Bvh::occluded_coherent`], of packets of incoherent rays.
    ///
    /// Faster than one ray after the other where there is no tree.
    pub fn occluded_incoherent<'a>(
        &self,
        packets: impl ExactSizeIterator<Item = &'a RayPacket>,
        query_state: &mut QueryState,
    ) -> Vec<u32> {
        let mut occluded = vec![0; packets.len()];
        // Written out first: a ray that is read whole right after its parts were written waits for them.
        let mut rays: Vec<(usize, Ray)> = Vec::with_capacity(packets.len() * PACKET_WIDTH);
        for (index, packet) in packets.enumerate() {
            let of_packet = packet.active_rays();
            rays.extend(of_packet.map(|(lane, ray)| (index * PACKET_WIDTH + lane, ray)));
        }
        let rays = rays.iter().map(|(index, ray)| (*index, ray));
        self.query_incoherent::<true, _>(rays, query_state, |index, hit| {
            occluded[index / PACKET_WIDTH] |= u32::from(!hit.is_miss()) << (index % PACKET_WIDTH);
        });
        occluded
    }

    /// Emits the hit of each active ray of a packet with its lane; if `ANY_HIT`, some hit in its interval.
    /// `rays` are the same rays with their lanes.
    #[inline]
    fn query_packet<const ANY_HIT: bool, R: Borrow<Ray>>(
        &self,
        packet: &RayPacket,
        rays: impl Iterator<Item = (usize, R)>,
        query_state: &mut QueryState,
        mut emit: impl FnMut(usize, Hit),
    ) {
        let mut hits = PacketHits::new::<ANY_HIT>(packet);
        if self.try_packet::<ANY_HIT>(packet, query_state, &mut hits) {
            let lanes = packet.active_lanes();
            lanes.for_each(|lane| emit(lane, hits.hit(lane)));
        } else {
            self.query_incoherent::<ANY_HIT, _>(rays, query_state, emit);
        }
    }

    /// The hits of the rays of a packet; none if there is no tree and the rays do not share their major axis.
    #[inline]
    fn try_packet<const ANY_HIT: bool>(
        &self,
        packet: &RayPacket,
        query_state: &mut QueryState,
        hits: &mut PacketHits,
    ) -> bool {
        self.kernel.run(TraversePacket::<ANY_HIT> {
            bvh: self,
            packet,
            query_state,
            hits,
        })
    }

    /// As [`Bvh::query_packet`], of numbered incoherent rays: in packets by their major axes where there is no
    /// tree, otherwise one by one.
    #[inline]
    fn query_incoherent<const ANY_HIT: bool, R: Borrow<Ray>>(
        &self,
        rays: impl Iterator<Item = (usize, R)>,
        query_state: &mut QueryState,
        mut emit: impl FnMut(usize, Hit),
    ) {
        if !self.nodes.is_empty() {
            for (index, ray) in rays {
                emit(index, self.query::<ANY_HIT>(ray.borrow(), query_state));
            }
            return;
        }
        let mut packets = [RayPacket::EMPTY; 3];
        let mut indices = [[0; PACKET_WIDTH]; 3];
        let mut flush = |packet: &RayPacket, indices: &[usize; PACKET_WIDTH]| {
            let mut hits = PacketHits::new::<ANY_HIT>(packet);
            self.try_packet::<ANY_HIT>(packet, query_state, &mut hits);
            let lanes = packet.active_lanes();
            lanes.for_each(|lane| emit(indices[lane], hits.hit(lane)));
        };
        for (index, ray) in rays {
            let ray = ray.borrow();
            let axis = major_axis(ray.direction);
            let (packet, indices) = (&mut packets[axis], &mut indices[axis]);
            indices[packet.active.count_ones() as usize % PACKET_WIDTH] = index;
            packet.push(ray);
            if packet.active == ALL_LANES {
                flush(packet, indices);
                packet.active = 0;
            }
        }
        for (packet, indices) in packets.iter_mut().zip(&indices) {
            if packet.active != 0 {
                packet.fill_inactive();
                flush(packet, indices);
            }
        }
    }
}
