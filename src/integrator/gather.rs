use super::for_each_feature_set;
use super::monte_carlo::Estimator;
use super::path::{Choice, Path};
use crate::accel::Traversal;
use crate::irradiance_cache::SecondaryIrradiance;
use crate::material::{FeatureSet, Features, Reflectance};
use crate::math::Ray;
use crate::sampling::Sequence;
use crate::scene::{Scene, Surface, SurfacePoint};
use glam::Vec3;
use std::marker::PhantomData;

/// A point of a surface, on one side of it, and the random numbers of what is gathered there.
#[derive(Clone, Copy, Debug)]
pub struct GatherPoint {
    /// The point.
    pub point: SurfacePoint,
    /// The numbers.
    pub sequence: Sequence,
    /// Which of them: points with the same sequence have indices of their own.
    pub index: u32,
}

/// The mean radiance that arrives at points from their hemispheres, weighted by the cosine, where `left`
/// bounces are counted, at least one.
///
/// Each is an estimate of `paths` paths. With `known` light they end where that is known, beyond the first
/// bounce; else nothing but chance is in the way of the truth.
pub fn gather(
    scene: &Scene,
    points: &[GatherPoint],
    left: u32,
    paths: u32,
    known: Option<&SecondaryIrradiance>,
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    GATHER[scene.features().number()](scene, points, left, paths, known, traversal)
}

/// [`gather`] for the features of the scene.
pub(super) fn gather_for<F: Features>(
    scene: &Scene,
    points: &[GatherPoint],
    left: u32,
    paths: u32,
    known: Option<&SecondaryIrradiance>,
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    /// Sends back all that it gathers.
    const WHITE: Reflectance = Reflectance {
        diffuse: Vec3::ONE,
        specular: Vec3::ZERO,
        shininess: 0.0,
        reflective: Vec3::ZERO,
    };
    let mut estimator = Estimator::<F> {
        scene,
        bounces: left,
        splits: &[paths],
        known,
        traversal,
        features: PhantomData,
    };
    let surface = |gathered: &GatherPoint| {
        Some(Surface {
            point: gathered.point,
            reflectance: WHITE,
        })
    };
    let path = |gathered: &GatherPoint| Path {
        ray: Ray::new(gathered.point.position, -gathered.point.shading_normal),
        sequence: gathered.sequence,
        depth: 0,
        diffuse_bounces: 0,
        index: gathered.index,
        choice: Choice::Only,
    };
    let surfaces: Vec<Option<Surface>> = points.iter().map(surface).collect();
    let paths: Vec<Path> = points.iter().map(path).collect();
    let unlit = vec![Vec3::ZERO; points.len()];
    let mut light = unlit.clone();
    estimator.leaving(&paths, &surfaces, &unlit, &mut light);
    light
}

type GatherFor =
    fn(&Scene, &[GatherPoint], u32, u32, Option<&SecondaryIrradiance>, &mut Traversal) -> Vec<Vec3>;

static GATHER: [GatherFor; FeatureSet::COUNT] = for_each_feature_set!(gather_for);
