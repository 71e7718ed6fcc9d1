//! Random scenes of hard cases: the tree, every kernel and packets find exactly what testing every primitive
//! finds.
#![allow(clippy::print_stdout, reason = "the seed of a failure is shown")]

use super::bvh::Bvh;
use super::query_state::QueryState;
use super::ray_packet::RayPacket;
use crate::geometry::{Hit, Sphere};
use crate::math::Ray;
use crate::sampling::Random;
use crate::simd::Kernel;
use crate::simd::PACKET_WIDTH;
use glam::Vec3;
use glam::Vec3Swizzles;

/// Numbers from a fuzzer's bytes, and random numbers after they are used up.
struct Numbers<'a> {
    bytes: &'a [u8],
    random: Random,
}

impl Numbers<'_> {
    /// As [`Random::unit`].
    fn unit(&mut self) -> f32 {
        match self.bytes.split_first_chunk() {
            Some((&[a, b, c], rest)) => {
                self.bytes = rest;
                u32::from_le_bytes([a, b, c, 0]) as f32 / (1 << 24) as f32
            }
            None => self.random.unit(),
        }
    }

    fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.unit() - 0.5)) * 2.0 * size
    }
}

/// Checks the scene of a fuzzer's bytes.
#[cfg(fuzzing)]
pub fn check_scene_of(bytes: &[u8]) {
    let random = Random::new(0);
    check_scene(&mut Numbers { bytes, random });
}

#[cfg(test)]
fn check_scene_of_seed(seed: u64) {
    let random = Random::new(seed);
    check_scene(&mut Numbers { bytes: &[], random });
}

/// For as many seconds as FUZZ_SECONDS says. Run with `--ignored`.
#[test]
#[ignore = "runs for a given time"]
fn fuzz() {
    let seconds: u64 = std::env::var("FUZZ_SECONDS").map_or(10, |s| s.parse().expect("a number"));
    let start = std::time::Instant::now();
    let first = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |t| t.as_secs());
    let mut cases = 0;
    while start.elapsed().as_secs() < seconds {
        let seed = std::env::var("FUZZ_SEED")
            .map_or(first * 1_000_003 + cases, |s| s.parse().expect("a number"));
        // Shown if it fails: set the variable to this number to see it fail again.
        println!("FUZZ_SEED={seed}");
        check_scene_of_seed(seed);
        cases += 1;
    }
    println!("{cases} scenes");
}

#[test]
fn a_few_random_scenes() {
    for seed in 0..300 {
        check_scene_of_seed(seed * 7919);
    }
}

/// A scene of one kind of difficult shapes, of any scale and position, and rays to vertices and edges, along axes
/// and from points on the shapes.
fn check_scene(random: &mut Numbers) {
    let pick = |random: &mut Numbers, count: usize| (random.unit() * count as f32) as usize;
    let scale = 10_f32.powi(pick(random, 13) as i32 - 6);
    let shift = random.vector(1.0) * scale * [0.0, 1.0, 1e3, 1e5][pick(random, 4)];
    let (triangle_count, sphere_count) = (pick(random, 200), pick(random, 3) * pick(random, 20));
    let kind = pick(random, 5);
    let snap = |v: Vec3, steps: f32| (v * steps).round() / steps;
    let triangles: Vec<[Vec3; 3]> = (0..triangle_count)
        .map(|i| {
            let at = random.vector(1.0);
            let (a, b) = (random.vector(0.3), random.vector(0.3));
            let vertices = match kind {
                // Soup; on a grid, flat; needles; fans around few points; many that coincide.
                0 => [at, at + a, at + b],
                1 => {
                    let mut vertices = [at, at + a, at + b].map(|p| snap(p, 8.0));
                    for vertex in &mut vertices {
                        vertex[i % 3] = snap(at, 2.0)[i % 3];
                    }
                    vertices
                }
                2 => [at, at + a, at + a * 0.5 + b * 1e-7],
                3 => [
                    snap(at, 1.0),
                    snap(at, 1.0) + snap(a, 16.0),
                    snap(at, 1.0) + snap(b, 16.0),
                ],
                _ => [Vec3::ZERO, Vec3::X, Vec3::Y],
            };
            vertices.map(|p| p * scale + shift)
        })
        .collect();
    let spheres: Vec<Sphere> = (0..sphere_count)
        .map(|_| {
            let radius = f64::from(scale * (0.001 + 0.3 * random.unit()));
            Sphere::new((random.vector(1.0) * scale + shift).as_dvec3(), radius)
        })
        .collect();
    let rays: Vec<Ray> = (0..160)
        .map(|i| {
            let size = [0.5, 1.0, 3.0, 100.0][pick(random, 4)];
            let mut origin = random.vector(size);
            let mut direction = random.vector(1.0);
            if let Some(vertices) = triangles.get(i) {
                let vertex = (vertices[i % 3] - shift) / scale;
                match pick(random, 4) {
                    0 => direction = vertex - origin,
                    1 => origin = vertex,
                    2 => direction = vertex.lerp((vertices[0] - shift) / scale, 0.5) - origin,
                    _ => {}
                }
            }
            match pick(random, 4) {
                0 => direction[i % 3] = [0.0, -0.0, 1e-38, 1e-45][pick(random, 4)],
                1 => {
                    direction[i % 3] = 0.0;
                    direction[(i + 1) % 3] = -0.0;
                }
                _ => {}
            }
            if direction == Vec3::ZERO {
                direction = Vec3::X;
            }
            Ray::new(origin * scale + shift, direction)
        })
        .collect();
    let mut query_state = QueryState::default();
    let mut brute = Bvh::new(&triangles, spheres.clone(), Kernel::PORTABLE);
    assert_eq!(brute.validate(), Ok(()));
    brute.nodes.clear();
    check_packets(&brute, &rays);
    let expected: Vec<Option<Hit>> = rays
        .iter()
        .map(|ray| brute.closest(ray, &mut query_state))
        .collect();
    for kernel in Kernel::available() {
        let mut bvh = Bvh::new(&triangles, spheres.clone(), kernel);
        check_packets(&bvh, &rays);
        bvh.exceeds_caches = true;
        let mut hits = vec![None; rays.len()];
        bvh.closest_incoherent(&rays, &mut hits, &mut query_state);
        assert_eq!(hits, expected, "in turn");
        for (ray, expected) in rays.iter().zip(&expected) {
            assert_eq!(bvh.closest(ray, &mut query_state), *expected, "{ray:?}");
        }
    }
}

