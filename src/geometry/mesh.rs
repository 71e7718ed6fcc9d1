//! Indexed triangle meshes with interpolated normals and texture coordinates.

use super::triangle;
use glam::{DVec3, Vec2, Vec3};

/// The vertices of a mesh, shared by its triangles.
///
/// `normals` and `uvs` are empty or as long as `positions`. Vertices with the same position have
/// bit-identical coordinates, so that no ray passes between neighbours.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions of the vertices, in metres.
    pub positions: Vec<Vec3>,
    /// Unit shading normals of the vertices; a zero vector asks for the triangle's own.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the vertices.
    pub uvs: Vec<Vec2>,
}

/// The indices of a triangle's vertices in its mesh.
pub type VertexIndices = [u32; 3];

impl Mesh {
    /// The positions of a triangle's vertices.
    #[inline(always)]
    pub fn triangle(&self, [a, b, c]: VertexIndices) -> [Vec3; 3] {
        [
            self.positions[a as usize],
            self.positions[b as usize],
            self.positions[c as usize],
        ]
    }

    /// The unit normal of a triangle's winding (counter-clockwise seen from its side), or none for
    /// a triangle without area.
    pub fn geometric_normal(&self, vertices: VertexIndices) -> Option<Vec3> {
        // In double precision the normal of a sliver is as good as that of any other triangle.
        let normal = triangle::normal(self.triangle(vertices));
        let largest = normal.abs().max_element();
        // Scaled first: the square of a tiny triangle's area would be 0.
        (largest > 0.0).then(|| (normal / largest).normalize().as_vec3())
    }

    /// The barycentric weights of a triangle's vertices at `point`, which lies on it; their sum is 1.
    #[inline(always)]
    pub fn weights(&self, vertices: VertexIndices, point: DVec3) -> [f32; 3] {
        let (u, v) = triangle::barycentric(point, self.triangle(vertices));
        [(1.0 - u - v) as f32, u as f32, v as f32]
    }

    /// The unit shading normal at barycentric weights; `geometric_normal` where the mesh has no other.
    #[inline(always)]
    pub fn shading_normal(
        &self,
        vertices: VertexIndices,
        weights: [f32; 3],
        geometric_normal: Vec3,
    ) -> Vec3 {
        if self.normals.is_empty() {
            return geometric_normal;
        }
        let [a, b, c] = self.vertex_normals(vertices, geometric_normal);
        let sum = weights[0] * a + weights[1] * b + weights[2] * c;
        sum.normalize_or(geometric_normal)
    }

    /// The texture coordinates at barycentric weights; zero where the mesh has none.
    #[inline(always)]
    pub fn uv(&self, vertices: VertexIndices, weights: [f32; 3]) -> Vec2 {
        if self.uvs.is_empty() {
            return Vec2::ZERO;
        }
        let mut sum = Vec2::ZERO;
        for (vertex, weight) in vertices.into_iter().zip(weights) {
            sum += weight * self.uvs[vertex as usize];
        }
        sum
    }

    /// The changes of the weights of a triangle's second and third vertex for a point that moves by `step` in its plane.
    #[inline(always)]
    pub fn weight_changes(&self, vertices: VertexIndices, step: Vec3) -> [f32; 2] {
        let (u, v) = triangle::barycentric_changes(step.as_dvec3(), self.triangle(vertices));
        [u as f32, v as f32]
    }

    /// The change of [`Mesh::uv`] for changes of the weights of the second and third vertex.
    #[inline(always)]
    pub fn uv_change(&self, vertices: VertexIndices, weight_changes: [f32; 2]) -> Vec2 {
        if self.uvs.is_empty() {
            return Vec2::ZERO;
        }
        let [a, b, c] = vertices.map(|vertex| self.uvs[vertex as usize]);
        weight_changes[0] * (b - a) + weight_changes[1] * (c - a)
    }

    /// The change of [`Mesh::shading_normal`] at `weights`, for changes of the weights of the second and third vertex.
    #[inline(always)]
    pub fn shading_normal_change(
        &self,
        vertices: VertexIndices,
        weights: [f32; 3],
        weight_changes: [f32; 2],
        geometric_normal: Vec3,
    ) -> Vec3 {
        if self.normals.is_empty() {
            return Vec3::ZERO;
        }
        let [a, b, c] = self.vertex_normals(vertices, geometric_normal);
        let sum = weights[0] * a + weights[1] * b + weights[2] * c;
        let change = weight_changes[0] * (b - a) + weight_changes[1] * (c - a);
        // Only what is perpendicular to a vector turns it.
        let turn = |normal| (change - normal * change.dot(normal)) / sum.length();
        sum.try_normalize().map_or(Vec3::ZERO, turn)
    }

    /// The shading normals of a triangle's vertices; `geometric_normal` for those that have none.
    #[inline(always)]
    fn vertex_normals(&self, vertices: VertexIndices, geometric_normal: Vec3) -> [Vec3; 3] {
        vertices.map(|vertex| {
            let normal = self.normals[vertex as usize];
            if normal == Vec3::ZERO {
                geometric_normal
            } else {
                normal
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_normal_and_uv() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z, Vec3::X, Vec3::ZERO],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::new(0.0, 4.0)],
        };
        let vertices = [0, 1, 2];
        let weights = mesh.weights(vertices, DVec3::new(0.5, 0.25, 0.0));
        assert_eq!(weights, [0.25, 0.5, 0.25]);
        assert_eq!(mesh.geometric_normal(vertices), Some(Vec3::Z));
        // The third vertex has no normal of its own: it takes the triangle's.
        let expected = Vec3::new(0.5, 0.0, 0.5).normalize();
        let normal = mesh.shading_normal(vertices, weights, Vec3::Z);
        assert!((normal - expected).length() < 1e-6);
        assert_eq!(mesh.uv(vertices, weights), Vec2::new(0.5, 1.0));
    }

    #[test]
    fn tiny_triangles_have_a_normal_and_flat_ones_have_none() {
        let mesh = Mesh {
            positions: vec![
                Vec3::ZERO,
                Vec3::X,
                Vec3::X * 2.0,
                Vec3::X * 1e-30,
                Vec3::Y * 1e-30,
            ],
            ..Mesh::default()
        };
        assert_eq!(mesh.geometric_normal([0, 1, 2]), None);
        assert_eq!(mesh.geometric_normal([0, 0, 1]), None);
        assert_eq!(mesh.geometric_normal([0, 3, 4]), Some(Vec3::Z));
    }
}
