//! Everything of a scene that emits and is sampled as a light: triangles, spheres and the balls of point lights, in a
//! light tree.

use super::emitter::{Shape, Towards};
use super::resolved::Scene;
use super::surface_point::SurfacePoint;
use crate::geometry::Hit;
use crate::light::LightTree;
use crate::math::{NO_PRIMITIVE, Ray};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The emitters of a scene; empty in most.
#[derive(Debug, Default)]
pub(super) struct Emitters {
    /// Those of each primitive; empty if no primitive emits.
    pub(super) of_primitive: Vec<Option<Pieces>>,
    pub(super) emitters: Vec<Emitter>,
    pub(super) tree: LightTree,
}

#[derive(Debug)]
pub(super) struct Emitter {
    pub(super) shape: Shape,
    pub(super) source: Source,
    /// Its mean radiance.
    pub(super) radiance: Vec3,
}

/// Where the light of an emitter comes from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// A primitive of the scene.
    Primitive(u32),
    /// The ball of a point light.
    Ball(usize),
}

/// The emitters of a primitive: one, or those of the equal parts that a textured triangle is cut into.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces {
    pub(super) first: u32,
    /// Into so many parts each of its edges is cut.
    pub(super) rows: u32,
}

/// A ray towards an emitter and the light that it brings if nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// The ray, which ends at the emitter or just behind it.
    pub ray: Ray,
    /// The distance to the emitter.
    pub distance: f64,
    /// The primitive that the ray hits there, or [`NO_PRIMITIVE`].
    pub primitive: u32,
    /// The radiance that arrives.
    pub radiance: Vec3,
    /// The pdf of the direction, over solid angle.
    pub pdf: f32,
}

impl LightSample {
    /// Of a ray that arrives if it leaves the scene. Radiance and pdf are 1: the caller knows them.
    pub fn at_infinity(point: &SurfacePoint, direction: Vec3) -> LightSample {
        LightSample {
            ray: point.spawn_ray(direction),
            distance: f64::INFINITY,
            primitive: NO_PRIMITIVE,
            radiance: Vec3::ONE,
            pdf: 1.0,
        }
    }

    /// Whether the light arrives, given what the ray hits.
    #[inline]
    pub fn is_visible(&self, hit: Option<&Hit>) -> bool {
        /// Relative: above the rounding of double precision, far below that of the scene's coordinates.
        const ROUNDING: f64 = 1e-12;
        // The direction is rounded: it may miss a tiny emitter, and what is behind or beside it does not occlude it.
        hit.is_none_or(|hit| {
            hit.primitive == self.primitive || hit.t >= self.distance * (1.0 - ROUNDING)
        })
    }
}

impl Emitters {
    pub(super) fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    /// Whether a primitive emits.
    #[inline(always)]
    pub(super) fn is_emitter(&self, primitive: u32) -> bool {
        matches!(self.of_primitive.get(primitive as usize), Some(Some(_)))
    }

    pub(super) fn memory(&self) -> usize {
        size_of_val(&*self.of_primitive) + size_of_val(&*self.emitters) + self.tree.memory()
    }

    /// The emitter that a ray meets at a hit.
    fn at(&self, scene: &Scene, ray: &Ray, hit: &Hit) -> Option<usize> {
        let pieces = (*self.of_primitive.get(hit.primitive as usize)?)?;
        let first = pieces.first as usize;
        if pieces.rows == 1 {
            return Some(first);
        }
        let triangle = &scene.triangles[hit.primitive as usize];
        let mesh = &scene.meshes[triangle.mesh as usize];
        let [_, u, v] = mesh.weights(triangle.vertices, ray.at(hit.t));
        Some(first + pieces.piece_at(u, v))
    }
}

impl Pieces {
    /// The number of the piece at the weights of the second and third vertex. Row i, between weights of i and i + 1 rows of
    /// the second vertex, has 2 (rows - i) - 1 pieces.
    fn piece_at(self, u: f32, v: f32) -> usize {
        let rows = self.rows as usize;
        let (u, v) = (u * rows as f32, v * rows as f32);
        let row = (u as usize).min(rows - 1);
        let column = (v as usize).min(rows - 1 - row);
        let is_upper = (u - row as f32) + (v - column as f32) > 1.0 && column + 1 < rows - row;
        2 * rows * row - row * row + 2 * column + usize::from(is_upper)
    }

