//! A resolved scene and the ray queries on it.

use super::emitters::Emitters;
use super::mesh_material::MeshMaterial;
use super::shadow_packet::ShadowPacket;
use super::surface_point::{SurfacePoint, SurfacePointPacket};
use crate::accel::{Bvh, ClearanceCone, QueryState, RayPacket};
use crate::geometry::{Hit, Mesh, Sphere, VertexIndices};
use crate::light::{PointLight, Sky, Sun};
use crate::material::{FeatureSet, Material};
use crate::math::{Aabb, Ray};
use crate::simd::Kernel;
use crate::texture::Texture;
use glam::{DVec3, Vec3};

/// Geometry, materials and lights.
#[derive(Debug)]
pub struct Scene {
    /// The origin of scene space, in world coordinates.
    pub origin: DVec3,
    /// The point lights.
    pub lights: Vec<PointLight>,
    /// The suns.
    pub suns: Vec<Sun>,
    /// The ambient light, linear RGB: of it, 0.3 stands for all bounces that are not computed.
    pub ambient: Vec3,
    /// What rays that leave the scene see.
    pub sky: Sky,
    pub(super) meshes: Vec<Mesh>,
    pub(super) mesh_materials: Vec<MeshMaterial>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) spheres: Vec<Sphere>,
    pub(super) sphere_materials: Vec<usize>,
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    pub(super) emitters: Emitters,
    /// The features of its used materials.
    pub(super) features: FeatureSet,
    pub(super) bvh: Bvh,
    /// The largest absolute coordinate of all shapes.
    pub(super) magnitude: f32,
}

/// The shading data of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) vertices: VertexIndices,
    /// The index of its mesh.
    pub(super) mesh: u32,
    /// Unit normal of its winding.
    pub(super) normal: Vec3,
}

impl Scene {
    /// The closest hit of a ray, or none.
    pub fn closest(&self, ray: &Ray, query_state: &mut QueryState) -> Option<Hit> {
        self.bvh.closest(ray, query_state)
    }

    /// Whether a ray hits anything.
    pub fn occluded(&self, ray: &Ray, query_state: &mut QueryState) -> bool {
        self.bvh.occluded(ray, query_state)
    }

    /// The mask of one to sixteen rays that hit anything; fast for coherent rays.
    pub fn occluded_mask(&self, rays: &[Ray], query_state: &mut QueryState) -> u32 {
        self.bvh
            .occluded_coherent(&RayPacket::new(rays), query_state)
    }

    /// The closest hit of each ray, or none; fast for coherent rays.
    pub fn closest_coherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        self.bvh.closest_coherent(rays, hits, query_state);
    }

    /// As [`Scene::closest_coherent`], for any number of incoherent rays.
    pub fn closest_incoherent(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        query_state: &mut QueryState,
    ) {
        self.bvh.closest_incoherent(rays, hits, query_state);
    }

    /// The shadow rays from points to a target, in scene space, not yet traced.
    pub fn shadow_rays_to(&self, points: &SurfacePointPacket, target: Vec3) -> ShadowPacket {
        points.shadow_rays_to(target, self.kernel())
    }

    /// The mask of the rays of a packet that are occluded; fast for coherent rays.
    pub fn occluded_coherent(&self, packet: &ShadowPacket, query_state: &mut QueryState) -> u32 {
        self.bvh.occluded_coherent(&packet.rays, query_state)
    }

    /// As [`Scene::occluded_coherent`], for packets of incoherent rays.
    pub fn occluded_incoherent(
        &self,
        packets: &[ShadowPacket],
        query_state: &mut QueryState,
    ) -> Vec<u32> {
        let packets = packets.iter().map(|packet| &packet.rays);
        self.bvh.occluded_incoherent(packets, query_state)
    }

    /// The distance from a point in world coordinates to the closest surface, or none if it is not below
    /// `within`; in metres.
    pub fn closest_point_distance(&self, point: DVec3, within: f64) -> Option<f64> {
        self.bvh.closest_point_distance(point - self.origin, within)
    }

    /// A lower bound of the distance, in metres, from a surface point to the nearest surface that rises above its tangent
    /// plane, at an elevation of at least this sine; none if that is not below `within`.
    pub fn clearance(&self, point: &SurfacePoint, sine: f64, within: f64) -> Option<f64> {
        let cone = ClearanceCone {
            point: point.position.as_dvec3(),
            normal: point.geometric_normal.as_dvec3(),
            sine,
            // The rounding error of the position, and as much of the vertices.
            tolerance: 2.0 * f64::from(point.offset),
        };
        self.bvh.clearance(&cone, within)
    }

    /// The instruction set of ray queries, irradiance lookups and shading.
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

    /// Bytes of geometry, acceleration structure, textures and the sky.
    pub fn memory(&self) -> usize {
        let meshes = self.meshes.iter().map(|mesh| {
            size_of_val(&*mesh.positions) + size_of_val(&*mesh.normals) + size_of_val(&*mesh.uvs)
        });
        let triangles = size_of_val(&*self.triangles);
        let textures = self.textures.iter().map(Texture::memory);
        let images = textures.sum::<usize>() + self.sky.memory();
        let emitters = self.emitters.memory();
        self.bvh.memory() + triangles + meshes.sum::<usize>() + emitters + images
    }
}
