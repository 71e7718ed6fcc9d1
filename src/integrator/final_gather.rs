//! Final gathering: the indirect light at a point by paths over its hemisphere (Reichert 1992; Jensen 2001).

use super::cached_light::CachedLight;
use super::hit_surfaces::HitSurfaces;
use super::light_sampler::LightSampler;
use super::path_state::{Emission, PathState, Technique};
use super::path_tracer::{PathTracer, Schedule};
use crate::accel::QueryState;
use crate::material::{Bsdf, Features};
use crate::math::Ray;
use crate::sampling::SobolSequence;
use crate::scene::{Scene, SurfaceInteraction, SurfacePoint};
use glam::Vec3;
use std::marker::PhantomData;

/// A point of a surface, on one side of it, and the random numbers of its paths.
#[derive(Clone, Copy, Debug)]
pub struct GatherPoint {
    /// The point.
    pub point: SurfacePoint,
    /// The random numbers.
    pub sequence: SobolSequence,
    /// Sample index within `sequence`: points with the same sequence have different indices.
    pub index: u32,
}

/// The paths of a final gather.
#[derive(Clone, Copy, Debug)]
pub struct GatherPaths {
    /// Of how many bounces they are at most; at least 1.
    pub bounces_left: u32,
    /// How many leave each point.
    pub count: u32,
    /// Whether light that comes straight from the sky is part of what is gathered.
    pub include_sky: bool,
}

/// Gathers the light that arrives at points of a scene.
#[derive(Clone, Debug)]
pub struct FinalGather<'a> {
    light_sampler: LightSampler<'a>,
}

impl<'a> FinalGather<'a> {
    /// In a scene. Traces rays to find the lights that guide paths.
    pub fn new(scene: &'a Scene) -> FinalGather<'a> {
        FinalGather {
            light_sampler: LightSampler::new(scene),
        }
    }

    pub(super) fn scene(&self) -> &'a Scene {
        self.light_sampler.scene()
    }
}

/// The cosine-weighted mean radiance that arrives at points from their hemispheres. Light that comes straight from
/// emitters is not part of it.
///
/// With a cache, paths end beyond the first bounce where it knows the light; without one the estimate is unbiased.
pub(super) fn gather_for<F: Features>(
    final_gather: &FinalGather,
    points: &[GatherPoint],
    gather_paths: GatherPaths,
    cache: Option<&dyn CachedLight>,
    query_state: &mut QueryState,
) -> Vec<Vec3> {
    /// Reflects all incident light.
    const WHITE: Bsdf = Bsdf {
        diffuse: Vec3::ONE,
        specular: Vec3::ZERO,
        shininess: 0.0,
        reflective: Vec3::ZERO,
    };
    let mut path_tracer = PathTracer::<F> {
        light_sampler: &final_gather.light_sampler,
        schedule: Schedule {
            bounces: gather_paths.bounces_left,
            splits: &[gather_paths.count],
            shadow_rays: 1,
            counts_emitters_by_shadow_rays: true,
            excludes_sky: !gather_paths.include_sky,
        },
        sky: None,
        cache,
        query_state,
        features: PhantomData,
    };
    let surface = |point: &GatherPoint| {
        Some(SurfaceInteraction {
            point: point.point,
            bsdf: WHITE,
        })
    };
    let path = |point: &GatherPoint| PathState {
        ray: Ray::new(point.point.position, -point.point.shading_normal),
        sequence: point.sequence,
        depth: 0,
        diffuse_bounces: 0,
        index: point.index,
        technique: Technique::Single,
        emission: Emission::Seen,
        sky: Emission::Seen,
    };
    let paths: Vec<PathState> = points.iter().map(path).collect();
    let direct = vec![Vec3::ZERO; points.len()];
    let mut radiance = direct.clone();
    let hit = HitSurfaces {
        surfaces: points.iter().map(surface).collect(),
        emitted: Vec::new(),
        reflected: Vec::new(),
    };
    path_tracer.outgoing_radiance(&paths, &hit, &direct, &mut radiance);
    radiance
}
