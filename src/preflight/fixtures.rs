//! Scenes and camera paths for the tests of preflight.

use crate::camera::{
    Camera, CameraPath, CameraPathTiming, FrameCameras, Interpolation, Keyframe, Orientation,
    Segment,
};
use crate::geometry::{self, Sphere};
use crate::light::PointLight;
use crate::material::Material;
use crate::scene::{MeshMaterial, Scene, SceneBuilder, SourceMesh};
use glam::{DVec3, Vec3};

/// Frames per second of all paths.
pub(super) const FPS: f64 = 24.0;

/// A path through keys of a time, a position and a target, with a vertical field of view of 50 degrees.
pub(super) fn path(interpolation: Interpolation, keys: &[(f64, DVec3, DVec3)]) -> CameraPath {
    let key = |&(time, position, target): &(f64, DVec3, DVec3)| Keyframe {
        time,
        position,
        orientation: Orientation::LookAt { target, roll: 0.0 },
        field_of_view: 50.0_f64.to_radians(),
        segment: Segment::of(interpolation),
    };
    let keys: Vec<Keyframe> = keys.iter().map(key).collect();
    CameraPath::new(FPS, &keys, &CameraPathTiming::BY_KEYS).expect("a path")
}

/// A straight path of one second that looks along -Z.
pub(super) fn walk(from: DVec3, to: DVec3) -> CameraPath {
    let ahead = DVec3::new(0.0, 0.0, -1e3);
    path(
        Interpolation::Linear,
        &[(0.0, from, from + ahead), (1.0, to, to + ahead)],
    )
}

/// A camera that looks along a direction.
pub(super) fn still(position: DVec3, direction: DVec3) -> Camera {
    Camera::look_at(position, position + direction, 50.0_f64.to_radians()).expect("not vertical")
}

/// The frames of an open path without cuts.
pub(super) fn open_shot(cameras: Vec<Camera>) -> FrameCameras {
    FrameCameras {
        fps: FPS,
        start: 0.0,
        cameras,
        cuts: Vec::new(),
        is_closed: false,
    }
}

/// A closed box whose faces point outward.
pub(super) fn cuboid(min: DVec3, max: DVec3) -> SourceMesh {
    let (positions, triangles) = geometry::cuboid(min, max);
    SourceMesh {
        positions,
        normals: Vec::new(),
        uvs: Vec::new(),
        triangles,
        material: MeshMaterial::Uniform(0),
    }
}

/// The same mesh with all faces flipped.
pub(super) fn inverted(mut mesh: SourceMesh) -> SourceMesh {
    for vertices in &mut mesh.triangles {
        vertices.swap(1, 2);
    }
    mesh
}

pub(super) fn scene(meshes: Vec<SourceMesh>, spheres: &[(DVec3, f64)]) -> Scene {
    lit_scene(meshes, spheres, vec![])
}

/// A white light.
pub(super) fn lamp(position: DVec3, intensity: f32) -> (DVec3, PointLight) {
    (
        position,
        PointLight::isotropic(Vec3::ZERO, Vec3::splat(intensity)),
    )
}

/// Shapes of a grey, the first material, or of the second, which is red; and lights.
pub(super) fn lit_scene(
    meshes: Vec<SourceMesh>,
    spheres: &[(DVec3, f64)],
    lights: Vec<(DVec3, PointLight)>,
) -> Scene {
    let spheres = spheres
        .iter()
        .map(|&(center, radius)| (Sphere::new(center, radius), 0));
    let builder = SceneBuilder {
        materials: [Vec3::ONE, Vec3::X].map(Material::lambert).to_vec(),
        lights,
        meshes,
        spheres: spheres.collect(),
        ..SceneBuilder::default()
    };
    builder.build().0
}

/// A room of 10 x 4 x 10 m around the middle of its floor, its faces pointing inward.
pub(super) fn hall() -> SourceMesh {
    inverted(cuboid(
        DVec3::new(-5.0, 0.0, -5.0),
        DVec3::new(5.0, 4.0, 5.0),
    ))
}
