//! The shapes of a scene one by one: vertices, mesh and material of each.

use super::mesh_material::MeshMaterial;
use super::resolved::Scene;
use crate::geometry::Sphere;
use crate::material::Material;
use glam::Vec3;

impl Scene {
    /// The vertices of a triangle in scene space.
    pub fn triangle_vertices(&self, triangle: usize) -> [Vec3; 3] {
        let triangle = &self.triangles[triangle];
        self.meshes[triangle.mesh as usize].triangle(triangle.vertices)
    }

    /// The index of a triangle's mesh.
    pub fn mesh_of(&self, triangle: usize) -> usize {
        self.triangles[triangle].mesh as usize
    }

    /// The unit normal of a triangle, on the side that sees its vertices counter-clockwise.
    pub fn triangle_normal(&self, triangle: usize) -> Vec3 {
        self.triangles[triangle].normal
    }

    /// The spheres in scene space.
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// The materials of a mesh.
    pub fn mesh_material(&self, mesh: usize) -> &MeshMaterial {
        &self.mesh_materials[mesh]
    }

    /// The index of a sphere's material.
    pub fn sphere_material(&self, sphere: usize) -> usize {
        self.sphere_materials[sphere]
    }

    /// All materials, used or not.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The indices of a primitive's materials: one, or those of a triangle's vertices.
    pub(super) fn materials_of(&self, primitive: usize) -> &[usize] {
        match self.triangles.get(primitive) {
            Some(triangle) => match &self.mesh_materials[triangle.mesh as usize] {
                MeshMaterial::Uniform(id) => std::slice::from_ref(id),
                MeshMaterial::PerVertex(ids) => ids,
            },
            None => std::slice::from_ref(&self.sphere_materials[primitive - self.triangles.len()]),
        }
    }

    /// The indices of the materials that shapes have, rising.
    pub fn used_materials(&self) -> Vec<usize> {
        let mut used = vec![false; self.materials.len()];
        for triangle in &self.triangles {
            match &self.mesh_materials[triangle.mesh as usize] {
                MeshMaterial::Uniform(id) => used[*id] = true,
                MeshMaterial::PerVertex(ids) => ids.iter().for_each(|&id| used[id] = true),
            }
        }
        self.sphere_materials.iter().for_each(|&id| used[id] = true);
        (0..used.len()).filter(|&id| used[id]).collect()
    }
}
