//! What all integrators do at hits: surfaces, mirror reflection, and the ambient term.

use crate::accel::QueryState;
use crate::geometry::Hit;
use crate::material::{Features, reflect};
use crate::math::Ray;
use crate::scene::{Scene, SurfaceInteraction};
use crate::simd::{Simd, WithSimd};
use glam::Vec3;
use std::marker::PhantomData;

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
    scene.kernel().run(SurfacesAt::<F> {
        scene,
        rays,
        hits,
        features: PhantomData,
    })
}

/// [`surfaces`] for every instruction set.
struct SurfacesAt<'a, F> {
    scene: &'a Scene,
    rays: &'a [Ray],
    hits: &'a [Option<Hit>],
    features: PhantomData<F>,
}

impl<F: Features> WithSimd for SurfacesAt<'_, F> {
    type Output = Vec<Option<SurfaceInteraction>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Vec<Option<SurfaceInteraction>> {
        let mut surfaces = Vec::with_capacity(self.rays.len());
        for (ray, hit) in self.rays.iter().zip(self.hits) {
            // Not by `map`: its closure might be compiled on its own, without the instruction set.
            let mut surface = None;
            if let Some(hit) = hit {
                surface = Some(self.scene.surface::<F>(ray, hit));
            }
            surfaces.push(surface);
        }
        surfaces
    }
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