/// Rays that end before, at and behind their hits.
fn ending_around(rays: &[Ray], hits: &[Option<Hit>]) -> Vec<Ray> {
    (0..)
        .zip(rays.iter().zip(hits))
        .map(|(i, (ray, hit))| Ray {
            t_max: hit.map_or(1e30, |h| h.t as f32) * [0.5, 1.0, 2.0][i % 3],
            ..*ray
        })
        .collect()
}

/// Whether each ray is occluded, by packets of rays as they come.
fn occluded_in_packets(bvh: &Bvh, rays: &[Ray], query_state: &mut QueryState) -> Vec<bool> {
    let of_packet = |rays: &[Ray]| {
        let occluded = bvh.occluded_coherent(&RayPacket::new(rays), query_state);
        (0..rays.len()).map(move |lane| occluded >> lane & 1 != 0)
    };
    rays.chunks(PACKET_WIDTH).flat_map(of_packet).collect()
}

/// Incoherent rays and rays of a packet find what they find alone: as they come, and side by side.
pub(super) fn check_packets(bvh: &Bvh, rays: &[Ray]) {
    let mut query_state = QueryState::default();
    let mut hits = vec![None; rays.len()];
    bvh.closest_incoherent(rays, &mut hits, &mut query_state);
    for (ray, hit) in rays.iter().zip(&hits) {
        assert_eq!(*hit, bvh.closest(ray, &mut query_state), "{ray:?}");
    }
    let shadow_rays = ending_around(rays, &hits);
    let occluded = occluded_in_packets(bvh, &shadow_rays, &mut query_state);
    let packets: Vec<RayPacket> = shadow_rays
        .chunks(PACKET_WIDTH)
        .map(RayPacket::new)
        .collect();
    let masks = bvh.occluded_incoherent(packets.iter(), &mut query_state);
    for (i, (ray, occluded)) in shadow_rays.iter().zip(occluded).enumerate() {
        let incoherent = masks[i / PACKET_WIDTH] >> (i % PACKET_WIDTH) & 1 != 0;
        let alone = bvh.occluded(ray, &mut query_state);
        assert_eq!([occluded, incoherent], [alone; 2], "{ray:?}");
    }
    let beside = |ray: &Ray, i: usize| {
        let turned = ray.direction + ray.direction.yzx() * (i as f32 * 1e-3);
        Ray::new(ray.origin, turned)
    };
    let beside: Vec<Ray> = rays
        .iter()
        .step_by(8)
        .flat_map(|ray| (0..PACKET_WIDTH).map(move |i| beside(ray, i)))
        .collect();
    for rays in rays.chunks(PACKET_WIDTH).chain(beside.chunks(PACKET_WIDTH)) {
        let mut hits = vec![None; rays.len()];
        bvh.closest_coherent(rays, &mut hits, &mut query_state);
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(*hit, bvh.closest(ray, &mut query_state), "{ray:?}");
        }
        let shadow_rays = ending_around(rays, &hits);
        let occluded = occluded_in_packets(bvh, &shadow_rays, &mut query_state);
        for (ray, occluded) in shadow_rays.iter().zip(occluded) {
            assert_eq!(occluded, bvh.occluded(ray, &mut query_state), "{ray:?}");
        }
    }
}
