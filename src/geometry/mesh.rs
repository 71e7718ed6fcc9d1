use super::triangle;
use glam::{DVec3, Vec2, Vec3};

/// Triangles in world space that share corners.
///
/// `normals` and `uvs` are empty or as long as `positions`. Corners with the same position have
/// bit-identical coordinates, so that no ray slips between neighbours.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// World-space positions of the corners.
    pub positions: Vec<Vec3>,
    /// World-space unit shading normals of the corners; a zero vector asks for the triangle's own.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the corners.
    pub uvs: Vec<Vec2>,
    /// Three corner indices for each triangle. No triangle has zero area.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Removes the triangles without area, which no ray can hit and which have no normal.
    /// Returns how many there were.
    pub fn drop_degenerate(&mut self) -> usize {
        let before = self.triangles.len();
        let positions = &self.positions;
        self.triangles.retain(|corners| {
            triangle::normal(corners.map(|i| positions[i as usize])) != DVec3::ZERO
        });
        before - self.triangles.len()
    }

    /// The three corner positions of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[triangle];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The unit normal of a triangle's winding (counter-clockwise seen from its side).
    pub fn geometric_normal(&self, triangle: usize) -> Vec3 {
        // In double precision the normal of a sliver is as good as that of any other triangle.
        triangle::normal(self.corners(triangle)).normalize().as_vec3()
    }

    /// The weights of a triangle's corners at `point`, which lies on it; their sum is 1.
    pub fn weights(&self, triangle: usize, point: DVec3) -> [f32; 3] {
        let (u, v) = triangle::barycentric(point, self.corners(triangle));
        [(1.0 - u - v) as f32, u as f32, v as f32]
    }

    /// The unit shading normal at corner weights; `geometric_normal` where the mesh has no other.
    pub fn shading_normal(
        &self,
        triangle: usize,
        weights: [f32; 3],
        geometric_normal: Vec3,
    ) -> Vec3 {
        if self.normals.is_empty() {
            return geometric_normal;
        }
        let mut sum = Vec3::ZERO;
        for (&corner, weight) in self.triangles[triangle].iter().zip(weights) {
            let normal = self.normals[corner as usize];
            let has_none = normal == Vec3::ZERO;
            sum += weight * if has_none { geometric_normal } else { normal };
        }
        sum.normalize_or(geometric_normal)
    }

    /// The texture coordinates at corner weights; zero where the mesh has none.
    pub fn uv(&self, triangle: usize, weights: [f32; 3]) -> Vec2 {
        if self.uvs.is_empty() {
            return Vec2::ZERO;
        }
        let mut sum = Vec2::ZERO;
        for (&corner, weight) in self.triangles[triangle].iter().zip(weights) {
            sum += weight * self.uvs[corner as usize];
        }
        sum
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
            triangles: vec![[0, 1, 2]],
        };
        let weights = mesh.weights(0, DVec3::new(0.5, 0.25, 0.0));
        assert_eq!(weights, [0.25, 0.5, 0.25]);
        assert_eq!(mesh.geometric_normal(0), Vec3::Z);
        // The third corner has no normal of its own: it takes the triangle's.
        let expected = Vec3::new(0.5, 0.0, 0.5).normalize();
        let normal = mesh.shading_normal(0, weights, Vec3::Z);
        assert!((normal - expected).length() < 1e-6);
        assert_eq!(mesh.uv(0, weights), Vec2::new(0.5, 1.0));
    }

    #[test]
    fn drops_triangles_without_area_and_keeps_tiny_ones() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::new(1e-20, 1e-20, 0.0)],
            triangles: vec![[0, 1, 2], [0, 0, 1], [0, 1, 3]],
            ..Mesh::default()
        };
        assert_eq!(mesh.drop_degenerate(), 2);
        assert_eq!(mesh.triangles, [[0, 1, 3]]);
    }
}
