//! Where the sky is seen from: for each part of the scene, in which directions and how brightly. It is learned from rays,
//! so that a room finds its windows (as path guiding learns incident radiance: Müller, Gross and Novák 2017, "Practical
//! Path Guiding for Efficient Light-Transport Simulation"; here of the sky alone, once, before any picture).
//!
//! What a part learns depends on the scene and its place alone: it is learned when it is first asked for, and the same
//! whoever asks.

use crate::accel::QueryState;
use crate::material::FeatureMask;
use crate::math::Ray;
use crate::sampling::{
    DirectionCell, DirectionHistogram, SobolSequence, cube_face, uniform_sphere,
};
use crate::scene::{Scene, SurfacePoint};
use glam::{IVec3, Vec3};
use std::f32::consts::PI;
use std::fmt;
use std::sync::OnceLock;

/// Parts along the distance that one in ten rays between surfaces exceeds, about the width of a room: so finely that a
/// window moves little in the views of a part.
const PARTS: f32 = 8.0;

/// How many rooms away from the origin parts begin to be larger.
const NEAR: f32 = 2.0;

/// Rays that measure the width of a room.
const PROBES: u32 = 1024;

/// The number of lists of parts.
const LISTS: usize = 1 << 14;

/// Points of a part from which rays are traced.
const POINTS: u32 = 16;

/// Rays to each cell of directions: so many that gaps between slats and leaves are found.
const RAYS: u32 = 16;

/// The directions in which the sky is seen from a part of the scene.
#[derive(Debug)]
pub(super) struct SkyView {
    pub(super) directions: DirectionHistogram,
    /// The part of the irradiance of a sky without obstacles that arrives, 0..1.
    pub(super) openness: f32,
}

/// The views of the sky from all parts of a scene: cubes, for each of the six sides that a surface may face. They are larger
/// far from the scene's origin, around which most of it lies: what lies there is the ground outside.
pub(super) struct SkyGuide {
    parts_per_metre: f32,
    /// Parts by their hash. A list grows at its end, so that it is read without a lock.
    lists: Vec<OnceLock<Box<Part>>>,
}

/// Which part it is: a cube of a grid, and the side that surfaces face there.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Key {
    place: IVec3,
    /// How often the edge is doubled.
    level: u32,
    side: usize,
}

struct Part {
    key: Key,
    /// None where no surface is found, or no sky.
    view: OnceLock<Option<SkyView>>,
    next: OnceLock<Box<Part>>,
}

impl fmt::Debug for SkyGuide {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let parts_per_metre = &self.parts_per_metre;
        let mut debug = f.debug_struct("SkyGuide");
        debug
            .field("parts_per_metre", parts_per_metre)
            .finish_non_exhaustive()
    }
}

impl SkyGuide {
    /// Of a scene; nothing is learned yet but how far surfaces are from each other.
    pub(super) fn new(scene: &Scene) -> SkyGuide {
        SkyGuide {
            parts_per_metre: PARTS / room_width(scene),
            lists: std::iter::repeat_with(OnceLock::new).take(LISTS).collect(),
        }
    }

    /// The view from a point of a surface with this normal, from parts whose edge is doubled `wider` times.
    pub(super) fn view(
        &self,
        scene: &Scene,
        position: Vec3,
        normal: Vec3,
        wider: u32,
    ) -> Option<&SkyView> {
        let key = self.key(position, normal, wider);
        let [x, y, z] = key.place.to_array().map(|c| c as u32);
        let hash =
            x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ z.wrapping_mul(0xc2b2_ae3d);
        let list =
            (hash ^ hash >> 15).wrapping_add(8 * key.level + key.side as u32) as usize % LISTS;
        let new = || {
            Box::new(Part {
                key,
                view: OnceLock::new(),
                next: OnceLock::new(),
            })
        };
        let mut part = self.lists[list].get_or_init(new);
        while part.key != key {
            part = part.next.get_or_init(new);
        }
        part.view.get_or_init(|| self.learn(scene, key)).as_ref()
    }

