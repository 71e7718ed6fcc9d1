//! Cached light where paths end beyond their first diffuse bounce.

use super::cell_place::{eye_above, is_obstructed, place_in_cell, sees};
use super::feature_sets::for_each_feature_set;
use super::final_gather::{FinalGather, GatherPaths, GatherPoint, gather_for};
use super::path_tracer::CachedLight;
use crate::accel::QueryState;
use crate::irradiance_cache::{CellKey, SecondaryIrradiance, SecondaryPlace};
use crate::material::{FeatureSet, Features};
use crate::math::to_world;
use crate::sampling::SobolSequence;
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
        secondary: &SecondaryIrradiance,
        query_state: &mut QueryState,
    ) -> Vec<Vec3> {
        let for_features = GATHER[self.scene().features().index()];
        for_features(self, points, paths, secondary, query_state)
    }
}

type GatherFor = fn(
    &FinalGather,
    &[GatherPoint],
    GatherPaths,
    &SecondaryIrradiance,
    &mut QueryState,
) -> Vec<Vec3>;

/// [`FinalGather::gather`] for each set of features.
static GATHER: [GatherFor; FeatureSet::COUNT] = for_each_feature_set!(gather_cached);

/// [`FinalGather::gather`] for the features of the scene.
pub(super) fn gather_cached<F: Features>(
    final_gather: &FinalGather,
    points: &[GatherPoint],
    paths: GatherPaths,
    secondary: &SecondaryIrradiance,
    query_state: &mut QueryState,
) -> Vec<Vec3> {
    let cache = SecondaryLight::<F> {
        final_gather,
        irradiance: secondary,
        features: PhantomData,
    };
    gather_for::<F>(final_gather, points, paths, Some(&cache), query_state)
}

/// The secondary records of a scene, gathered as paths ask for them.
struct SecondaryLight<'a, F> {
    final_gather: &'a FinalGather<'a>,
    irradiance: &'a SecondaryIrradiance,
    features: PhantomData<F>,
}

/// Rays shorter than this, in sides of cells, end too close to their origin for records of this size.
const MIN_DISTANCE: f32 = 2.5;

/// Sizes of cells, and how many levels smaller each is than the last: where surfaces are close together.
const SIZES: u32 = 2;
const SMALLER: i32 = 1;

/// Points this far from a record, in sides of its cell, and above or below it, may ask for it.
const MAX_DISTANCE: f32 = 2.0;
const MAX_HEIGHT: f32 = 0.4;

/// The cosine of the largest angle between their normals.
const MIN_COSINE: f32 = 0.7;

/// The height of the eye, in sides.
const EYE_HEIGHT: f32 = 0.2;

impl<F: Features> SecondaryLight<'_, F> {
    fn place(&self, cell: &CellKey, query_state: &mut QueryState) -> Option<SecondaryPlace> {
        let scene = self.final_gather.scene();
        let point = place_in_cell(scene, cell, self.irradiance.settings().seed, query_state)?;
        Some(SecondaryPlace {
            position: point.position,
            normal: point.shading_normal,
            eye: eye_above(scene, &point, EYE_HEIGHT * cell.side(), query_state),
            is_obstructed: is_obstructed(scene, &point, MAX_DISTANCE * cell.side()),
        })
    }

    /// Whether a point may ask for a record.
    fn is_valid(
        &self,
        point: &SurfacePoint,
        place: &SecondaryPlace,
        side: f32,
        query_state: &mut QueryState,
    ) -> bool {
        /// As of primary records.
        const SURE_HEIGHT: f32 = 0.02;
        let offset = point.position - place.position;
        let (distance, height) = (offset.length(), offset.dot(place.normal).abs());
        let cosine = point.shading_normal.dot(place.normal);
        // Irradiance changes too fast for records of this size.
        if place.is_obstructed {
            return false;
        }
        if distance > MAX_DISTANCE * side || height > MAX_HEIGHT * side || cosine < MIN_COSINE {
            return false;
        }
        let turned = distance * (1.0 - cosine * cosine).max(0.0).sqrt();
        let is_sure = height < SURE_HEIGHT * side + turned;
        is_sure || sees(self.final_gather.scene(), point, place.eye, query_state)
    }

    /// The value of the record of a cell, gathered if nobody has asked for it before.
    fn value(
        &self,
        point: &SurfacePoint,
        cell: CellKey,
        bounces_left: u32,
        query_state: &mut QueryState,
    ) -> Option<Vec3> {
        let record = self
            .irradiance
            .record(cell, || self.place(&cell, query_state))?;
        if !self.is_valid(point, &record.place, cell.side(), query_state) {
            return None;
        }
        let value = record.values.get(bounces_left as usize - 1)?;
        Some(*value.get_or_init(|| self.gather(&cell, bounces_left)))
    }

    fn gather(&self, cell: &CellKey, bounces_left: u32) -> Vec3 {
        let settings = self.irradiance.settings();
        let mut query_state = QueryState::default();
        let scene = self.final_gather.scene();
        let Some(point) = place_in_cell(scene, cell, settings.seed, &mut query_state) else {
            return Vec3::ZERO;
        };
        let [level_and_facing, x, y, z] = cell.words();
        let sequence = SobolSequence::new(settings.seed ^ level_and_facing, x, y, z);
        let gathered = gather_for::<F>(
            self.final_gather,
            &[GatherPoint {
                point,
                sequence: sequence.stream(bounces_left),
                index: 0,
            }],
            GatherPaths {
                bounces_left,
                count: settings.paths,
                include_sky: true,
            },
            Some(self),
            &mut query_state,
        );
        gathered[0]
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
        let mut level = i32::from(self.irradiance.settings().level);
        for _ in 0..SIZES {
            let at = |position: Vec3| CellKey::containing(position, normal, level);
            let own = at(point.position);
            if distance < MIN_DISTANCE * own.side() {
                return None;
            }
            // A cell close by, by chance: in the mean, edges of cells vanish.
            let [u, v] = numbers.map(|u| (u - 0.5) * own.side());
            let beside = at(point.position + to_world(normal, Vec3::new(u, v, 0.0)));
            for cell in [beside, own] {
                let value = self.value(point, cell, bounces_left, query_state);
                if value.is_some() {
                    return value;
                }
            }
            level -= SMALLER;
        }
        None
    }
}
