//! The resolved scene: immutable, checked, ready for rays.
//!
//! What the tracer may rely on: every number is finite; every material and texture number exists;
//! no triangle is without area; normals are of unit length or zero; coordinates are relative to
//! [`Scene::origin`], in the midst of the scene, so that single precision is finest where the
//! scene is.

mod builder;
mod surface;

pub use builder::{MeshMaterial, SceneBuilder, SourceMesh};
pub use surface::Surface;

use crate::accel::{Bvh, Points, Sight, Traversal};
use crate::geometry::{Corners, Hit, Mesh, Sphere};
use crate::light::PointLight;
use crate::material::{FeatureSet, Material};
use crate::math::{Aabb, Ray};
use crate::texture::Texture;
use glam::{DVec3, Vec3};

/// Everything that can be seen, and the lights that show it.
#[derive(Debug)]
pub struct Scene {
    /// Where the scene's own coordinates have their origin, in world coordinates.
    pub origin: DVec3,
    /// The lights.
    pub lights: Vec<PointLight>,
    /// The scene's ambient colour.
    pub ambient: Vec3,
    /// What a ray that leaves the scene sees.
    pub background: Vec3,
    meshes: Vec<Mesh>,
    mesh_materials: Vec<MeshMaterial>,
    triangles: Vec<Triangle>,
    spheres: Vec<Sphere>,
    sphere_materials: Vec<usize>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    /// What its surfaces need: the code that is generic over it relies on that.
    features: FeatureSet,
    bvh: Bvh,
    /// The largest absolute coordinate of any shape.
    magnitude: f32,
}

/// What shading needs of a triangle, side by side.
#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: Corners,
    /// The index of its mesh.
    mesh: u32,
    /// Unit normal of its winding.
    normal: Vec3,
}

impl Scene {
    /// The nearest hit of a ray, or none.
    pub fn closest(&self, ray: &Ray, traversal: &mut Traversal) -> Option<Hit> {
        self.bvh.closest(ray, traversal)
    }

    /// The nearest hit, or none, of each of some rays that run side by side.
    pub fn closest_of_packet(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        self.bvh.closest_of_packet(rays, hits, traversal);
    }

    /// How points see a target if nothing is in the way.
    pub fn look(&self, points: &Points, target: Vec3) -> Sight {
        self.bvh.look(points, target)
    }

    /// A bit for each ray of a sight that has something in its interval, of rays that run side by side.
    pub fn occluded_of_sight(&self, sight: &Sight, traversal: &mut Traversal) -> u32 {
        self.bvh.occluded_of_sight(sight, traversal)
    }

    /// As [`Scene::closest_of_packet`], of any number of rays that have nothing in common.
    pub fn closest_of_wave(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        traversal: &mut Traversal,
    ) {
        self.bvh.closest_of_wave(rays, hits, traversal);
    }

    /// As [`Scene::occluded_of_sight`], of sights all over the scene, one after the other.
    pub fn occluded_of_sights(&self, sights: &[Sight], traversal: &mut Traversal) -> Vec<u32> {
        self.bvh.occluded_of_sights(sights, traversal)
    }

    /// The distance from a point in world coordinates to the nearest surface, or none if it is not below
    /// `within`; in metres.
    pub fn distance(&self, point: DVec3, within: f64) -> Option<f64> {
        self.bvh.distance(point - self.origin, within)
    }

    /// What its surfaces need.
    pub fn features(&self) -> FeatureSet {
        self.features
    }

    /// The box around all shapes, relative to [`Scene::origin`]; empty for an empty scene.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// How many triangles there are.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// How many spheres there are.
    pub fn sphere_count(&self) -> usize {
        self.spheres.len()
    }

    /// The image textures.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Bytes of shapes, tree and textures.
    pub fn memory(&self) -> usize {
        let meshes = self.meshes.iter().map(|mesh| {
            size_of_val(&*mesh.positions) + size_of_val(&*mesh.normals) + size_of_val(&*mesh.uvs)
        });
        let triangles = size_of_val(&*self.triangles);
        let textures = self.textures.iter().map(Texture::memory);
        self.bvh.memory() + triangles + meshes.sum::<usize>() + textures.sum::<usize>()
    }
}
