//! The light that the surfaces of a scene send out by themselves.

use super::mesh_material::MeshMaterial;
use super::resolved::{Scene, Triangle};
use super::surface_differential::{middle_of, sphere_footprint};
use crate::geometry::Hit;
use crate::material::Emission;
use crate::math::{Ray, RayDifferential};
use glam::{DVec3, Vec2, Vec3};

impl Scene {
    /// The radiance that the surface at `hit` sends back along `ray` by itself, with textures filtered over the footprint
    /// of its differential.
    pub fn emitted(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> Vec3 {
        if !self.emitters.is_emitter(hit.primitive) {
            return Vec3::ZERO;
        }
        let number = hit.primitive as usize;
        let position = ray.at(hit.t);
        match self.triangles.get(number) {
            Some(triangle) => {
                let is_front = self.front_normal(triangle).dot(ray.direction) < 0.0;
                let footprint = self.triangle_footprint(ray, hit, differential, triangle);
                self.emitted_by_triangle(triangle, position, is_front, |uv| {
                    (middle_of(footprint, uv, differential), footprint)
                })
            }
            None => {
                let sphere = &self.spheres[number - self.triangles.len()];
                let normal = (position - sphere.center).normalize();
                let is_front = normal.as_vec3().dot(ray.direction) < 0.0;
                let footprint = sphere_footprint(ray, hit, differential, sphere, normal);
                self.emitted_by_sphere(number, normal, is_front, |uv| {
                    (middle_of(footprint, uv, differential), footprint)
                })
            }
        }
    }

    /// The unit normal of a triangle on the side that emits if one does: that of its vertex normals.
    pub(super) fn front_normal(&self, triangle: &Triangle) -> Vec3 {
        let mesh = &self.meshes[triangle.mesh as usize];
        let third = [1.0 / 3.0; 3];
        let shading_normal = mesh.shading_normal(triangle.vertices, third, triangle.normal);
        if shading_normal.dot(triangle.normal) < 0.0 {
            -triangle.normal
        } else {
            triangle.normal
        }
    }

    /// The radiance of a triangle at a position on it, on its front or its back. `filter` gives, for texture coordinates,
    /// those of the middle of the footprint and the footprint.
    pub(super) fn emitted_by_triangle(
        &self,
        triangle: &Triangle,
        position: DVec3,
        is_front: bool,
        filter: impl Fn(Vec2) -> (Vec2, [Vec2; 2]),
    ) -> Vec3 {
        let mesh = &self.meshes[triangle.mesh as usize];
        let weights = || mesh.weights(triangle.vertices, position);
        let uv = || filter(mesh.uv(triangle.vertices, weights()));
        let of_material = |id: usize| self.emitted_by(&self.materials[id].emission, is_front, uv);
        match &self.mesh_materials[triangle.mesh as usize] {
            MeshMaterial::Uniform(id) => of_material(*id),
            MeshMaterial::PerVertex(ids) => {
                let weighted = ids.iter().zip(weights());
                weighted.map(|(&id, weight)| weight * of_material(id)).sum()
            }
        }
    }

    /// As [`Scene::emitted_by_triangle`], of a sphere, by its primitive number, at an outward unit normal.
    pub(super) fn emitted_by_sphere(
        &self,
        primitive: usize,
        normal: DVec3,
        is_front: bool,
        filter: impl Fn(Vec2) -> (Vec2, [Vec2; 2]),
    ) -> Vec3 {
        let index = primitive - self.triangles.len();
        let emission = &self.materials[self.sphere_materials[index]].emission;
        self.emitted_by(emission, is_front, || {
            filter(self.spheres[index].uv(normal))
        })
    }

    fn emitted_by(
        &self,
        emission: &Emission,
        is_front: bool,
        uv: impl Fn() -> (Vec2, [Vec2; 2]),
    ) -> Vec3 {
        if !is_front && !emission.is_two_sided {
            return Vec3::ZERO;
        }
        match emission.texture {
            Some(id) => {
                let (uv, footprint) = uv();
                emission.radiance * self.textures[id].filtered(uv, footprint)
            }
            None => emission.radiance,
        }
    }
}
