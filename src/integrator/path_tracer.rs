//! Path tracing with splitting (Kajiya 1986, "The Rendering Equation"), wavefront by wavefront, with light-guided
//! directions by multiple importance sampling (Veach 1997).

use super::camera_sample::CameraSample;
use super::direct::{LightContribution, direct_lighting_incoherent};
use super::hit_surfaces::{HitSurfaces, ambient, spawn_reflected_ray, surfaces};
use super::light_sampler::LightSampler;
use super::path_state::{PathState, Technique};
use crate::accel::QueryState;
use crate::irradiance_cache::SecondaryIrradiance;
use crate::material::Features;
use crate::math::{Ray, RayDifferential, to_world};
use crate::sampling::{MixtureChoice, cosine_hemisphere};
use crate::scene::{Scene, SurfaceInteraction};
use glam::Vec3;
use std::f32::consts::PI;
use std::marker::PhantomData;

/// Wavefront size, in paths.
const WAVEFRONT_SIZE: usize = 128;

/// The first pair of random numbers for rays from lights, by depth: above the pairs of all depths.
const LIGHT_DIMENSION_OFFSET: u32 = 1 << 16;

/// A path that continues from another.
struct SplitPath {
    parent: usize,
    /// The factor from its radiance to that of its parent.
    throughput: Vec3,
    path: PathState,
}

/// Traces paths.
pub(super) struct PathTracer<'a, F> {
    pub(super) light_sampler: &'a LightSampler<'a>,
    /// The longest path.
    pub(super) bounces: u32,
    /// How many paths continue from each diffuse bounce, the first bounce first; 1 beyond the list.
    pub(super) splits: &'a [u32],
    /// Ends paths beyond the first diffuse bounce where it has records.
    pub(super) cache: Option<&'a SecondaryIrradiance>,
    pub(super) query_state: &'a mut QueryState,
    pub(super) features: PhantomData<F>,
}

