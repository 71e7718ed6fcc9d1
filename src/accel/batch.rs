//! Many rays at once: in packets as they come, or in waves of rays that have nothing in common.

use super::lanes::{ALL, Packet};
use super::packet::PACKET;
use super::sight::{Points, Sight};
use super::watertight::permuted_axes;
use super::{Bvh, NOTHING, Traversal, kernel};
use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};
use glam::Vec3;

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
            let packet = Packet::of(rays);
            self.answer_packet::<false>(&packet, traversal, |lane, hit| hits[lane] = some(hit));
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
        let rays = rays.iter().copied().enumerate();
        self.answer_wave::<false>(rays, traversal, |number, hit| hits[number] = some(hit));
    }

    /// Whether anything lies in the interval of each ray, sixteen at a time, as [`Bvh::occluded`].
    pub fn occluded_of_packet(
        &self,
        rays: &[Ray],
        occluded: &mut [bool],
        traversal: &mut Traversal,
    ) {
        for (rays, occluded) in rays.chunks(PACKET).zip(occluded.chunks_mut(PACKET)) {
            let packet = Packet::of(rays);
            self.answer_packet::<true>(&packet, traversal, |lane, hit| {
                occluded[lane] = some(hit).is_some();
            });
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
            self.answer_packet::<true>(&sight.rays, traversal, |lane, hit| {
                bits |= u32::from(some(hit).is_some()) << lane;
            });
        }
        bits
    }

    /// As [`Bvh::occluded_of_sight`], of sights all over the scene: faster than one after the other
    /// where there is no tree.
    pub fn occluded_of_sights(&self, sights: &[Sight], traversal: &mut Traversal) -> Vec<u32> {
        let mut bits = vec![0; sights.len()];
        let rays = sights.iter().enumerate().flat_map(|(number, sight)| {
            let lanes = sight.rays.lanes();
            lanes.map(move |lane| (number * PACKET + lane, sight.rays.ray(lane)))
        });
        self.answer_wave::<true>(rays, traversal, |place, hit| {
            bits[place / PACKET] |= u32::from(some(hit).is_some()) << (place % PACKET);
        });
        bits
    }

    /// Says what each ray of a packet meets, by its lane; if `ANY`, only whether anything lies in its
    /// interval.
    #[inline]
    fn answer_packet<const ANY: bool>(
        &self,
        packet: &Packet,
        traversal: &mut Traversal,
        mut say: impl FnMut(usize, Hit),
    ) {
        if let Some(found) = self.try_packet::<ANY>(packet, traversal) {
            packet.lanes().for_each(|lane| say(lane, found[lane]));
        } else {
            let rays = packet.lanes().map(|lane| (lane, packet.ray(lane)));
            self.answer_wave::<ANY>(rays, traversal, say);
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
    fn answer_wave<const ANY: bool>(
        &self,
        rays: impl Iterator<Item = (usize, Ray)>,
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
                let axis = permuted_axes(ray.direction)[2];
                let (packet, numbers) = (&mut packets[axis], &mut numbers[axis]);
                numbers[packet.used.count_ones() as usize % PACKET] = number;
                packet.push(&ray);
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
                let is_occluded = self.occluded(&ray, traversal);
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
                say(number, self.closest(&ray, traversal).unwrap_or(NOTHING));
            }
        }
    }
}

/// None for [`NOTHING`].
#[inline]
fn some(hit: Hit) -> Option<Hit> {
    (hit.primitive != NO_PRIMITIVE).then_some(hit)
}
