//! Path tracing with splitting (Kajiya 1986, "The Rendering Equation"), wavefront by wavefront, with light-guided
//! directions by multiple importance sampling (Veach 1997).

use super::cached_light::CachedLight;
use super::camera_sample::CameraSample;
use super::direct::{LightContribution, direct_lighting_incoherent};
use super::hit_surfaces::{HitSurfaces, ambient, spawn_reflected_ray, surfaces};
use super::light_sampler::LightSampler;
use super::path_state::{Emission, PathState, Technique};
use super::sampled_lights::{ShadowNumbers, add_sampled_lights, has_sampled_lights};
use super::sky_sampler::SkySampler;
use crate::accel::QueryState;
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

/// The pair of random numbers that choose cached light, by depth.
const CACHE_DIMENSION_OFFSET: u32 = 1 << 17;

/// A path that continues from another.
struct SplitPath {
    parent: usize,
    /// The factor from its radiance to that of its parent.
    throughput: Vec3,
    path: PathState,
}

/// How many rays continue from the bounces of paths.
#[derive(Clone, Copy)]
pub(super) struct Schedule<'a> {
    /// The longest path.
    pub(super) bounces: u32,
    /// How many paths continue from each diffuse bounce, the first bounce first; 1 beyond the list.
    pub(super) splits: &'a [u32],
    /// How many shadow rays there are for emitters, and for each sun, before the first diffuse bounce; 1 beyond.
    pub(super) shadow_rays: u32,
    /// Whether shadow rays alone count light straight from emitters: where paths may end in cached light, which goes
    /// without, or start at points that are gathered for.
    pub(super) counts_emitters_by_shadow_rays: bool,
    /// Whether rays that leave the first diffuse bounce for the sky count nothing.
    pub(super) excludes_sky: bool,
}

impl Schedule<'_> {
    /// How many paths continue from the end of a path.
    fn splits(&self, path: &PathState) -> u32 {
        self.splits.get(path.diffuse_bounces).copied().unwrap_or(1)
    }

    /// How many shadow rays for emitters leave a surface that a path reaches after so many diffuse bounces.
    fn shadow_rays(&self, diffuse_bounces: usize) -> u32 {
        if diffuse_bounces == 0 {
            self.shadow_rays
        } else {
            1
        }
    }

    /// How many rays that may find emitters leave the end of a path by the diffuse lobe, in the mean.
    fn cosine_rays<F: Features>(&self, path: &PathState, surface: &SurfaceInteraction) -> f32 {
        if path.depth == self.bounces || self.counts_emitters_by_shadow_rays {
            return 0.0;
        }
        let mirror_probability = match path.diffuse_bounces {
            0 => 0.0,
            _ => mirror_probability(diffuse::<F>(surface), surface.bsdf.mirror_weight::<F>()),
        };
        self.splits(path) as f32 * (1.0 - mirror_probability)
    }

    /// How much of the light that emitters send along a ray counts that leaves the end of a path by the diffuse lobe.
    fn emission<F: Features>(&self, path: &PathState, surface: &SurfaceInteraction) -> Emission {
        if self.counts_emitters_by_shadow_rays {
            return Emission::Sampled;
        }
        Emission::Weighted {
            rays: self.cosine_rays::<F>(path, surface),
        }
    }

    /// How much of the light of the sky counts along such a ray, where `has_shadow_rays` to the sky leave the surfaces that a
    /// camera sees.
    fn sky(&self, path: &PathState, has_shadow_rays: bool) -> Emission {
        match path.diffuse_bounces {
            0 if self.excludes_sky => Emission::Sampled,
            0 if has_shadow_rays => Emission::Weighted {
                rays: self.splits(path) as f32,
            },
            _ => Emission::Seen,
        }
    }
}

/// The weight of the diffuse lobe.
fn diffuse<F: Features>(surface: &SurfaceInteraction) -> Vec3 {
    surface.bsdf.base_weight::<F>() * surface.bsdf.diffuse
}

/// The probability of following the mirror, in proportion to the reflectances, one of which is not zero.
fn mirror_probability(diffuse: Vec3, mirror: Vec3) -> f32 {
    let (diffuse, mirror) = (diffuse.element_sum(), mirror.element_sum());
    mirror / (diffuse + mirror)
}

