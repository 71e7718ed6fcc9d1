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

/// What varies over a triangle, at one of its points.
#[derive(Clone, Copy, Debug)]
pub struct MeshPoint {
    /// Unit geometric normal of the winding (counter-clockwise seen from its side).
    pub geometric_normal: Vec3,
    /// Unit shading normal.
    pub shading_normal: Vec3,
    /// Texture coordinates; zero where the mesh has none.
    pub uv: Vec2,
    /// The weights of the three corners; their sum is 1.
    pub weights: [f32; 3],
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
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Interpolates over a triangle at `point`, which lies on it.
    pub fn interpolate(&self, triangle: usize, point: DVec3) -> MeshPoint {
        let indices = self.triangles[triangle];
        let corners = self.corners(triangle);
        let (u, v) = triangle::barycentric(point, corners);
        let weights = [(1.0 - u - v) as f32, u as f32, v as f32];
        let [wa, wb, wc] = weights;
        // In double precision the normal of a sliver is as good as that of any other triangle.
        let geometric_normal = triangle::normal(corners).normalize().as_vec3();
        let mut shading_normal = geometric_normal;
        if !self.normals.is_empty() {
            let [na, nb, nc] = indices.map(|i| match self.normals[i as usize] {
                Vec3::ZERO => geometric_normal,
                n => n,
            });
            shading_normal = (na * wa + nb * wb + nc * wc).normalize_or(geometric_normal);
        }
        let mut uv = Vec2::ZERO;
        if !self.uvs.is_empty() {
            let [ta, tb, tc] = indices.map(|i| self.uvs[i as usize].as_dvec2());
            uv = (ta * (1.0 - u - v) + tb * u + tc * v).as_vec2();
        }
        MeshPoint {
            geometric_normal,
            shading_normal,
            uv,
            weights,
        }
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
        let c = mesh.interpolate(0, DVec3::new(0.5, 0.25, 0.0));
        assert_eq!(c.weights, [0.25, 0.5, 0.25]);
        assert_eq!(c.geometric_normal, Vec3::Z);
        // The third corner has no normal of its own: it takes the triangle's.
        let expected = Vec3::new(0.5, 0.0, 0.5).normalize();
        assert!((c.shading_normal - expected).length() < 1e-6);
        assert_eq!(c.uv, Vec2::new(0.5, 1.0));
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
