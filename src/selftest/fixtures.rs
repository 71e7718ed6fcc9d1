//! Shared by the cases: cameras, lights, materials, scenes, renderers and error measures.

use super::shapes::Polyhedron;
use crate::accel::QueryState;
use crate::camera::Camera;
use crate::geometry::Hit;
use crate::integrator::{CameraSample, Integrator, IntegratorSettings};
use crate::light::PointLight;
use crate::material::Material;
use crate::math::Ray;
use crate::render::{RenderSettings, Renderer};
use crate::sampling::SobolSequence;
use crate::scene::{Scene, SceneBuilder};
use crate::simd::Kernel;
use glam::{DVec3, Vec3};

/// A camera at `eye` that looks at `target`, its vertical field of view in degrees.
pub(super) fn camera_at(eye: DVec3, target: DVec3, degrees: f64) -> Camera {
    Camera::look_at(eye, target, degrees.to_radians()).expect("not straight up or down")
}

/// A mirror that reflects all light.
pub(super) fn perfect_mirror() -> Material {
    Material {
        reflective: Vec3::ONE,
        ..Material::lambert(Vec3::ZERO)
    }
}

/// A grey light that falls off with the inverse square of the distance.
pub(super) fn lamp(position: DVec3, intensity: f32) -> (DVec3, PointLight) {
    (
        position,
        PointLight::isotropic(Vec3::ZERO, Vec3::splat(intensity)),
    )
}

/// A scene of matte white meshes.
pub(super) fn white_scene(meshes: &[&Polyhedron], kernel: Kernel) -> Scene {
    let builder = SceneBuilder {
        materials: vec![Material::lambert(Vec3::ONE)],
        meshes: meshes.iter().map(|mesh| mesh.mesh(0)).collect(),
        kernel,
        ..SceneBuilder::default()
    };
    builder.build().0
}

/// The ray from `eye` along `direction`, normalised and relative to the origin of the scene.
pub(super) fn ray_in(scene: &Scene, eye: DVec3, direction: DVec3) -> Ray {
    let origin = (eye - scene.origin).as_vec3();
    Ray::new(origin, direction.normalize().as_vec3())
}

/// The closest hits of incoherent rays.
pub(super) fn first_hits(scene: &Scene, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(rays, &mut hits, &mut QueryState::default());
    hits
}

/// The sine of the angle between a unit vector and an exact one of any length.
pub(super) fn sine(unit: Vec3, exact: DVec3) -> f64 {
    // Scaled first, as its square may underflow or overflow.
    let exact = (exact / exact.abs().max_element()).normalize();
    unit.as_dvec3().cross(exact).length()
}

/// Direct light only.
pub(super) const DIRECT: IntegratorSettings = IntegratorSettings::Whitted { bounces: 0 };

/// Path tracing with these numbers of bounces and splits.
pub(super) fn path_traced(bounces: u32, splits: [u32; 2]) -> IntegratorSettings {
    IntegratorSettings::PathTraced {
        bounces,
        splits: splits.to_vec(),
    }
}

/// A renderer of settings that need no irradiance cache.
pub(super) fn renderer<'a>(scene: &'a Scene, settings: &RenderSettings) -> Renderer<'a> {
    Renderer::new(scene, settings.clone(), None).expect("needs no cache")
}

/// The integrator of settings that need no irradiance cache.
pub(super) fn integrator<'a>(scene: &'a Scene, settings: &IntegratorSettings) -> Integrator<'a> {
    Integrator::new(scene, settings, None).expect("needs no cache")
}

/// The radiance that arrives at `eye` along `direction`.
pub(super) fn radiance_along(integrator: &Integrator, eye: DVec3, direction: DVec3) -> Vec3 {
    let sample = CameraSample {
        ray: ray_in(integrator.scene(), eye, direction),
        sequence: SobolSequence::new(0, 0, 0, 0),
        index: 0,
    };
    let mut radiance = [Vec3::ZERO];
    integrator.radiance(&[sample], &[], &mut QueryState::default(), &mut radiance);
    radiance[0]
}

/// The larger of two errors; NaN counts as infinite.
pub(super) fn worse(worst: f64, error: f64) -> f64 {
    if error.is_nan() {
        f64::INFINITY
    } else {
        worst.max(error)
    }
}
