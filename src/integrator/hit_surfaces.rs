//! What all integrators do at hits: surfaces, mirror reflection, and the ambient term.

use crate::accel::QueryState;
use crate::geometry::Hit;
use crate::material::{Features, reflect};
use crate::math::Ray;
use crate::scene::{Scene, SurfaceInteraction};
use glam::Vec3;

/// The surface that each of some coherent rays hits.
pub(super) fn coherent_surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    query_state: &mut QueryState,
) -> Vec<Option<SurfaceInteraction>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_coherent(rays, &mut hits, query_state);
    surfaces::<F>(scene, rays, &hits)
}

/// The surface at each ray's hit.
pub(super) fn surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    hits: &[Option<Hit>],
) -> Vec<Option<SurfaceInteraction>> {
    let surface =
        |(ray, hit): (&Ray, &Option<Hit>)| hit.as_ref().map(|hit| scene.surface::<F>(ray, hit));
    rays.iter().zip(hits).map(surface).collect()
}

/// The ambient light that stands for all bounces that are not computed.
pub(super) fn ambient(scene: &Scene) -> Vec3 {
    const AMBIENT_FRACTION: f32 = 0.3;
    AMBIENT_FRACTION * scene.ambient
}

/// The ray that `ray` continues in by mirror reflection at the surface.
pub(super) fn spawn_reflected_ray(surface: &SurfaceInteraction, ray: &Ray) -> Ray {
    let viewer = -ray.direction;
    let reflected = reflect(viewer, surface.point.shading_normal);
    // An interpolated normal may reflect into the surface; the geometric normal never does.
    let reflected = if reflected.dot(surface.point.geometric_normal) > 0.0 {
        reflected
    } else {
        reflect(viewer, surface.point.geometric_normal)
    };
    surface.point.spawn_ray(reflected)
}
