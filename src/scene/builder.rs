//! Builds a scene from parts in world coordinates: chooses its origin, drops triangles without area, finds the features
//! of its materials.

use super::emitters::Emitters;
use super::mesh_material::MeshMaterial;
use super::resolved::{Scene, Triangle};
use crate::accel::Bvh;
use crate::geometry::{Mesh, Sphere};
use crate::light::{PointLight, Sky, Sun};
use crate::material::Material;
use crate::simd::Kernel;
use crate::texture::Texture;
use glam::{DVec3, Vec2, Vec3};

/// A mesh in world coordinates, in double precision.
#[derive(Clone, Debug)]
pub struct SourceMesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// A unit normal for each vertex, or none at all; a zero vector stands for the geometric normal.
    pub normals: Vec<Vec3>,
    /// Texture coordinates for each vertex, or none at all.
    pub uvs: Vec<Vec2>,
    /// Vertex indices, below the number of positions.
    pub triangles: Vec<[u32; 3]>,
    /// Its materials.
    pub material: MeshMaterial,
}

/// The parts of a scene in world coordinates. All numbers are finite and all indices valid: input is checked before.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    /// The ambient light, linear RGB.
    pub ambient: Vec3,
    /// What rays that leave the scene see.
    pub sky: Sky,
    /// All materials.
    pub materials: Vec<Material>,
    /// All textures.
    pub textures: Vec<Texture>,
    /// World positions and the lights; the position inside the light is ignored.
    pub lights: Vec<(DVec3, PointLight)>,
    /// The suns.
    pub suns: Vec<Sun>,
    /// Spheres in world coordinates with the indices of their materials.
    pub spheres: Vec<(Sphere, usize)>,
    /// Meshes.
    pub meshes: Vec<SourceMesh>,
    /// The instruction set that answers the scene's ray queries.
    pub kernel: Kernel,
}

impl SceneBuilder {
    /// About the most bytes of memory that meshes of so many triangles and vertices take until the scene is built:
    /// their source, the scene's, and what the construction of the acceleration structure needs for the moment.
    /// Measured: up to 264 bytes for each triangle with half a vertex.
    pub fn memory(triangles: usize, vertices: usize) -> u64 {
        240 * triangles as u64 + 100 * vertices as u64
    }

    /// Builds the scene and its acceleration structure. Also returns how many triangles without area were dropped.
    pub fn build(self) -> (Scene, usize) {
        let origin = self.origin();
        let relative = |p: DVec3| (p - origin).as_vec3();
        let mut dropped = 0;
        let mut triangle_vertices = Vec::new();
        let mut triangles = Vec::new();
        let mut meshes = Vec::new();
        let mut mesh_materials = Vec::new();
        for source in self.meshes {
            let mesh = Mesh {
                positions: source.positions.into_iter().map(relative).collect(),
                normals: source.normals,
                uvs: source.uvs,
            };
            for vertices in source.triangles {
                let Some(normal) = mesh.geometric_normal(vertices) else {
                    dropped += 1;
                    continue;
                };
                triangle_vertices.push(mesh.triangle(vertices));
                triangles.push(Triangle {
                    vertices,
                    mesh: meshes.len() as u32,
                    normal,
                });
            }
            meshes.push(mesh);
            mesh_materials.push(source.material);
        }
        let (spheres, sphere_materials): (Vec<Sphere>, Vec<usize>) = self
            .spheres
            .into_iter()
            .map(|(sphere, material)| {
                let center = sphere.center - origin;
                (Sphere { center, ..sphere }, material)
            })
            .unzip();
        let lights = self.lights.into_iter().map(|(position, light)| PointLight {
            position: relative(position),
            ..light
        });

        let mut used = sphere_materials.clone();
        let mut mixes = false;
        for material in &mesh_materials {
            match material {
                MeshMaterial::Uniform(id) => used.push(*id),
                MeshMaterial::PerVertex(ids) => {
                    used.extend(ids);
                    mixes = true;
                }
            }
        }
        let used = used.into_iter().map(|id| &self.materials[id]);
        let features = Material::features(used, mixes);
        let bvh = Bvh::new(&triangle_vertices, spheres.clone(), self.kernel);
        let bounds = bvh.bounds();
        let mut scene = Scene {
            origin,
            lights: lights.collect(),
            suns: self.suns,
            ambient: self.ambient,
            sky: self.sky,
            mesh_materials,
            triangles,
            sphere_materials,
            features,
            materials: self.materials,
            textures: self.textures,
            bvh,
            magnitude: bounds.max.max(-bounds.min).max_element().max(0.0),
            meshes,
            spheres,
            emitters: Emitters::default(),
        };
        scene.emitters = scene.find_emitters();
        (scene, dropped)
    }

    /// The median of all vertices and of the ends of spheres, axis by axis: a robust centre, so that single precision
    /// is finest where most of the scene is, whatever lies far away.
    fn origin(&self) -> DVec3 {
        let vertices = self.meshes.iter().flat_map(|m| m.positions.iter().copied());
        let spheres = self.spheres.iter().map(|(sphere, _)| sphere);
        let ends = spheres.flat_map(|s| [s.center - s.radius, s.center + s.radius]);
        let points: Vec<DVec3> = vertices.chain(ends).collect();
        DVec3::from_array([0, 1, 2].map(|axis| median(points.iter().map(|p| p[axis]))))
    }
}

/// The median of some numbers, the mean of the middle two of an even count; 0 of none.
fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    if numbers.is_empty() {
        return 0.0;
    }
    let half = numbers.len() / 2;
    let is_even = numbers.len() == 2 * half;
    let (below, upper, _) = numbers.select_nth_unstable_by(half, f64::total_cmp);
    let below = below.iter().copied().max_by(f64::total_cmp);
    let lower = below.filter(|_| is_even).unwrap_or(*upper);
    0.5 * lower + 0.5 * *upper
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Material = Material::lambert(Vec3::ONE);

    #[test]
    fn only_used_materials_have_features() {
        let materials = vec![
            PLAIN,
            Material {
                texture: Some(0),
                ..PLAIN
            },
            Material {
                specular: Vec3::X,
                ..PLAIN
            },
            Material {
                reflective: Vec3::X,
                ..PLAIN
            },
        ];
        let of_scene = |material: MeshMaterial| {
            let mesh = SourceMesh {
                positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
                normals: vec![],
                uvs: vec![],
                triangles: vec![[0, 1, 2]],
                material,
            };
            let builder = SceneBuilder {
                materials: materials.clone(),
                meshes: vec![mesh],
                ..SceneBuilder::default()
            };
            builder.build().0.features().index()
        };
        assert_eq!(
            [0, 1, 2, 3].map(|id| of_scene(MeshMaterial::Uniform(id))),
            [0, 1, 2, 4]
        );
        assert_eq!(of_scene(MeshMaterial::PerVertex([0, 0, 0])), 8);
        assert_eq!(of_scene(MeshMaterial::PerVertex([1, 2, 3])), 15);
    }
}
