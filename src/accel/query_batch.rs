//! Queries of many rays, sixteen at a time: coherent rays together, incoherent rays one by one. Where there is no
//! tree, rays are gathered by their major axes and tested together.

use super::bvh::Bvh;
use super::packet_hits::PacketHits;
use super::query_state::QueryState;
use super::ray_packet::RayPacket;
use super::ray_setup::major_axis;
use super::traverse_packet::{ClosestOfRays, Coherence, TraversePacket};
use crate::geometry::Hit;
use crate::math::Ray;
use crate::simd::{ALL_LANES, PACKET_WIDTH};
use std::borrow::Borrow;

impl Bvh {
    /// The closest hit of each ray, as [`Bvh::closest`].
    ///
    /// Fast for coherent rays, with the same results for any.
    pub fn closest_coherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        self.closest_of(rays, Coherence::Coherent, hits, query_state);
    }

    /// The closest hit of each of any number of rays, as [`Bvh::closest`].
    pub fn closest_incoherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        if self.nodes.is_empty() {
            let rays = rays.iter().enumerate();
            self.query_by_axis::<false, _>(rays, query_state, |index, hit| {
                hits[index] = hit.found();
            });
        } else {
            self.closest_of(rays, Coherence::Incoherent, hits, query_state);
        }
    }

    /// The mask of the active rays of a packet that have something in their interval, as [`Bvh::occluded`].
    ///
    /// Fast for coherent rays, with the same result for any.
    pub fn occluded_coherent(&self, packet: &RayPacket, query_state: &mut QueryState) -> u32 {
        self.occluded_of(packet, Coherence::Coherent, query_state)
    }

    /// As [`Bvh::occluded_coherent`], of packets of incoherent rays.
    pub fn occluded_incoherent<'a>(
        &self,
        packets: impl ExactSizeIterator<Item = &'a RayPacket>,
        query_state: &mut QueryState,
    ) -> Vec<u32> {
        if !self.nodes.is_empty() {
            let of = |packet| self.occluded_of(packet, Coherence::Incoherent, query_state);
            return packets.map(of).collect();
        }
        let mut occluded = vec![0; packets.len()];
        // Written out first: a ray that is read whole right after its parts were written waits for them.
        let mut rays: Vec<(usize, Ray)> = Vec::with_capacity(packets.len() * PACKET_WIDTH);
        for (index, packet) in packets.enumerate() {
            let of_packet = packet.active_rays();
            rays.extend(of_packet.map(|(lane, ray)| (index * PACKET_WIDTH + lane, ray)));
        }
        let rays = rays.iter().map(|(index, ray)| (*index, ray));
        self.query_by_axis::<true, _>(rays, query_state, |index, hit| {
            occluded[index / PACKET_WIDTH] |= u32::from(!hit.is_miss()) << (index % PACKET_WIDTH);
        });
        occluded
    }

    fn closest_of(
        &self,
        rays: &[Ray],
        coherence: Coherence,
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        let (whole, rest) = rays.as_chunks::<PACKET_WIDTH>();
        let (hits, hits_of_rest) = hits.split_at_mut(whole.len() * PACKET_WIDTH);
        for (rays, hits) in whole.iter().zip(hits.as_chunks_mut::<PACKET_WIDTH>().0) {
            let mut found = PacketHits::new::<false>(ALL_LANES, &[f32::INFINITY; PACKET_WIDTH]);
            let is_traced = self.kernel.run(ClosestOfRays {
                bvh: self,
                rays,
                coherence,
                query_state,
                hits: &mut found,
            });
            if is_traced {
                for (lane, hit) in hits.iter_mut().enumerate() {
                    *hit = found.hit(lane).found();
                }
            } else {
                let rays = rays.iter().enumerate();
                self.query_by_axis::<false, _>(rays, query_state, |lane, hit| {
                    hits[lane] = hit.found();
                });
            }
        }
        if !rest.is_empty() {
            let packet = RayPacket::new(rest);
            self.query_packet::<false>(&packet, coherence, query_state, |lane, hit| {
                hits_of_rest[lane] = hit.found();
            });
        }
    }

    fn occluded_of(
        &self,
        packet: &RayPacket,
        coherence: Coherence,
        query_state: &mut QueryState,
    ) -> u32 {
        let mut occluded = 0;
        if packet.active != 0 {
            self.query_packet::<true>(packet, coherence, query_state, |lane, hit| {
                occluded |= u32::from(!hit.is_miss()) << lane;
            });
        }
        occluded
    }

    /// Emits the hit of each active ray of a packet with its lane; if `ANY_HIT`, some hit in its interval.
    #[inline]
    fn query_packet<const ANY_HIT: bool>(
        &self,
        packet: &RayPacket,
        coherence: Coherence,
        query_state: &mut QueryState,
        mut emit: impl FnMut(usize, Hit),
    ) {
        let mut hits = PacketHits::new::<ANY_HIT>(packet.active, &packet.t_max);
        let is_traced = self.kernel.run(TraversePacket::<ANY_HIT> {
            bvh: self,
            packet,
            coherence,
            query_state,
            hits: &mut hits,
        });
        if is_traced {
            let lanes = packet.active_lanes();
            lanes.for_each(|lane| emit(lane, hits.hit(lane)));
        } else {
            self.query_by_axis::<ANY_HIT, _>(packet.active_rays(), query_state, emit);
        }
    }

    /// As [`Bvh::query_packet`], of numbered rays where there is no tree: in packets by their major axes.
    #[inline]
    fn query_by_axis<const ANY_HIT: bool, R: Borrow<Ray>>(
        &self,
        rays: impl Iterator<Item = (usize, R)>,
        query_state: &mut QueryState,
        mut emit: impl FnMut(usize, Hit),
    ) {
        let mut packets = [RayPacket::EMPTY; 3];
        let mut indices = [[0; PACKET_WIDTH]; 3];
        let mut flush = |packet: &RayPacket, indices: &[usize; PACKET_WIDTH]| {
            let mut hits = PacketHits::new::<ANY_HIT>(packet.active, &packet.t_max);
            let is_traced = self.kernel.run(TraversePacket::<ANY_HIT> {
                bvh: self,
                packet,
                coherence: Coherence::Incoherent,
                query_state,
                hits: &mut hits,
            });
            assert!(
                is_traced,
                "a common major axis is enough where there is no tree"
            );
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