/// Traces paths.
pub(super) struct PathTracer<'a, F> {
    pub(super) light_sampler: &'a LightSampler<'a>,
    pub(super) schedule: Schedule<'a>,
    /// Samples the sky from surfaces that the camera sees; none if paths alone find it.
    pub(super) sky: Option<&'a SkySampler>,
    /// Ends paths beyond the first diffuse bounce where it has records.
    pub(super) cache: Option<&'a dyn CachedLight>,
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
        mut direct: Vec<Vec3>,
        radiance: &mut [Vec3],
    ) {
        let from_camera = |sample: &CameraSample| PathState {
            ray: sample.ray,
            sequence: sample.sequence,
            depth: 0,
            diffuse_bounces: 0,
            index: sample.index,
            technique: Technique::Single,
            emission: Emission::Seen,
            sky: Emission::Seen,
        };
        let paths: Vec<PathState> = samples.iter().map(from_camera).collect();
        self.add_sampled_lights(&paths, hit, &mut direct);
        self.outgoing_radiance(&paths, hit, &direct, radiance);
    }

    fn scene(&self) -> &Scene {
        self.light_sampler.scene()
    }

    /// The incident radiance along the last rays of up to [`WAVEFRONT_SIZE`] paths, with textures filtered over the
    /// footprints of these rays; over none if there are no `differentials`. `normal` gives the shading normal of the
    /// surface that a path leaves.
    fn incident_radiance(
        &mut self,
        paths: &[PathState],
        normal: impl Fn(usize) -> Vec3,
        differentials: &[RayDifferential],
        radiance: &mut [Vec3],
    ) {
        let scene = self.light_sampler.scene();
        let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
        let mut hits = vec![None; rays.len()];
        scene.closest_incoherent(&rays, &mut hits, self.query_state);
        let mut hit = surfaces::<F>(scene, &rays, differentials, &hits);
        // From the surface that a path leaves for its last ray.
        let (schedule, sky) = (self.schedule, self.sky);
        let shadow_rays =
            |path: &PathState| schedule.shadow_rays(path.diffuse_bounces.saturating_sub(1));
        for (i, emitted) in hit.emitted.iter_mut().enumerate() {
            if *emitted != Vec3::ZERO
                && let Some(hit) = &hits[i]
            {
                let path = &paths[i];
                *emitted *= path.emission_weight(scene, hit, normal(i), shadow_rays(path));
            }
        }
        let light_sampler = self.light_sampler;
        let mut weights = [1.0; WAVEFRONT_SIZE];
        let mut direct;
        if light_sampler.is_empty() {
            direct = self.direct_lighting(&hit.surfaces, &rays, |_| {});
        } else {
            let mut light_pdfs = [0.0; WAVEFRONT_SIZE];
            direct = self.direct_lighting(&hit.surfaces, &rays, |contribution| {
                light_pdfs[contribution.surface] += light_sampler.pdf(
                    contribution.light,
                    contribution.distance,
                    contribution.cosine,
                );
            });
            for (i, path) in paths.iter().enumerate() {
                let surface = hits[i].as_ref().zip(hit.surfaces[i].as_ref());
                weights[i] = path.mis_weight(surface, light_pdfs[i]);
                if weights[i] == 0.0 {
                    hit.surfaces[i] = None;
                }
            }
        }
        self.add_sampled_lights(paths, &hit, &mut direct);
        self.outgoing_radiance(paths, &hit, &direct, radiance);
        for (i, path) in paths.iter().enumerate() {
            if hits[i].is_none() {
                weights[i] *= path.sky_weight(scene, sky, normal(i), shadow_rays(path));
            }
            radiance[i] *= weights[i];
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

    /// Adds the light of emitters, balls and suns that the surfaces at the ends of paths reflect.
    fn add_sampled_lights(&mut self, paths: &[PathState], hit: &HitSurfaces, direct: &mut [Vec3]) {
        let scene = self.light_sampler.scene();
        let sky = self.sky;
        if !has_sampled_lights(scene, sky) {
            return;
        }
        let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
        let query_state = &mut *self.query_state;
        let closest =
            |rays: &[Ray], hits: &mut [_]| scene.closest_incoherent(rays, hits, query_state);
        let schedule = self.schedule;
        let numbers = |i: usize, surface: &SurfaceInteraction| ShadowNumbers {
            sequence: paths[i].sequence,
            index: paths[i].index,
            depth: paths[i].depth,
            rays: schedule.shadow_rays(paths[i].diffuse_bounces),
            cosine_rays: schedule.cosine_rays::<F>(&paths[i], surface),
            sky_rays: match paths[i].diffuse_bounces {
                0 if paths[i].depth < schedule.bounces => Some(schedule.splits(&paths[i]) as f32),
                _ => None,
            },
        };
        add_sampled_lights::<F>(scene, sky, hit, &rays, numbers, closest, direct);
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
            let mirror = surface.bsdf.mirror_weight::<F>();
            let diffuse = diffuse::<F>(surface);
            radiance[parent] =
                surface.bsdf.base_weight::<F>() * direct[parent] + hit.emitted(parent);
            let mut emit = |throughput, path| {
                splits.push(SplitPath {
                    parent,
                    throughput,
                    path,
                });
            };
            if path.depth == self.schedule.bounces {
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
    fn cached_irradiance(
        &mut self,
        path: &PathState,
        surface: &SurfaceInteraction,
    ) -> Option<Vec3> {
        let cache = self.cache?;
        let point = &surface.point;
        let distance = (point.position - path.ray.origin).length();
        let bounces_left = self.schedule.bounces - path.depth;
        let dimension = CACHE_DIMENSION_OFFSET + path.depth;
        let numbers = path.sequence.sample_2d(path.index, dimension);
        cache.mean_radiance(point, bounces_left, distance, numbers, self.query_state)
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
            let normal = |i: usize| match &hit.surfaces[wave[i].parent] {
                Some(surface) => surface.point.shading_normal,
                None => Vec3::ZERO,
            };
            self.incident_radiance(&paths, normal, &differentials, &mut incident);
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
        if diffuse == Vec3::ZERO && mirror == Vec3::ZERO {
            return;
        }
        let mirror_probability = if F::MIRRORS {
            mirror_probability(diffuse, mirror)
        } else {
            0.0
        };
        let count = self.schedule.splits(path);
        let emission = self.schedule.emission::<F>(path, surface);
        let sky = self.schedule.sky(path, self.sky.is_some());
        let (diffuse, mirror) = (diffuse / count as f32, mirror / count as f32);
        let diffuse = diffuse / (1.0 - mirror_probability);
        for i in 0..count {
            let next = PathState {
                depth: path.depth + 1,
                diffuse_bounces: path.diffuse_bounces + 1,
                index: path.index.wrapping_mul(count).wrapping_add(i),
                technique: Technique::Single,
                emission,
                sky,
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
            emission: Emission::Seen,
            sky: Emission::Seen,
            ..*path
        };
        emit(throughput, next);
    }
}
