//! The records of cells, gathered when they are first asked for.

use super::cached_light::CachedLight;
use super::cell_place::{place_in_cell, record_in_cell, sees_record};
use super::final_gather::{FinalGather, GatherPaths, GatherPoint, gather_for};
use crate::accel::QueryState;
use crate::irradiance_cache::{CellIrradiance, CellKey, CellRecord, IrradianceRecord};
use crate::material::Features;
use crate::math::to_world;
use crate::sampling::SobolSequence;
use crate::scene::SurfacePoint;
use glam::Vec3;
use std::f32::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// The validity radius of a record, in sides of its cell.
const RADIUS: f32 = 2.0;

/// [The weight](IrradianceRecord::angle_weight) of angles of up to 45 degrees between normals.
const ANGLE_WEIGHT: f32 = 1.0 / (1.0 - FRAC_1_SQRT_2);

/// The light in cells of a scene.
pub(super) struct CellLight<'a> {
    pub(super) final_gather: &'a FinalGather<'a>,
    pub(super) cells: &'a CellIrradiance,
    /// Whether records with other surfaces near them are not used: irradiance changes too fast for their size.
    pub(super) only_free: bool,
    /// Whether light that comes straight from the sky is part of what they hold.
    pub(super) include_sky: bool,
}

impl CellLight<'_> {
    /// The value of the record of a cell, which is gathered by paths that end in `ends`; none if it is not valid at a point.
    fn value<F: Features>(
        &self,
        point: &SurfacePoint,
        cell: CellKey,
        bounces_left: u32,
        ends: &dyn CachedLight,
        query_state: &mut QueryState,
    ) -> Option<Vec3> {
        let (place, value) = match self.cells.known(&cell, bounces_left) {
            Some(known) => known?,
            None => (self.record(cell)?.place, None),
        };
        if !self.is_valid(point, &place, query_state) {
            return None;
        }
        if value.is_some() {
            return value;
        }
        let record = self.record(cell)?;
        let value = record.values.get(bounces_left as usize - 1)?;
        Some(*value.get_or_init(|| self.gather::<F>(&cell, bounces_left, ends)))
    }

    /// The record of a cell. The rays that find its place are not those of the point that asks: others find it there.
    fn record(&self, cell: CellKey) -> Option<Arc<CellRecord>> {
        let (scene, seed) = (self.final_gather.scene(), self.cells.settings().seed);
        self.cells.record(cell, || {
            let query_state = &mut QueryState::default();
            let radius = RADIUS * cell.side();
            record_in_cell(scene, &cell, radius, seed, query_state).map(|(_, record)| record)
        })
    }

    /// The value around a point of a cell close by, by chance, as two random numbers say: in the mean, edges of cells vanish;
    /// of the point's own if that is not valid.
    pub(super) fn value_around<F: Features>(
        &self,
        point: &SurfacePoint,
        cell_at: impl Fn(Vec3) -> CellKey,
        bounces_left: u32,
        numbers: [f32; 2],
        ends: &dyn CachedLight,
        query_state: &mut QueryState,
    ) -> Option<Vec3> {
        let own = cell_at(point.position);
        let [u, v] = numbers.map(|u| (u - 0.5) * own.side());
        let offset = to_world(point.shading_normal, Vec3::new(u, v, 0.0));
        let cells = [cell_at(point.position + offset), own];
        let mut values = cells
            .into_iter()
            .map(|cell| self.value::<F>(point, cell, bounces_left, ends, query_state));
        values.find_map(|value| value)
    }

    fn is_valid(
        &self,
        point: &SurfacePoint,
        record: &IrradianceRecord,
        query_state: &mut QueryState,
    ) -> bool {
        if self.only_free && !record.is_free() {
            return false;
        }
        record.weight(point.position, point.shading_normal, ANGLE_WEIGHT) > 0.0
            && sees_record(self.final_gather.scene(), point, record, query_state)
    }

    fn gather<F: Features>(
        &self,
        cell: &CellKey,
        bounces_left: u32,
        ends: &dyn CachedLight,
    ) -> Vec3 {
        let settings = self.cells.settings();
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
                include_sky: self.include_sky,
            },
            Some(ends),
            &mut query_state,
        );
        gathered[0]
    }
}
