//! The resolved scene: immutable, checked, with its acceleration structure.
//!
//! What the renderer may assume of a [`Scene`]:
//!
//! - Every number is finite.
//! - Coordinates are in metres, right-handed with +Y up, in single precision relative to [`Scene::origin`]. The origin
//!   is the median of the geometry, so that precision is finest where most of the scene is.
//! - Every index of a vertex, a material or a texture exists.
//! - No triangle has zero area; its geometric normal is of unit length, on the side that sees its vertices
//!   counter-clockwise.
//! - A mesh has one normal per vertex or none; each is of unit length, or zero for the geometric normal. It has one
//!   texture coordinate per vertex or none.
//! - A mesh with a material per vertex has exactly one triangle.
//! - Sphere radii are above 0.
//! - Colours are linear RGB. Diffuse and mirror weights are in 0..1; specular weights, exponents, light intensities,
//!   ambient and background are 0 or more.
//! - Textures have at least one texel and are sampled as linear RGB in 0..1.
//! - [`Scene::features`] holds every feature that a used material has; code that is compiled for fewer features than
//!   these gives wrong colours.
//! - Primitives are numbered: triangles first, then spheres.
//!
//! Knows nothing of files, cameras or integrators.

mod builder;
mod shadow_packet;
mod surface;
mod surface_point;

pub use builder::{MeshMaterial, SceneBuilder, SourceMesh};
pub use shadow_packet::ShadowPacket;
pub use surface::Surface;
pub use surface_point::{SurfacePoint, SurfacePointPacket};

use crate::accel::{Bvh, Traversal};
use crate::geometry::{Hit, Mesh, Sphere, VertexIndices};
use crate::light::PointLight;
use crate::material::{FeatureSet, Material};
use crate::math::{Aabb, Ray};
use crate::simd::Kernel;
use crate::texture::Texture;
use glam::{DVec3, Vec3};

/// Geometry, materials and lights.
#[derive(Debug)]
pub struct Scene {
    /// The origin of the scene's own coordinates, in world coordinates.
    pub origin: DVec3,
    /// The lights.
    pub lights: Vec<PointLight>,
    /// The scene's ambient colour.
    pub ambient: Vec3,
    /// The radiance along a ray that leaves the scene.
    pub background: Vec3,
    meshes: Vec<Mesh>,
    mesh_materials: Vec<MeshMaterial>,
    triangles: Vec<Triangle>,
    spheres: Vec<Sphere>,
    sphere_materials: Vec<usize>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    /// The features of its used materials.
    features: FeatureSet,
    bvh: Bvh,
    /// The largest absolute coordinate of all shapes.
    magnitude: f32,
}

/// The shading data of a triangle.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    vertices: VertexIndices,
    /// The index of its mesh.
    mesh: u32,
    /// Unit normal of its winding.
    normal: Vec3,
}

impl Scene {
    /// The closest hit of a ray, or none.
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Option<Hit> {
        self.bvh.closest(ray, traversal)
    }

    /// The closest hit of each ray, or none; fast for coherent rays.
    pub fn closest_coherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        self.bvh.closest_coherent(rays, hits, traversal);
    }

    /// As [`Scene::closest_coherent`], for any number of incoherent rays.
    pub fn closest_incoherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        self.bvh.closest_incoherent(rays, hits, traversal);
    }

    /// The shadow rays from points to a target, not yet traced.
    pub fn shadow_rays_to(&self, points: &SurfacePointPacket, target: Vec3) -> ShadowPacket {
        points.shadow_rays_to(target, self.kernel())
    }

    /// The mask of the rays of a packet that are occluded; fast for coherent rays.
    pub fn occluded_coherent(&self, packet: &ShadowPacket, traversal: &mut Traversal) -> u32 {
        self.bvh.occluded_coherent(&packet.rays, traversal)
    }

    /// As [`Scene::occluded_coherent`], for packets of incoherent rays.
    pub fn occluded_incoherent(
        &self,
        packets: &[ShadowPacket],
        traversal: &mut Traversal,
    ) -> Vec<u32> {
        let packets = packets.iter().map(|packet| &packet.rays);
        self.bvh.occluded_incoherent(packets, traversal)
    }

    /// The distance from a point in world coordinates to the closest surface, or none if it is not below
    /// `within`; in metres.
    pub fn closest_point_distance(&self, point: DVec3, within: f64) -> Option<f64> {
        self.bvh.closest_point_distance(point - self.origin, within)
    }

    /// The instruction set of ray queries and irradiance lookups.
    pub fn kernel(&self) -> Kernel {
        self.bvh.kernel()
    }

    /// The features of its used materials.
    pub fn features(&self) -> FeatureSet {
        self.features
    }

    /// The box around all shapes, relative to [`Scene::origin`]; empty for an empty scene.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The number of spheres.
    pub fn sphere_count(&self) -> usize {
        self.spheres.len()
    }

    /// The image textures.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Bytes of geometry, acceleration structure and textures.
    pub fn memory(&self) -> usize {
        let meshes = self.meshes.iter().map(|mesh| {
            size_of_val(&*mesh.positions) + size_of_val(&*mesh.normals) + size_of_val(&*mesh.uvs)
        });
        let triangles = size_of_val(&*self.triangles);
        let textures = self.textures.iter().map(Texture::memory);
        self.bvh.memory() + triangles + meshes.sum::<usize>() + textures.sum::<usize>()
    }
}
