//! Finds what emits in a scene, and what the light tree knows of it: place, power, and directions.

use super::emitter::{Shape, Triangle};
use super::emitters::{Emitter, Emitters, Pieces, Source};
use super::resolved::{self, Scene};
use crate::light::{LightBounds, LightTree};
use crate::material::{Emission, Material};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The most pieces that textured triangles are cut into, all together.
const MOST_PIECES: usize = 1 << 16;

/// The most rows of pieces of one triangle.
const MOST_ROWS: u32 = 32;

/// Texels along the edge of a piece.
const TEXELS: f32 = 8.0;

/// The least power of a piece, relative to what its material would have with a white texture: where the texture is not
/// black, the piece is sampled, however the mean of its texels is rounded.
const LEAST_POWER: f32 = 0.01;

impl Scene {
    /// Collects what emits.
    pub(super) fn find_emitters(&self) -> Emitters {
        let mut found = Emitters::default();
        let mut bounds = Vec::new();
        let is_emissive = |material: &Material| material.emission.radiance != Vec3::ZERO;
        if self.materials.iter().any(is_emissive) {
            let count = self.triangles.len() + self.spheres.len();
            found.of_primitive = vec![None; count];
            for index in 0..self.triangles.len() {
                self.add_triangle(index, &mut found, &mut bounds);
            }
            for index in 0..self.spheres.len() {
                self.add_sphere(index, &mut found, &mut bounds);
            }
        }
        for (index, light) in self.lights.iter().enumerate() {
            if light.radius > 0.0 && light.intensity != Vec3::ZERO {
                let shape = Shape::Sphere {
                    center: light.position.as_dvec3(),
                    radius: light.radius.into(),
                };
                let radiance = light.intensity / (PI * light.radius * light.radius);
                let source = Source::Ball(index);
                let emitter = Emitter {
                    shape,
                    source,
                    radiance,
                };
                // A cone is no bound of the directions in which the points of a ball shine.
                found.add(emitter, false, &mut bounds);
            }
        }
        found.tree = LightTree::new(&bounds);
        found
    }

    fn add_triangle(&self, index: usize, found: &mut Emitters, bounds: &mut Vec<LightBounds>) {
        let triangle = &self.triangles[index];
        let ids = self.materials_of(index);
        let emissions = || ids.iter().map(|&id| &self.materials[id].emission);
        if emissions().all(|emission| emission.radiance == Vec3::ZERO) {
            return;
        }
        let is_two_sided = emissions().any(|emission| emission.is_two_sided);
        let left = MOST_PIECES - found.emitters.len().min(MOST_PIECES);
        let rows = emissions().map(|emission| self.rows(triangle, emission));
        let rows = rows.max().unwrap_or(1);
        let rows = if (rows * rows) as usize > left {
            1
        } else {
            rows
        };
        found.of_primitive[index] = Some(Pieces {
            first: found.emitters.len() as u32,
            rows,
        });
        let mesh = &self.meshes[triangle.mesh as usize];
        let [a, b, c] = mesh.triangle(triangle.vertices);
        let front = self.front_normal(triangle);
        for weights in Pieces::corners(rows) {
            let uvs = weights.map(|[v, w]| {
                let weights = [1.0 - v - w, v, w].map(|weight| weight as f32);
                mesh.uv(triangle.vertices, weights)
            });
            let radiance: Vec3 = emissions().map(|e| self.mean_radiance(e, uvs)).sum();
            let radiance = radiance / ids.len() as f32;
            // From the first vertex: all that is the same in the three stays so.
            let vertices = weights.map(|[v, w]| {
                let [from, to, other] = [a, b, c].map(|vertex: Vec3| vertex.as_dvec3());
                (from + v * (to - from) + w * (other - from)).as_vec3()
            });
            let shape = Shape::Triangle(Triangle::new(vertices, front));
            let source = Source::Primitive(index as u32);
            found.add(
                Emitter {
                    shape,
                    source,
                    radiance,
                },
                is_two_sided,
                bounds,
            );
        }
    }

    fn add_sphere(&self, index: usize, found: &mut Emitters, bounds: &mut Vec<LightBounds>) {
        let emission = &self.materials[self.sphere_materials[index]].emission;
        if emission.radiance == Vec3::ZERO {
            return;
        }
        let primitive = self.triangles.len() + index;
        found.of_primitive[primitive] = Some(Pieces {
            first: found.emitters.len() as u32,
            rows: 1,
        });
        let sphere = &self.spheres[index];
        let shape = Shape::Sphere {
            center: sphere.center,
            radius: sphere.radius,
        };
        let whole = [Vec2::ZERO, 2.0 * Vec2::X, 2.0 * Vec2::Y];
        let emitter = Emitter {
            shape,
            source: Source::Primitive(primitive as u32),
            radiance: self.mean_radiance(emission, whole),
        };
        found.add(emitter, emission.is_two_sided, bounds);
    }

    /// Into how many rows a triangle is cut, so that the texture of what it emits changes little over a piece.
    fn rows(&self, triangle: &resolved::Triangle, emission: &Emission) -> u32 {
        let Some(texture) = emission.texture else {
            return 1;
        };
        let mesh = &self.meshes[triangle.mesh as usize];
        let corner = |weights| mesh.uv(triangle.vertices, weights);
        let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(corner);
        let size = {
            let (width, height) = self.textures[texture].size();
            Vec2::new(width as f32, height as f32)
        };
        let longest = [b - a, c - b, a - c].map(|edge| (edge * size).length());
        let longest = longest.into_iter().fold(0.0, f32::max);
        // Not a number and infinity become bounds.
        ((longest / TEXELS).ceil() as u32).clamp(1, MOST_ROWS)
    }

    /// The mean radiance around a piece with these texture coordinates.
    fn mean_radiance(&self, emission: &Emission, [a, b, c]: [Vec2; 3]) -> Vec3 {
        let texel = match emission.texture {
            Some(texture) => {
                let texel = self.textures[texture].filtered((a + b + c) / 3.0, [b - a, c - a]);
                texel.max(Vec3::splat(LEAST_POWER))
            }
            None => Vec3::ONE,
        };
        emission.radiance * texel
    }
}

impl Emitters {
    /// Adds an emitter and what a light tree knows of it.
    fn add(&mut self, emitter: Emitter, is_two_sided: bool, bounds: &mut Vec<LightBounds>) {
        let (axis, cos_theta_o) = match &emitter.shape {
            Shape::Triangle(triangle) => (triangle.front, 1.0),
            Shape::Sphere { .. } => (Vec3::Z, -1.0),
        };
        let sides = if is_two_sided { 2.0 } else { 1.0 };
        let mean_of_channels = emitter.radiance.element_sum() / 3.0;
        bounds.push(LightBounds {
            bounds: emitter.shape.bounds(),
            axis,
            cos_theta_o,
            cos_theta_e: 0.0,
            is_two_sided,
            power: PI * sides * emitter.shape.area() as f32 * mean_of_channels,
        });
        self.emitters.push(emitter);
    }
}