    /// The part of a point of a surface with this normal.
    fn key(&self, position: Vec3, normal: Vec3, wider: u32) -> Key {
        let parts = position * self.parts_per_metre;
        // The power of two below the distance.
        let rooms = (parts.abs().max_element() / (NEAR * PARTS)).clamp(1.0, 1e9);
        let level = (rooms.to_bits() >> 23) - 127 + wider;
        Key {
            place: (parts / (1_u32 << level) as f32).floor().as_ivec3(),
            level,
            side: cube_face(normal),
        }
    }

    /// The edge of a part, in metres.
    fn edge(&self, level: u32) -> f32 {
        (1_u32 << level) as f32 / self.parts_per_metre
    }

    /// Traces rays from the surfaces of a part.
    fn learn(&self, scene: &Scene, key: Key) -> Option<SkyView> {
        let [x, y, z] = key.place.to_array().map(|c| c as u32);
        let sequence = SobolSequence::new(x, y, z, 8 * key.level + key.side as u32);
        let mut query_state = QueryState::default();
        let points: Vec<SurfacePoint> = (0..POINTS)
            .filter_map(|i| {
                self.surface_point(scene, key, sequence.sample_2d(i, 0), &mut query_state)
            })
            .collect();
        if points.is_empty() {
            return None;
        }
        let numbers = sequence.stream(0);
        let (mut rays, mut owners) = (Vec::new(), Vec::new());
        for (index, cell) in DirectionCell::all().enumerate() {
            for i in 0..RAYS {
                let number = index as u32 * RAYS + i;
                let direction = cell.direction(numbers.sample_2d(number, 1));
                // Every point gets rays to every part of the sphere.
                let point = &points[(number.wrapping_mul(13) % points.len() as u32) as usize];
                let cos = direction.dot(point.shading_normal);
                if cos > 0.0 && direction.dot(point.geometric_normal) > 0.0 {
                    rays.push(point.spawn_ray(direction));
                    owners.push((index, cos));
                }
            }
        }
        let mut hits = vec![None; rays.len()];
        scene.closest_incoherent(&rays, &mut hits, &mut query_state);
        let (mut bright, mut open) = (vec![0.0; DirectionCell::all().count()], 0.0);
        for ((ray, hit), (cell, cos)) in rays.iter().zip(&hits).zip(owners) {
            if hit.is_none() {
                let weight =
                    f64::from(cos * DirectionCell::solid_angle(ray.direction)) / f64::from(RAYS);
                let radiance = scene.sky.radiance(ray.direction).element_sum();
                bright[cell] += weight * f64::from(radiance);
                open += weight;
            }
        }
        Some(SkyView {
            directions: DirectionHistogram::new(&bright)?,
            openness: (open as f32 / PI).min(1.0),
        })
    }

    /// A point of a part's surfaces that face a side, by two numbers in [0, 1); none if there is none along their line.
    fn surface_point(
        &self,
        scene: &Scene,
        Key { place, level, side }: Key,
        [u, v]: [f32; 2],
        query_state: &mut QueryState,
    ) -> Option<SurfacePoint> {
        let (axis, sign) = (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
        let mut start = place.as_vec3() + 0.5;
        start[(axis + 1) % 3] += u - 0.5;
        start[(axis + 2) % 3] += v - 0.5;
        start[axis] += 0.5 * sign;
        let mut direction = Vec3::ZERO;
        direction[axis] = -sign;
        let edge = self.edge(level);
        let ray = Ray {
            t_max: edge,
            ..Ray::new(start * edge, direction)
        };
        let hit = scene.closest(&ray, query_state)?;
        let point = scene.surface::<FeatureMask<0>>(&ray, &hit).point;
        (cube_face(point.shading_normal) == side).then_some(point)
    }
}

/// The length that one in ten rays from shapes to others exceeds, in metres: from as many large shapes as small ones. 1
/// where no ray hits.
fn room_width(scene: &Scene) -> f32 {
    let sequence = SobolSequence::new(0, 0, 0, 0);
    let mut query_state = QueryState::default();
    let mut lengths = Vec::new();
    let (triangles, spheres) = (scene.triangle_count(), scene.sphere_count());
    for i in 0..PROBES {
        let shape = sequence.sample_1d(i, 0) * (triangles + spheres) as f32;
        let [u, v] = sequence.sample_2d(i, 1);
        let direction = uniform_sphere(u, v);
        let origin = match scene
            .spheres()
            .get((shape as usize).wrapping_sub(triangles))
        {
            Some(sphere) => (sphere.center + sphere.radius * direction.as_dvec3()).as_vec3(),
            None if triangles > 0 => {
                let corners = scene.triangle_vertices((shape as usize).min(triangles - 1));
                corners.iter().sum::<Vec3>() / 3.0
            }
            None => continue,
        };
        let hit = scene.closest(&Ray::new(origin, direction), &mut query_state);
        lengths.extend(hit.map(|hit| hit.t as f32).filter(|length| *length > 0.0));
    }
    lengths.sort_unstable_by(f32::total_cmp);
    lengths.get(lengths.len() * 9 / 10).copied().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Sky;
    use crate::material::Material;
    use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};
    use glam::DVec3;

