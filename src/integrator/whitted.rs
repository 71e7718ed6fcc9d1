//! Recursive ray tracing with mirrors (Whitted 1980, "An Improved Illumination Model for Shaded Display"), one
//! wavefront of reflected rays after the other.

use super::direct::direct_lighting_coherent;
use super::hit_surfaces::{HitSurfaces, ambient, coherent_surfaces, spawn_reflected_ray};
use crate::accel::QueryState;
use crate::material::Features;
use crate::math::{Ray, RayDifferential};
use crate::scene::{Scene, SurfaceInteraction};
use glam::Vec3;

/// Rays of the same number of reflections; all lists are of one length, unless they are said to be empty.
pub(super) struct Wavefront {
    pub(super) rays: Vec<Ray>,
    /// The index of the camera sample that each ray belongs to.
    pub(super) samples: Vec<usize>,
    /// The throughput from each ray to its camera sample.
    pub(super) throughputs: Vec<Vec3>,
    /// What each ray hits.
    pub(super) surfaces: Vec<Option<SurfaceInteraction>>,
    /// The differentials of the rays that are reflected there: see [`HitSurfaces::reflected`].
    pub(super) reflected: Vec<RayDifferential>,
    /// The direct light that is reflected there.
    pub(super) direct: Vec<Vec3>,
    /// How many more bounces are computed.
    pub(super) bounces_left: u32,
}

impl Wavefront {
    /// Camera rays.
    pub(super) fn of_camera(
        rays: Vec<Ray>,
        HitSurfaces {
            surfaces,
            reflected,
        }: HitSurfaces,
        direct: Vec<Vec3>,
        bounces_left: u32,
    ) -> Wavefront {
        Wavefront {
            samples: (0..rays.len()).collect(),
            throughputs: vec![Vec3::ONE; rays.len()],
            rays,
            surfaces,
            reflected,
            direct,
            bounces_left,
        }
    }
}

/// The radiance along camera rays: base (1 - reflective) + reflective * (radiance of the mirrored ray), where base is
/// the direct light plus the diffuse reflection of the indirect light, which `indirect` gives for each ray of a
/// wavefront.
///
/// Rays of one wavefront are traced together: neighbours mostly hit the same mirror.
pub(super) fn radiance<F: Features>(
    scene: &Scene,
    mut wavefront: Wavefront,
    indirect: impl Fn(&Wavefront, &mut QueryState) -> Vec<Vec3>,
    query_state: &mut QueryState,
    radiance: &mut [Vec3],
) {
    radiance.fill(Vec3::ZERO);
    loop {
        let indirect = indirect(&wavefront, query_state);
        let mut rays = Vec::new();
        let mut differentials = Vec::new();
        let mut samples = Vec::new();
        let mut throughputs = Vec::new();
        for (i, &sample) in wavefront.samples.iter().enumerate() {
            let throughput = wavefront.throughputs[i];
            let sum = &mut radiance[sample];
            let Some(surface) = &wavefront.surfaces[i] else {
                *sum += throughput * scene.sky.radiance(wavefront.rays[i].direction);
                continue;
            };
            let bsdf = &surface.bsdf;
            let base = indirect[i] * bsdf.diffuse + wavefront.direct[i];
            *sum += throughput * bsdf.base_weight::<F>() * base;
            let throughput = throughput * bsdf.mirror_weight::<F>();
            if throughput == Vec3::ZERO {
                continue;
            }
            if wavefront.bounces_left == 0 {
                *sum += throughput * ambient(scene);
            } else {
                rays.push(spawn_reflected_ray(surface, &wavefront.rays[i]));
                differentials.extend(wavefront.reflected.get(i));
                samples.push(sample);
                throughputs.push(throughput);
            }
        }
        if rays.is_empty() {
            return;
        }
        let HitSurfaces {
            surfaces,
            reflected,
        } = coherent_surfaces::<F>(scene, &rays, &differentials, query_state);
        wavefront = Wavefront {
            direct: direct_lighting_coherent::<F>(scene, &surfaces, &rays, query_state),
            rays,
            samples,
            throughputs,
            surfaces,
            reflected,
            bounces_left: wavefront.bounces_left - 1,
        };
    }
}
