//! The surface at a hit: position, normals, reflection, and where rays leave it.

use super::mesh_material::MeshMaterial;
use super::ray_offset::{ray_offset, round_towards_ray_origin};
use super::resolved::{Scene, Triangle};
use super::surface_point::SurfacePoint;
use crate::geometry::Hit;
use crate::material::{Bsdf, Features};
use crate::math::{NO_PRIMITIVE, Ray};
use glam::{DVec3, Vec2, Vec3};

/// The surface at a hit, seen from the ray's side.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// The point, on the viewer's side.
    pub point: SurfacePoint,
    /// How it reflects light.
    pub bsdf: Bsdf,
}

/// A point on a shape, before the viewer's side is known.
struct ShapePoint {
    position: DVec3,
    geometric_normal: Vec3,
    shading_normal: Vec3,
    bsdf: Bsdf,
    /// Whether rays that leave on the normal's side, and on the other, cannot hit the shape again.
    cannot_hit_again: [bool; 2],
}

impl Scene {
    /// The surface that `ray` sees at `hit`.
    #[inline(always)]
    pub fn surface<F: Features>(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let number = hit.primitive as usize;
        let point = match self.triangles.get(number) {
            Some(triangle) => self.triangle_point::<F>(ray.at(hit.t), triangle),
            None => self.sphere_point::<F>(ray.at(hit.t), number - self.triangles.len()),
        };
        let outside = point.geometric_normal.dot(ray.direction) < 0.0;
        let geometric_normal = if outside {
            point.geometric_normal
        } else {
            -point.geometric_normal
        };
        // Interpolated normals are flipped to the side that is seen.
        let agrees = point.shading_normal.dot(geometric_normal) >= 0.0;
        let shading_normal = if agrees {
            point.shading_normal
        } else {
            -point.shading_normal
        };
        let position = round_towards_ray_origin(point.position, ray, hit.t);
        let magnitude = ray.origin.abs().max_element().max(self.magnitude);
        let cannot_hit_again = point.cannot_hit_again[usize::from(!outside)];
        SurfaceInteraction {
            point: SurfacePoint {
                position,
                geometric_normal,
                shading_normal,
                offset: ray_offset(position, geometric_normal, magnitude),
                exclude: if cannot_hit_again {
                    hit.primitive
                } else {
                    NO_PRIMITIVE
                },
            },
            bsdf: point.bsdf,
        }
    }

    /// Whether `ray` hits the front of a shape: the side that [`Scene::normal`] points to.
    pub fn is_front(&self, ray: &Ray, hit: &Hit) -> bool {
        self.normal(ray, hit).dot(ray.direction) < 0.0
    }

    /// The unit normal of what `ray` hits, whichever side it hits: out of a sphere, and of a triangle to the side
    /// from which its vertices run counter-clockwise.
    pub fn normal(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        let number = hit.primitive as usize;
        match self.triangles.get(number) {
            Some(triangle) => triangle.normal,
            None => {
                let sphere = &self.spheres[number - self.triangles.len()];
                (ray.at(hit.t) - sphere.center).normalize().as_vec3()
            }
        }
    }

    #[inline(always)]
    fn triangle_point<F: Features>(&self, position: DVec3, triangle: &Triangle) -> ShapePoint {
        let vertices = triangle.vertices;
        let mesh = &self.meshes[triangle.mesh as usize];
        let material = &self.mesh_materials[triangle.mesh as usize];
        let is_textured = |id: usize| F::TEXTURES && self.materials[id].texture.is_some();
        let is_uniform = match material {
            MeshMaterial::Uniform(id) => !is_textured(*id),
            MeshMaterial::PerVertex(_) => false,
        };
        // Flat and of one colour: the weights are not needed.
        let weights = if is_uniform && mesh.normals.is_empty() {
            [1.0, 0.0, 0.0]
        } else {
            mesh.weights(vertices, position)
        };
        let uv = if F::TEXTURES {
            mesh.uv(vertices, weights)
        } else {
            Vec2::ZERO
        };
        let at = |material: usize| self.materials[material].bsdf::<F>(uv, &self.textures);
        ShapePoint {
            position,
            geometric_normal: triangle.normal,
            shading_normal: mesh.shading_normal(vertices, weights, triangle.normal),
            bsdf: match material {
                MeshMaterial::Uniform(id) => at(*id),
                MeshMaterial::PerVertex(ids) => Bsdf::barycentric(ids.map(at), weights),
            },
            cannot_hit_again: [true, true],
        }
    }

    #[inline(always)]
    fn sphere_point<F: Features>(&self, position: DVec3, index: usize) -> ShapePoint {
        let sphere = &self.spheres[index];
        let normal = (position - sphere.center).normalize();
        let material = &self.materials[self.sphere_materials[index]];
        let uv = match material.texture {
            Some(_) if F::TEXTURES => sphere.uv(normal),
            _ => Vec2::ZERO,
        };
        ShapePoint {
            position: sphere.center + normal * sphere.radius,
            geometric_normal: normal.as_vec3(),
            shading_normal: normal.as_vec3(),
            bsdf: material.bsdf::<F>(uv, &self.textures),
            cannot_hit_again: [true, false],
        }
    }
}
