//! The surface at a hit: position, normals, reflection, and where rays leave it.

use super::mesh_material::MeshMaterial;
use super::ray_offset::{ray_offset, round_towards_ray_origin};
use super::resolved::{Scene, Triangle};
use super::surface_differential::{middle_of, sphere_footprint};
use super::surface_point::SurfacePoint;
use crate::geometry::Hit;
use crate::material::{Bsdf, Features};
use crate::math::{NO_PRIMITIVE, Ray, RayDifferential};
use glam::{DVec3, Vec3};

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
        self.filtered_surface::<F>(ray, hit, &RayDifferential::ZERO)
    }

    /// The surface that `ray` sees at `hit`, with textures filtered over the footprint of its differential.
    #[inline(always)]
    pub fn filtered_surface<F: Features>(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &RayDifferential,
    ) -> SurfaceInteraction {
        let number = hit.primitive as usize;
        let point = match self.triangles.get(number) {
            Some(triangle) => self.triangle_point::<F>(ray, hit, differential, triangle),
            None => {
                let sphere = number - self.triangles.len();
                self.sphere_point::<F>(ray, hit, differential, sphere)
            }
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
    fn triangle_point<F: Features>(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &RayDifferential,
        triangle: &Triangle,
    ) -> ShapePoint {
        let position = ray.at(hit.t);
        let vertices = triangle.vertices;
        let mesh = &self.meshes[triangle.mesh as usize];
        let material = &self.mesh_materials[triangle.mesh as usize];
        let (is_uniform, is_textured) = match material {
            MeshMaterial::Uniform(id) => (true, self.is_textured::<F>(*id)),
            MeshMaterial::PerVertex(_) => (false, F::TEXTURES),
        };
        // Flat and of one colour: the weights are not needed.
        let weights = if is_uniform && !is_textured && mesh.normals.is_empty() {
            [1.0, 0.0, 0.0]
        } else {
            mesh.weights(vertices, position)
        };
        let (uv, footprint) = if is_textured {
            let footprint = self.triangle_footprint(ray, hit, differential, triangle);
            let uv = mesh.uv(vertices, weights);
            (middle_of(footprint, uv, differential), footprint)
        } else {
            Default::default()
        };
        let at = |id: usize| self.materials[id].bsdf::<F>(uv, footprint, &self.textures);
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
    fn sphere_point<F: Features>(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &RayDifferential,
        index: usize,
    ) -> ShapePoint {
        let sphere = &self.spheres[index];
        let normal = (ray.at(hit.t) - sphere.center).normalize();
        let id = self.sphere_materials[index];
        let (uv, footprint) = if self.is_textured::<F>(id) {
            let footprint = sphere_footprint(ray, hit, differential, sphere, normal);
            let uv = sphere.uv(normal);
            (middle_of(footprint, uv, differential), footprint)
        } else {
            Default::default()
        };
        ShapePoint {
            position: sphere.center + normal * sphere.radius,
            geometric_normal: normal.as_vec3(),
            shading_normal: normal.as_vec3(),
            bsdf: self.materials[id].bsdf::<F>(uv, footprint, &self.textures),
            cannot_hit_again: [true, false],
        }
    }

    #[inline(always)]
    fn is_textured<F: Features>(&self, material: usize) -> bool {
        F::TEXTURES && self.materials[material].texture.is_some()
    }
}
