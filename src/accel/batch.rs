//! Many rays at once: in packets as they come, or in waves of rays that have nothing in common.

use super::lanes::{ALL, Packet};
use super::sight::{Points, Sight};
use super::watertight::permuted_axes;
use super::{Bvh, NOTHING, PACKET, Traversal, kernel};
use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};
use glam::Vec3;
use std::borrow::Borrow;

impl Bvh {
    /// The nearest primitive that each ray meets, sixteen at a time, as [`Bvh::closest`].
    ///
    /// Fast if the rays run side by side, with the same results if they do not.
    pub fn closest_of_packet(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        for (rays, hits) in rays.chunks(PACKET).zip(hits.chunks_mut(PACKET)) {
            let (packet, rays) = (Packet::of(rays), rays.iter().enumerate());
            let say = |lane: usize, hit| hits[lane] = some(hit);
            self.answer_packet::<false, _>(&packet, rays, traversal, say);
        }
    }

    /// The nearest primitive that each of any number of rays meets, as [`Bvh::closest`].
    ///
    /// Faster than one ray after the other where there is no tree.
    pub fn closest_of_wave(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        let rays = rays.iter().enumerate();
        self.answer_wave::<false, _>(rays, traversal, |number, hit| hits[number] = some(hit));
    }

    /// Whether anything lies in the interval of each ray, sixteen at a time, as [`Bvh::occluded`].
    pub fn occluded_of_packet(
        &self,
        rays: &[Ray],
        occluded: &mut [bool],
        traversal: &mut Traversal,
    ) {
        for (rays, occluded) in rays.chunks(PACKET).zip(occluded.chunks_mut(PACKET)) {
            let (packet, rays) = (Packet::of(rays), rays.iter().enumerate());
            let say = |lane: usize, hit| occluded[lane] = some(hit).is_some();
            self.answer_packet::<true, _>(&packet, rays, traversal, say);
        }
    }

    /// How points see a target if nothing is in the way.
    pub fn look(&self, points: &Points, target: Vec3) -> Sight {
        kernel::look(self, points, target)
    }

    /// A bit for each ray of a sight that has something in its interval. Fast if they run side by side.
    pub fn occluded_of_sight(&self, sight: &Sight, traversal: &mut Traversal) -> u32 {
        let mut bits = 0;
        if sight.facing() != 0 {
            let packet = &sight.rays;
            self.answer_packet::<true, _>(packet, packet.numbered(), traversal, |lane, hit| {
                bits |= u32::from(some(hit).is_some()) << lane;
            });
        }
        bits
    }

    /// As [`Bvh::occluded_of_sight`], of sights all over the scene: faster than one after the other
    /// where there is no tree.
    pub fn occluded_of_sights(&self, sights: &[Sight], traversal: &mut Traversal) -> Vec<u32> {
        let mut bits = vec![0; sights.len()];
        // Written out first: a ray that is read whole right after its parts were written waits for them.
        let mut rays: Vec<(usize, Ray)> = Vec::with_capacity(sights.len() * PACKET);
        for (number, sight) in sights.iter().enumerate() {
            let of_sight = sight.rays.numbered();
            rays.extend(of_sight.map(|(lane, ray)| (number * PACKET + lane, ray)));
        }
        let rays = rays.iter().map(|(place, ray)| (*place, ray));
        self.answer_wave::<true, _>(rays, traversal, |place, hit| {
            bits[place / PACKET] |= u32::from(some(hit).is_some()) << (place % PACKET);
        });
        bits
    }

    /// Says what each ray of a packet meets, by its lane; if `ANY`, only whether anything lies in its
    /// interval. `rays` are the same, numbered by their lanes.
    #[inline]
    fn answer_packet<const ANY: bool, R: Borrow<Ray>>(
        &self,
        packet: &Packet,
        rays: impl Iterator<Item = (usize, R)>,
        traversal: &mut Traversal,
        mut say: impl FnMut(usize, Hit),
    ) {
        if let Some(found) = self.try_packet::<ANY>(packet, traversal) {
            packet.lanes().for_each(|lane| say(lane, found[lane]));
        } else {
            self.answer_wave::<ANY, _>(rays, traversal, say);
        }
    }

    /// What each ray of a packet meets, if they have enough in common.
    #[inline]
    fn try_packet<const ANY: bool>(
        &self,
        packet: &Packet,
        traversal: &mut Traversal,
    ) -> Option<[Hit; PACKET]> {
        let found = kernel::packet::<ANY>(self, packet, &mut traversal.packet_stack)?;
        traversal.rays += u64::from(packet.used.count_ones());
        Some(found)
    }

    /// As [`Bvh::answer_packet`], of numbered rays that have nothing in common: in packets by their main
    /// axes where there is no tree, otherwise one by one.
    #[inline]
    fn answer_wave<const ANY: bool, R: Borrow<Ray>>(
        &self,
        rays: impl Iterator<Item = (usize, R)>,
        traversal: &mut Traversal,
        mut say: impl FnMut(usize, Hit),
    ) {
        if self.nodes.is_empty() {
            let mut packets = [Packet::EMPTY; 3];
            let mut numbers = [[0; PACKET]; 3];
            let mut answer = |packet: &Packet, numbers: &[usize; PACKET]| {
                let found = self.try_packet::<ANY>(packet, traversal);
                let found = found.expect("one main axis is enough where there is no tree");
                packet.lanes().for_each(|l| say(numbers[l], found[l]));
            };
            for (number, ray) in rays {
                let ray = ray.borrow();
                let axis = permuted_axes(ray.direction)[2];
                let (packet, numbers) = (&mut packets[axis], &mut numbers[axis]);
                numbers[packet.used.count_ones() as usize % PACKET] = number;
                packet.push(ray);
                if packet.used == ALL {
                    answer(packet, numbers);
                    packet.used = 0;
                }
            }
            for (packet, numbers) in packets.iter_mut().zip(&numbers) {
                if packet.used != 0 {
                    packet.fill();
                    answer(packet, numbers);
                }
            }
        } else if ANY {
            for (number, ray) in rays {
                let is_occluded = self.occluded(ray.borrow(), traversal);
                let primitive = if is_occluded { 0 } else { NO_PRIMITIVE };
                say(
                    number,
                    Hit {
                        primitive,
                        ..NOTHING
                    },
                );
            }
        } else {
            for (number, ray) in rays {
                say(
                    number,
                    self.closest(ray.borrow(), traversal).unwrap_or(NOTHING),
                );
            }
        }
    }
}

/// None for [`NOTHING`].
#[inline]
fn some(hit: Hit) -> Option<Hit> {
    (hit.primitive != NO_PRIMITIVE).then_some(hit)
}
