//! What all integrators do at hits: surfaces, mirror reflection, and the ambient term.

use crate::accel::QueryState;
use crate::geometry::Hit;
use crate::material::{Features, reflect};
use crate::math::{Ray, RayDifferential};
use crate::scene::{Scene, SurfaceInteraction};
use crate::simd::{Simd, WithSimd};
use glam::Vec3;
use std::marker::PhantomData;

/// What some rays hit; the lists are as long as that of the rays.
pub(super) struct HitSurfaces {
    /// The surface at each ray's hit.
    pub(super) surfaces: Vec<Option<SurfaceInteraction>>,
    /// The radiance that the surface sends back along the ray by itself; empty in a scene where no surface does.
    pub(super) emitted: Vec<Vec3>,
    /// The differential of the ray that is reflected there; empty if none is needed: without mirrors, or if textures
    /// are not filtered.
    pub(super) reflected: Vec<RayDifferential>,
}

/// What each of some coherent rays hits, with textures filtered over the rays' footprints; over none if there are no
/// `differentials`.
pub(super) fn coherent_surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    differentials: &[RayDifferential],
    query_state: &mut QueryState,
) -> HitSurfaces {
    let mut hits = vec![None; rays.len()];
    scene.closest_coherent(rays, &mut hits, query_state);
    surfaces::<F>(scene, rays, differentials, &hits)
}

/// As [`coherent_surfaces`], given each ray's hit.
pub(super) fn surfaces<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    differentials: &[RayDifferential],
    hits: &[Option<Hit>],
) -> HitSurfaces {
    let surfaces = scene.kernel().run(SurfacesAt::<F> {
        scene,
        rays,
        differentials,
        hits,
        features: PhantomData,
    });
    let mut reflected = Vec::new();
    if F::TEXTURES && F::MIRRORS && !differentials.is_empty() {
        let hits = hits.iter().zip(&surfaces);
        let hits = hits.map(|(hit, surface)| hit.as_ref().zip(surface.as_ref()));
        for ((ray, differential), hit) in rays.iter().zip(differentials).zip(hits) {
            reflected.push(reflected_differential(scene, ray, differential, hit));
        }
    }
    let mut emitted = Vec::new();
    if scene.has_emitters() {
        emitted.extend(rays.iter().zip(hits).enumerate().map(|(i, (ray, hit))| {
            let differential = differentials.get(i).unwrap_or(&RayDifferential::ZERO);
            let of_hit = |hit: &Hit| scene.emitted(ray, hit, differential);
            hit.as_ref().map_or(Vec3::ZERO, of_hit)
        }));
    }
    HitSurfaces {
        surfaces,
        emitted,
        reflected,
    }
}

impl HitSurfaces {
    /// [`HitSurfaces::emitted`] of a ray.
    pub(super) fn emitted(&self, ray: usize) -> Vec3 {
        self.emitted.get(ray).copied().unwrap_or(Vec3::ZERO)
    }
}

/// [`HitSurfaces::surfaces`] for every instruction set.
struct SurfacesAt<'a, F> {
    scene: &'a Scene,
    rays: &'a [Ray],
    differentials: &'a [RayDifferential],
    hits: &'a [Option<Hit>],
    features: PhantomData<F>,
}

impl<F: Features> WithSimd for SurfacesAt<'_, F> {
    type Output = Vec<Option<SurfaceInteraction>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Vec<Option<SurfaceInteraction>> {
        let mut surfaces = Vec::with_capacity(self.rays.len());
        for (i, (ray, hit)) in self.rays.iter().zip(self.hits).enumerate() {
            // Not by `map`: its closure might be compiled on its own, without the instruction set.
            let mut surface = None;
            if let Some(hit) = hit {
                let differential = if F::TEXTURES && !self.differentials.is_empty() {
                    &self.differentials[i]
                } else {
                    &RayDifferential::ZERO
                };
                surface = Some(self.scene.filtered_surface::<F>(ray, hit, differential));
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

/// The differential of [`spawn_reflected_ray`]; zero where no mirror is hit.
fn reflected_differential(
    scene: &Scene,
    ray: &Ray,
    differential: &RayDifferential,
    hit: Option<(&Hit, &SurfaceInteraction)>,
) -> RayDifferential {
    match hit {
        Some((hit, surface)) if surface.bsdf.reflective != Vec3::ZERO => {
            let reflected = reflect(-ray.direction, surface.point.shading_normal);
            let at_geometric_normal = reflected.dot(surface.point.geometric_normal) <= 0.0;
            scene.reflected_differential(ray, hit, differential, at_geometric_normal)
        }
        _ => RayDifferential::ZERO,
    }
}