    /// A room of 4 m under a sky, with a hole of 1 m in its ceiling.
    fn room() -> Scene {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let mut triangles = Vec::new();
        let mut positions = Vec::new();
        let mut quad = |corners: [DVec3; 4]| {
            let first = positions.len() as u32;
            positions.extend(corners);
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        };
        for y in [-2.0, 2.0] {
            let hole = if y > 0.0 { 0.5 } else { 0.0 };
            for (x0, x1, z0, z1) in [
                (-2.0, 2.0, -2.0, -hole),
                (-2.0, 2.0, hole, 2.0),
                (-2.0, -hole, -hole, hole),
                (hole, 2.0, -hole, hole),
            ] {
                quad([
                    corner(x0, y, z0),
                    corner(x1, y, z0),
                    corner(x1, y, z1),
                    corner(x0, y, z1),
                ]);
            }
        }
        for s in [-2.0, 2.0] {
            quad([
                corner(s, -2.0, -2.0),
                corner(s, 2.0, -2.0),
                corner(s, 2.0, 2.0),
                corner(s, -2.0, 2.0),
            ]);
            quad([
                corner(-2.0, -2.0, s),
                corner(-2.0, 2.0, s),
                corner(2.0, 2.0, s),
                corner(2.0, -2.0, s),
            ]);
        }
        let builder = SceneBuilder {
            sky: Sky::Uniform(Vec3::ONE),
            materials: vec![Material::lambert(Vec3::ONE)],
            meshes: vec![SourceMesh {
                positions,
                normals: vec![],
                uvs: vec![],
                triangles,
                material: MeshMaterial::Uniform(0),
            }],
            ..SceneBuilder::default()
        };
        builder.build().0
    }

    /// From the middle of the floor the hole takes up 1 / (16 pi) of the irradiance, and directions are found there.
    #[test]
    fn rooms_find_their_windows() {
        let scene = room();
        let guide = SkyGuide::new(&scene);
        let floor = Vec3::new(0.05, -2.0, 0.05);
        let view = guide
            .view(&scene, floor, Vec3::Y, 0)
            .expect("the sky is seen");
        // From all of its part, by few rays.
        let openness = view.openness;
        assert!((0.01..0.04).contains(&openness), "{openness}");
        let sequence = SobolSequence::new(1, 0, 0, 0);
        let through = (0..1024).filter(|&i| {
            let direction = view.directions.sample(sequence.sample_2d(i, 0));
            let at = floor + direction * (4.0 / direction.y);
            direction.y > 0.0 && at.x.abs() < 0.5 && at.z.abs() < 0.5
        });
        // Of directions by the cosine, one in fifty goes through.
        let through = through.count();
        assert!(through > 200, "{through}");
        // Outside, all of the sky is seen.
        let roof = guide
            .view(&scene, Vec3::new(1.5, 2.0, 1.5), Vec3::Y, 0)
            .expect("the sky");
        assert!(roof.openness > 0.8, "{}", roof.openness);
    }
}
