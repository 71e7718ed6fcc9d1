//! A room with all features of a scene, at any scale and position.

use super::fixtures::{camera_at, lamp, perfect_mirror};
use super::shapes::Polyhedron;
use crate::camera::Camera;
use crate::geometry::Sphere;
use crate::light::Sky;
use crate::material::Material;
use crate::scene::{MeshMaterial, Scene, SceneBuilder, SourceMesh};
use crate::simd::Kernel;
use crate::texture::Texture;
use glam::{DVec3, Vec2, Vec3};

/// A room `scale` m wide around `middle`, with every kind of shape and material. Intensities grow with the square of
/// the scale, so that radiance does not depend on it.
pub(super) fn room(scale: f64, middle: DVec3, kernel: Kernel) -> (Scene, Camera) {
    let place = |p: DVec3| p * scale + middle;
    let at = |x: f64, y: f64, z: f64| place(DVec3::new(x, y, z));
    let walls = Polyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).moved(place);
    let floor = Polyhedron::quad(
        DVec3::new(-0.45, -0.49, 0.45),
        0.9 * DVec3::X,
        -0.9 * DVec3::Z,
    );
    let mesh_ball = Polyhedron::icosphere(2);
    let placed_mesh_ball = mesh_ball.moved(|p| place(DVec3::new(-0.2, -0.3, -0.1) + 0.13 * p));
    let smooth = SourceMesh {
        normals: mesh_ball
            .vertices
            .iter()
            .map(|vertex| vertex.as_vec3())
            .collect(),
        ..placed_mesh_ball.mesh(3)
    };
    let tiled = SourceMesh {
        uvs: vec![Vec2::ZERO, 2.0 * Vec2::X, 2.0 * Vec2::ONE, 2.0 * Vec2::Y],
        ..floor.moved(place).mesh(1)
    };
    let blended = SourceMesh {
        positions: vec![
            at(-0.3, 0.0, -0.4),
            at(0.1, 0.05, -0.45),
            at(-0.1, 0.3, -0.42),
        ],
        normals: Vec::new(),
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2]],
        material: MeshMaterial::PerVertex([0, 2, 3]),
    };
    let ball = |center: DVec3, radius: f64| Sphere::new(place(center), radius * scale);
    let texels = (0..16).map(|i| [60 + 12 * i, 250 - 13 * i, 90 + 70 * (i % 3)]);
    let scaled_intensity = |intensity: f64| (intensity * scale * scale) as f32;
    let builder = SceneBuilder {
        ambient: Vec3::splat(0.2),
        sky: Sky::default(),
        materials: vec![
            Material::lambert(Vec3::new(0.7, 0.6, 0.5)),
            Material {
                texture: Some(0),
                ..Material::lambert(Vec3::ONE)
            },
            Material {
                reflective: Vec3::splat(0.8),
                ..perfect_mirror()
            },
            Material {
                specular: Vec3::splat(0.3),
                shininess: 20.0,
                ..Material::lambert(Vec3::new(0.2, 0.3, 0.6))
            },
        ],
        textures: Texture::new(4, 4, texels.collect()).into_iter().collect(),
        lights: vec![
            lamp(at(-0.3, 0.4, 0.2), scaled_intensity(0.4)),
            lamp(at(0.35, 0.3, -0.1), scaled_intensity(0.2)),
        ],
        suns: Vec::new(),
        spheres: vec![
            (ball(DVec3::new(0.22, -0.28, -0.2), 0.2), 2),
            (ball(DVec3::new(0.05, -0.4, 0.1), 0.07), 1),
        ],
        meshes: vec![walls.mesh(0), tiled, smooth, blended],
        kernel,
    };
    let camera = camera_at(at(0.31, 0.11, 0.44), at(-0.07, -0.21, -0.2), 65.0);
    (builder.build().0, camera)
}