impl<F: Features> PathTracer<'_, F> {
    /// Unbiased estimates of the radiance along camera rays, given the surfaces that they hit and the direct light
    /// there. Caustics, light that a mirror reflects from a point light onto a surface, are not included.
    pub(super) fn camera_radiance(
        &mut self,
        samples: &[CameraSample],
        hit: &HitSurfaces,
        direct: &[Vec3],
        radiance: &mut [Vec3],
    ) {
        let from_camera = |sample: &CameraSample| PathState {
            ray: sample.ray,
            sequence: sample.sequence,
            depth: 0,
            diffuse_bounces: 0,
            index: sample.index,
            technique: Technique::Single,
        };
        let paths: Vec<PathState> = samples.iter().map(from_camera).collect();
        self.outgoing_radiance(&paths, hit, direct, radiance);
    }

    fn scene(&self) -> &Scene {
        self.light_sampler.scene()
    }

    /// The incident radiance along the last rays of up to [`WAVEFRONT_SIZE`] paths, with textures filtered over the
    /// footprints of these rays; over none if there are no `differentials`.
    fn incident_radiance(
        &mut self,
        paths: &[PathState],
        differentials: &[RayDifferential],
        radiance: &mut [Vec3],
    ) {
        let scene = self.light_sampler.scene();
        let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
        let mut hits = vec![None; rays.len()];
        scene.closest_incoherent(&rays, &mut hits, self.query_state);
        let mut hit = surfaces::<F>(scene, &rays, differentials, &hits);
        let surfaces = &mut hit.surfaces;
        let light_sampler = self.light_sampler;
        if light_sampler.is_empty() {
            let direct = self.direct_lighting(surfaces, &rays, |_| {});
            return self.outgoing_radiance(paths, &hit, &direct, radiance);
        }
        let mut light_pdfs = [0.0; WAVEFRONT_SIZE];
        let direct = self.direct_lighting(surfaces, &rays, |contribution| {
            light_pdfs[contribution.surface] += light_sampler.pdf(
                contribution.light,
                contribution.distance,
                contribution.cosine,
            );
        });
        let mut weights = [0.0; WAVEFRONT_SIZE];
        for (i, path) in paths.iter().enumerate() {
            let hit = hits[i].as_ref().zip(surfaces[i].as_ref());
            weights[i] = path.mis_weight(hit, light_pdfs[i]);
            if weights[i] == 0.0 {
                surfaces[i] = None;
            }
        }
        self.outgoing_radiance(paths, &hit, &direct, radiance);
        for (radiance, weight) in radiance.iter_mut().zip(weights) {
            *radiance *= weight;
        }
    }

    fn direct_lighting(
        &mut self,
        surfaces: &[Option<SurfaceInteraction>],
        rays: &[Ray],
        on_contribution: impl FnMut(&LightContribution),
    ) -> Vec<Vec3> {
        let scene = self.light_sampler.scene();
        direct_lighting_incoherent::<F>(scene, surfaces, rays, self.query_state, on_contribution)
    }

    /// The radiance that the surfaces at the ends of paths send back along their last rays, given the reflected
    /// direct light there.
    ///
    /// Every path's radiance is a sum over its own splits, in their order: it does not depend on which paths are
    /// traced together.
    pub(super) fn outgoing_radiance(
        &mut self,
        paths: &[PathState],
        hit: &HitSurfaces,
        direct: &[Vec3],
        radiance: &mut [Vec3],
    ) {
        let mut splits = Vec::with_capacity(WAVEFRONT_SIZE);
        for (parent, path) in paths.iter().enumerate() {
            let Some(surface) = &hit.surfaces[parent] else {
                radiance[parent] = self.scene().sky.radiance(path.ray.direction);
                continue;
            };
            let base_weight = surface.bsdf.base_weight::<F>();
            let mirror = surface.bsdf.mirror_weight::<F>();
            let diffuse = base_weight * surface.bsdf.diffuse;
            radiance[parent] = base_weight * direct[parent];
            let mut emit = |throughput, path| {
                splits.push(SplitPath {
                    parent,
                    throughput,
                    path,
                });
            };
            if path.depth == self.bounces {
                radiance[parent] += (diffuse + mirror) * ambient(self.scene());
            } else if path.diffuse_bounces == 0 {
                // Up to the first diffuse bounce both lobes are followed.
                self.split(path, surface, diffuse, Vec3::ZERO, &mut emit);
                follow_mirror::<F>(path, surface, mirror, &mut emit);
            } else if let Some(light) = self.cached_irradiance(path, surface) {
                radiance[parent] += diffuse * light;
                follow_mirror::<F>(path, surface, mirror, &mut emit);
            } else {
                self.split(path, surface, diffuse, mirror, &mut emit);
            }
            // No more than full wavefronts need, so that they stay in the processor's cache.
            if splits.len() >= WAVEFRONT_SIZE {
                self.trace_splits(&mut splits, hit, radiance);
            }
        }
        self.trace_splits(&mut splits, hit, radiance);
    }

    /// The cosine-weighted mean radiance that arrives at the end of a path, from the irradiance cache; none if it has
    /// no record there.
    fn cached_irradiance(&self, path: &PathState, surface: &SurfaceInteraction) -> Option<Vec3> {
        let cache = self.cache?;
        let point = &surface.point;
        let distance = (point.position - path.ray.origin).length();
        let bounces_left = self.bounces - path.depth;
        cache.mean_radiance(point.position, point.shading_normal, bounces_left, distance)
    }

    /// Adds the radiance of split paths to that of their parents, which end at the surfaces of `hit`.
    ///
    /// Textures are filtered over the footprints of paths that only mirrors have reflected. Those beyond a diffuse bounce
    /// are not: they average out with the noise.
    fn trace_splits(
        &mut self,
        splits: &mut Vec<SplitPath>,
        hit: &HitSurfaces,
        radiance: &mut [Vec3],
    ) {
        if !self.light_sampler.is_empty() {
            self.connect(splits, &hit.surfaces);
        }
        for wave in splits.chunks(WAVEFRONT_SIZE) {
            let paths: Vec<PathState> = wave.iter().map(|split| split.path).collect();
            let is_mirrored = |split: &SplitPath| split.path.diffuse_bounces == 0;
            let mut differentials = Vec::new();
            if !hit.reflected.is_empty() && wave.iter().any(is_mirrored) {
                differentials.extend(wave.iter().map(|split| {
                    if is_mirrored(split) {
                        hit.reflected[split.parent]
                    } else {
                        RayDifferential::ZERO
                    }
                }));
            }
            let mut incident = [Vec3::ZERO; WAVEFRONT_SIZE];
            self.incident_radiance(&paths, &differentials, &mut incident);
            for (split, incident) in wave.iter().zip(incident) {
                radiance[split.parent] += split.throughput * incident;
            }
        }
        splits.clear();
    }

    /// Replaces rays that leave lights by rays from the surfaces to the points that these hit; drops paths that cannot
    /// be connected.
    fn connect(&mut self, splits: &mut Vec<SplitPath>, surfaces: &[Option<SurfaceInteraction>]) {
        let from_lights: Vec<usize> = (0..splits.len())
            .filter(|&i| matches!(splits[i].path.technique, Technique::Guided { .. }))
            .collect();
        let rays: Vec<Ray> = from_lights.iter().map(|&i| splits[i].path.ray).collect();
        let mut hits = vec![None; rays.len()];
        let scene = self.light_sampler.scene();
        scene.closest_incoherent(&rays, &mut hits, self.query_state);
        for (&i, hit) in from_lights.iter().zip(&hits) {
            let split = &mut splits[i];
            let surface = surfaces[split.parent].as_ref();
            let ends = surface.zip(hit.as_ref());
            match ends.and_then(|(surface, hit)| split.path.connect(surface, hit)) {
                Some(path) => split.path = path,
                None => split.throughput = Vec3::ZERO,
            }
        }
        splits.retain(|split| split.throughput != Vec3::ZERO);
    }

    /// Emits as many paths as the schedule gives, each by the diffuse lobe or by the mirror, with a probability in
    /// proportion to their reflectance. Their mean is the estimate.
    fn split(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        diffuse: Vec3,
        mirror: Vec3,
        emit: &mut impl FnMut(Vec3, PathState),
    ) {
        let (diffuse_sum, mirror_sum) = (diffuse.element_sum(), mirror.element_sum());
        if diffuse_sum + mirror_sum == 0.0 {
            return;
        }
        let mirror_probability = if F::MIRRORS {
            mirror_sum / (diffuse_sum + mirror_sum)
        } else {
            0.0
        };
        let count = self.splits.get(path.diffuse_bounces).copied().unwrap_or(1);
        let (diffuse, mirror) = (diffuse / count as f32, mirror / count as f32);
        let diffuse = diffuse / (1.0 - mirror_probability);
        for i in 0..count {
            let next = PathState {
                depth: path.depth + 1,
                diffuse_bounces: path.diffuse_bounces + 1,
                index: path.index.wrapping_mul(count).wrapping_add(i),
                technique: Technique::Single,
                ..*path
            };
            let by_mirror = mirror_probability > 0.0
                && path.sequence.sample_1d(next.index, next.depth) < mirror_probability;
            if by_mirror {
                let index = next.index;
                let throughput = mirror / mirror_probability;
                follow_mirror::<F>(&PathState { index, ..*path }, surface, throughput, emit);
            } else if let Some(next) = self.sample_diffuse(next, surface) {
                emit(diffuse, next);
            }
        }
    }

    /// The path with a direction sampled from the diffuse lobe; none if the direction lies below the geometric
    /// horizon.
    #[inline]
    fn sample_diffuse(&self, path: PathState, surface: &SurfaceInteraction) -> Option<PathState> {
        let light_sampler = self.light_sampler;
        let mut index = path.index;
        if !light_sampler.is_empty() {
            match path.sequence.choose_technique(path.index, path.depth) {
                MixtureChoice::Cosine(cosine) => index = cosine,
                MixtureChoice::Guided(guided) => {
                    let numbers = path
                        .sequence
                        .sample_2d(guided, LIGHT_DIMENSION_OFFSET + path.depth);
                    return Some(PathState {
                        ray: light_sampler.sample_ray(numbers),
                        technique: Technique::UNCONNECTED,
                        ..path
                    });
                }
            }
        }
        let [u, v] = path.sequence.sample_2d(index, path.depth);
        let local = cosine_hemisphere(u, v);
        let direction = to_world(surface.point.shading_normal, local);
        // An interpolated normal gathers nothing from below the geometric horizon.
        (direction.dot(surface.point.geometric_normal) > 0.0).then(|| PathState {
            ray: surface.point.spawn_ray(direction),
            technique: if light_sampler.is_empty() {
                Technique::Single
            } else {
                Technique::Cosine { pdf: local.z / PI }
            },
            ..path
        })
    }
}

/// Emits the mirrored path, unless the throughput is zero.
fn follow_mirror<F: Features>(
    path: &PathState,
    surface: &SurfaceInteraction,
    throughput: Vec3,
    emit: &mut impl FnMut(Vec3, PathState),
) {
    if F::MIRRORS && throughput != Vec3::ZERO {
        let next = PathState {
            ray: spawn_reflected_ray(surface, &path.ray),
            depth: path.depth + 1,
            technique: Technique::Single,
            ..*path
        };
        emit(throughput, next);
    }
}
