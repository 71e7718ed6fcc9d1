//! Cached light where paths end beyond their first diffuse bounce.

use super::cached_light::CachedLight;
use super::cell_light::CellLight;
use super::feature_sets::for_each_feature_set;
use super::final_gather::{FinalGather, GatherPaths, GatherPoint, gather_for};
use crate::accel::QueryState;
use crate::irradiance_cache::{CellIrradiance, CellKey};
use crate::material::{FeatureSet, Features};
use crate::scene::SurfacePoint;
use glam::Vec3;
use std::marker::PhantomData;

impl FinalGather<'_> {
    /// The cosine-weighted mean radiance that arrives at points from their hemispheres. Light that comes straight from
    /// emitters is not part of it. Paths end beyond the first bounce in secondary records; those that are missing are
    /// gathered.
    pub fn gather(
        &self,
        points: &[GatherPoint],
        paths: GatherPaths,
        secondary: &CellIrradiance,
        query_state: &mut QueryState,
    ) -> Vec<Vec3> {
        let for_features = GATHER[self.scene().features().index()];
        for_features(self, points, paths, secondary, query_state)
    }
}

type GatherFor =
    fn(&FinalGather, &[GatherPoint], GatherPaths, &CellIrradiance, &mut QueryState) -> Vec<Vec3>;

/// [`FinalGather::gather`] for each set of features.
static GATHER: [GatherFor; FeatureSet::COUNT] = for_each_feature_set!(gather_cached);

/// [`FinalGather::gather`] for the features of the scene.
fn gather_cached<F: Features>(
    final_gather: &FinalGather,
    points: &[GatherPoint],
    paths: GatherPaths,
    secondary: &CellIrradiance,
    query_state: &mut QueryState,
) -> Vec<Vec3> {
    let cache = SecondaryLight::<F>::new(final_gather, secondary);
    gather_for::<F>(final_gather, points, paths, Some(&cache), query_state)
}

/// The secondary records of a scene, gathered as paths ask for them.
pub(super) struct SecondaryLight<'a, F> {
    light: CellLight<'a>,
    features: PhantomData<F>,
}

/// Rays shorter than this, in sides of cells, end too close to their origin for records of this size.
const MIN_DISTANCE: f32 = 2.5;

/// Sizes of cells, each half the last: where surfaces are close together.
const SIZES: i32 = 2;

impl<'a, F: Features> SecondaryLight<'a, F> {
    /// Those of some cells.
    pub(super) fn new(
        final_gather: &'a FinalGather<'a>,
        cells: &'a CellIrradiance,
    ) -> SecondaryLight<'a, F> {
        SecondaryLight {
            light: CellLight {
                final_gather,
                cells,
                only_free: true,
                include_sky: true,
            },
            features: PhantomData,
        }
    }
}

impl<F: Features> CachedLight for SecondaryLight<'_, F> {
    fn mean_radiance(
        &self,
        point: &SurfacePoint,
        bounces_left: u32,
        distance: f32,
        numbers: [f32; 2],
        query_state: &mut QueryState,
    ) -> Option<Vec3> {
        let normal = point.shading_normal;
        let largest = i32::from(self.light.cells.settings().level);
        for level in (largest + 1 - SIZES..=largest).rev() {
            let cell_at = |position: Vec3| CellKey::containing(position, normal, level);
            if distance < MIN_DISTANCE * cell_at(point.position).side() {
                return None;
            }
            let light = &self.light;
            let value =
                light.value_around::<F>(point, cell_at, bounces_left, numbers, self, query_state);
            if value.is_some() {
                return value;
            }
        }
        None
    }
}
