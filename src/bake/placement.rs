//! Places records in cells: as fine as the closest view of the path asks for, down to a few pixels, where other surfaces are
//! close; coarser where the nearest one is far, as irradiance changes over distances in proportion to that (Ward et al. 1988).

use super::candidates::{Candidate, PathProbe};
use super::finest_view::FinestView;
use crate::accel::QueryState;
use crate::integrator::{eye_above, is_obstructed, place_in_cell, sees};
use crate::irradiance_cache::{CellKey, IrradianceRecord};
use crate::scene::{Scene, SurfacePoint};
use dashmap::DashMap;
use rayon::prelude::*;
use rustc_hash::{FxBuildHasher, FxHashSet};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The largest number of records, which limits memory to some gigabytes. Surfaces that they do not cover are
/// gathered for in each frame.
const MAX_RECORDS: usize = 1 << 21;

/// The largest side of a cell relative to the distance of the nearest surface that rises above its own.
const RELATIVE_SIDE: f64 = 1.0 / 3.0;

/// The sine of the elevation from which such surfaces count: what is lower sends and takes hardly any light.
const ELEVATION_SINE: f64 = 0.15;

/// Levels of the smallest and of the largest cells, above that at which a point is seen: sides of 2 to 4, and of 16 to 32
/// pixels.
const FINEST: i32 = -2;
const COARSEST: i32 = 1;

/// How many levels below the smallest cells some stand, where several surfaces share a cell.
const BELOW: i32 = 4;

/// The validity radius of a record, in sides of its cell.
const RADIUS: f32 = 1.5;

/// Of records: the largest angle between normals, in radians.
pub(super) const MAX_ANGLE: f32 = 20_f32.to_radians();

/// The height of a record's eye, in radii.
const EYE_HEIGHT: f32 = 0.15;

/// Frames whose candidates are found together.
const BATCH: usize = 8;

/// A record and the surface point where it stands.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct PlacedRecord {
    pub(super) point: SurfacePoint,
    pub(super) record: IrradianceRecord,
}

/// The record of a cell; none if it has no surface. It depends on the scene, the cell and the seed alone.
fn place(
    scene: &Scene,
    cell: &CellKey,
    seed: u32,
    query_state: &mut QueryState,
) -> Option<PlacedRecord> {
    let point = place_in_cell(scene, cell, seed, query_state)?;
    let radius = RADIUS * cell.side();
    Some(PlacedRecord {
        point,
        record: IrradianceRecord {
            position: point.position,
            normal: point.shading_normal,
            radius,
            eye: eye_above(scene, &point, EYE_HEIGHT * radius, query_state),
            is_obstructed: is_obstructed(scene, &point, radius),
        },
    })
}

/// The record of a cell that a path needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedCell {
    pub(super) placed: PlacedRecord,
    /// How many levels it is above the smallest that the closest view asks for, at most [`MAX_ABOVE`].
    pub(super) above: u8,
}

/// The most levels of a cell above the smallest.
pub(super) const MAX_ABOVE: u8 = (COARSEST - FINEST) as u8;

/// The cells that a path needs.
pub(super) type Cells = BTreeMap<CellKey, PlacedCell>;

/// Finds the cells for what is seen with a certain number of bounces left.
pub(super) struct Placement<'a> {
    pub(super) scene: &'a Scene,
    pub(super) seed: u32,
    /// Cells are this many levels smaller.
    pub(super) refinement: i32,
    pub(super) view: &'a FinestView,
    records: DashMap<CellKey, Option<PlacedRecord>, FxBuildHasher>,
}

impl Placement<'_> {
    /// The cells of a path, by the number of bounces left less 1.
    pub(super) fn of_path(
        probe: &PathProbe,
        refinement: u32,
        views: &[FinestView],
        on_frame: impl Fn() + Sync,
    ) -> Vec<Cells> {
        let placements: Vec<Placement> = views
            .iter()
            .map(|view| Placement {
                scene: probe.scene,
                seed: probe.seed,
                refinement: refinement as i32,
                view,
                records: DashMap::default(),
            })
            .collect();
        let mut cells = vec![Cells::new(); views.len()];
        let mut visited = vec![FxHashSet::default(); views.len()];
        for frames in probe.frames_in_order().chunks(BATCH) {
            let seen: Vec<Vec<Vec<Candidate>>> = frames
                .par_iter()
                .map(|&frame| {
                    on_frame();
                    probe.candidates(frame)
                })
                .collect();
            for seen in seen {
                for (index, candidates) in seen.into_iter().enumerate() {
                    if cells[index].len() < MAX_RECORDS {
                        let visited = &mut visited[index];
                        placements[index].add(&candidates, visited, &mut cells[index]);
                    }
                }
            }
        }
        cells
    }

    /// Adds the cells of the first candidate in each of the smallest cells.
    fn add(&self, candidates: &[Candidate], visited: &mut FxHashSet<CellKey>, cells: &mut Cells) {
        let smallest: Vec<(CellKey, i32)> = candidates
            .par_iter()
            .map(|candidate| {
                let level = self.view.level(candidate) - self.refinement;
                let point = &candidate.point;
                let finest = level + FINEST;
                (CellKey::containing(point.position, point.shading_normal, finest), level)
            })
            .collect();
        let new: Vec<(&SurfacePoint, i32)> = candidates
            .iter()
            .zip(smallest)
            .filter(|(_, (cell, _))| visited.insert(*cell))
            .map(|(candidate, (_, level))| (&candidate.point, level))
            .collect();
        let found: Vec<(CellKey, PlacedCell)> = new
            .par_iter()
            .with_min_len(16)
            .filter_map(|(point, level)| self.cell_of(point, *level))
            .collect();
        for (cell, placed) in found {
            let known = cells.entry(cell).or_insert(placed);
            known.above = known.above.max(placed.above);
        }
    }

    /// The cell whose record covers a point: the largest that its surroundings allow, or a smaller one if several surfaces
    /// share that.
    fn cell_of(&self, point: &SurfacePoint, level: i32) -> Option<(CellKey, PlacedCell)> {
        let (finest, coarsest) = (level + FINEST, level + COARSEST);
        let query_state = &mut QueryState::default();
        let largest = f64::from(libm::exp2f(coarsest as f32));
        let within = largest / RELATIVE_SIDE;
        let clearance = self.scene.clearance(point, ELEVATION_SINE, within);
        let side = clearance.map_or(largest, |distance| distance * RELATIVE_SIDE);
        let start = CellKey::level_of_side(side as f32).clamp(finest, coarsest);
        (finest - BELOW..=start).rev().find_map(|level| {
            let cell = CellKey::containing(point.position, point.shading_normal, level);
            let record = *self
                .records
                .entry(cell)
                .or_insert_with(|| place(self.scene, &cell, self.seed, query_state));
            let placed = record.filter(|placed| self.covers(&placed.record, point))?;
            let above = (level - finest).max(0) as u8;
            Some((cell, PlacedCell { placed, above }))
        })
    }

    fn covers(&self, record: &IrradianceRecord, point: &SurfacePoint) -> bool {
        let normal_weight = 1.0 / (1.0 - libm::cosf(MAX_ANGLE));
        let (position, normal) = (point.position, point.shading_normal);
        if record.weight(position, normal, normal_weight) <= 0.0 {
            return false;
        }
        !record.is_doubtful(position, normal)
            || sees(self.scene, point, record.eye, &mut QueryState::default())
    }
}