    /// The weights of the second and third vertex at the corners of all pieces, in the order of [`Pieces::piece_at`].
    pub(super) fn corners(rows: u32) -> impl Iterator<Item = [[f64; 2]; 3]> {
        let at = move |i: u32, j: u32| [i, j].map(|k| f64::from(k) / f64::from(rows));
        (0..rows).flat_map(move |row| {
            (0..rows - row).flat_map(move |column| {
                let lower = [at(row, column), at(row + 1, column), at(row, column + 1)];
                let upper = [
                    at(row + 1, column),
                    at(row + 1, column + 1),
                    at(row, column + 1),
                ];
                let has_upper = column + 1 < rows - row;
                [Some(lower), has_upper.then_some(upper)]
                    .into_iter()
                    .flatten()
            })
        })
    }
}

impl Scene {
    /// Whether surfaces or balls emit: light that is sampled.
    pub fn has_emitters(&self) -> bool {
        !self.emitters.is_empty()
    }

    /// Whether there are lights whose shadows have soft edges: emitters, balls, and suns that are not points.
    pub fn has_soft_shadows(&self) -> bool {
        self.has_emitters() || self.suns.iter().any(|sun| sun.one_minus_cos > 0.0)
    }

    /// Samples an emitter from a point: which one by the number `choice`, the direction by `numbers`, all in [0, 1). None if
    /// no light comes from there.
    pub fn sample_emitter(
        &self,
        point: &SurfacePoint,
        choice: f32,
        numbers: [f32; 2],
    ) -> Option<LightSample> {
        let origin = point.spawn_origin();
        let emitters = &self.emitters;
        let (chosen, probability) = emitters.tree.sample(origin, point.shading_normal, choice)?;
        let Emitter { shape, source, .. } = &emitters.emitters[chosen];
        let towards = shape.sample(origin, numbers)?;
        let Towards {
            direction,
            distance,
            pdf,
        } = towards;
        let radiance = self.radiance_of(shape, source, origin, &towards);
        Some(LightSample {
            ray: Ray {
                // So far that a hit of the emitter itself is found.
                t_max: ((distance * (1.0 + f64::from(f32::EPSILON))) as f32).next_up(),
                ..point.spawn_ray(direction)
            },
            distance,
            primitive: match source {
                Source::Primitive(primitive) => *primitive,
                Source::Ball(_) => NO_PRIMITIVE,
            },
            radiance,
            pdf: probability * pdf,
        })
    }

    /// The pdf, over solid angle, that [`Scene::sample_emitter`] samples the direction of `ray`, which leaves a point with
    /// this shading normal, on the emitter that it hits; 0 if that is none.
    pub fn emitter_pdf(&self, shading_normal: Vec3, ray: &Ray, hit: &Hit) -> f32 {
        let emitters = &self.emitters;
        let Some(number) = emitters.at(self, ray, hit) else {
            return 0.0;
        };
        let shape = &emitters.emitters[number].shape;
        let probability = emitters
            .tree
            .probability(ray.origin, shading_normal, number);
        probability * shape.pdf(ray.origin, ray.direction, hit.t)
    }

    /// The radiance that an emitter sends to `origin`.
    fn radiance_of(&self, shape: &Shape, source: &Source, origin: Vec3, towards: &Towards) -> Vec3 {
        let direction = towards.direction.as_dvec3();
        let position = origin.as_dvec3() + towards.distance * direction;
        let unfiltered = |uv: Vec2| (uv, [Vec2::ZERO; 2]);
        match (shape, source) {
            (Shape::Triangle(shape), Source::Primitive(primitive)) => {
                let is_front = shape.front.dot(towards.direction) < 0.0;
                let triangle = &self.triangles[*primitive as usize];
                self.emitted_by_triangle(triangle, position, is_front, unfiltered)
            }
            (Shape::Sphere { center, .. }, Source::Primitive(primitive)) => {
                let normal = (position - center).normalize();
                let is_front = normal.dot(direction) < 0.0;
                self.emitted_by_sphere(*primitive as usize, normal, is_front, unfiltered)
            }
            (_, Source::Ball(light)) => {
                let light = &self.lights[*light];
                let away = origin - light.position;
                let is_outside = away.length_squared() > light.radius * light.radius;
                let disc = PI * light.radius * light.radius;
                light.intensity / disc
                    * light.cone.attenuation(away.normalize_or_zero())
                    * f32::from(is_outside)
            }
        }
    }
}
