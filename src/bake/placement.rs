//! Places records in cells: as fine as the closest view of the path asks for, down to a few pixels, where other surfaces are
//! close; coarser where the nearest one is far, as irradiance changes over distances in proportion to that (Ward et al. 1988).

use super::candidates::{Candidate, PathProbe};
use super::finest_view::FinestView;
use crate::accel::QueryState;
use crate::integrator::{record_in_cell, sees_record};
use crate::irradiance_cache::{CellKey, IrradianceRecord, IrradianceRecords};
use crate::math::to_world;
use crate::scene::{Scene, SurfacePoint};
use dashmap::DashMap;
use glam::Vec3;
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

/// Levels of the smallest and of the largest cells, relative to that of [`FinestView::level`]: sides of 2 to 4, and of 16 to
/// 32 pixels.
const FINEST: i32 = -2;
const COARSEST: i32 = 1;

/// How many levels below the smallest cells some stand, where several surfaces share a cell.
const BELOW: i32 = 4;

/// How many levels below the smallest cells some stand at steps of irradiance.
const BELOW_AT_STEPS: i32 = 2;

/// The validity radius of a record, in sides of its cell.
const RADIUS: f32 = 1.25;

/// Of records: the largest angle between normals, in radians.
pub(super) const MAX_ANGLE: f32 = 35_f32.to_radians();

/// Frames whose candidates are found together.
const BATCH: usize = 8;

/// A record and the surface point where it stands.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct PlacedRecord {
    pub(super) point: SurfacePoint,
    pub(super) record: IrradianceRecord,
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

/// A point that frames see and how closely they do.
#[derive(Clone, Copy, Debug)]
struct SeenPoint {
    point: SurfacePoint,
    /// See [`FinestView::level`].
    level: i32,
}

/// The cells of a path for what is seen with a certain number of bounces left.
pub(super) struct Placement<'a> {
    scene: &'a Scene,
    seed: u32,
    /// Cells are this many levels smaller.
    refinement: i32,
    view: &'a FinestView,
    /// Of all cells that were looked at.
    records: DashMap<CellKey, Option<PlacedRecord>, FxBuildHasher>,
    visited: FxHashSet<CellKey>,
    /// The first point in each of the smallest cells.
    points: Vec<SeenPoint>,
    pub(super) cells: Cells,
}

impl<'a> Placement<'a> {
    /// The cells of a path, by the number of bounces left less 1.
    pub(super) fn of_path(
        probe: &PathProbe<'a>,
        refinement: u32,
        views: &'a [FinestView],
        on_frame: impl Fn() + Sync,
    ) -> Vec<Placement<'a>> {
        let empty = |view| Placement {
            scene: probe.scene,
            seed: probe.seed,
            refinement: refinement as i32,
            view,
            records: DashMap::default(),
            visited: FxHashSet::default(),
            points: Vec::new(),
            cells: Cells::new(),
        };
        let mut placements: Vec<Placement> = views.iter().map(empty).collect();
        for frames in probe.frames_in_order().chunks(BATCH) {
            let candidates = |&frame: &u32| {
                on_frame();
                probe.candidates(frame)
            };
            let seen: Vec<Vec<Vec<Candidate>>> = frames.par_iter().map(candidates).collect();
            for candidates in seen {
                for (placement, candidates) in placements.iter_mut().zip(candidates) {
                    placement.add(&candidates);
                }
            }
        }
        placements
    }

    /// Adds the cells of the first candidate in each of the smallest cells.
    fn add(&mut self, candidates: &[Candidate]) {
        let seen_point = |candidate: &Candidate| {
            let point = candidate.point;
            let level = self.view.level(candidate) - self.refinement;
            let smallest = level + FINEST;
            let cell = CellKey::narrow(point.position, point.shading_normal, smallest);
            (cell, SeenPoint { point, level })
        };
        let seen: Vec<(CellKey, SeenPoint)> = candidates.par_iter().map(seen_point).collect();
        let first = self.points.len();
        for (cell, point) in seen {
            if self.visited.insert(cell) {
                self.points.push(point);
            }
        }
        let new = self.points[first..].par_iter().with_min_len(16);
        let found = new.filter_map(|seen| self.cell_of(seen, self.largest_level(seen)));
        let found: Vec<_> = found.collect();
        self.insert(found);
    }

    fn insert(&mut self, cells: Vec<(CellKey, PlacedCell)>) {
        for (cell, placed) in cells {
            if self.cells.len() >= MAX_RECORDS {
                break;
            }
            let known = self.cells.entry(cell).or_insert(placed);
            known.above = known.above.max(placed.above);
        }
    }

    /// Adds smaller cells, of half the side, around records that stand too far apart.
    pub(super) fn refine(&mut self, too_far_apart: Vec<IrradianceRecord>) {
        /// The part of a record's radius within which cells get smaller.
        const PART: f32 = 0.8;
        let shrunk = |record: IrradianceRecord| IrradianceRecord {
            radius: PART * record.radius,
            ..record
        };
        let coarse = too_far_apart.into_iter().map(shrunk).collect();
        let (coarse, _) = IrradianceRecords::new(self.scene.bounds(), MAX_ANGLE, coarse);
        let finer = |seen: &SeenPoint| -> Vec<(CellKey, PlacedCell)> {
            let (position, normal) = (seen.point.position, seen.point.shading_normal);
            let Some(smallest) = coarse.smallest_around(position, normal) else {
                return Vec::new();
            };
            let side = smallest / (PART * RADIUS);
            let level = CellKey::level_of_side(0.75 * side);
            match seen.level + FINEST - level {
                ..=0 => self.cell_of(seen, level).into_iter().collect(),
                below @ 1..=BELOW_AT_STEPS => self.cells_around(seen, level, below),
                _ => Vec::new(),
            }
        };
        let found = self.points.par_iter().with_min_len(64).flat_map_iter(finer);
        let found: Vec<_> = found.collect();
        self.insert(found);
    }

    /// All cells of a level in the smallest cell around a point, of which there is only one: those of the point's own
    /// plane.
    fn cells_around(&self, seen: &SeenPoint, level: i32, below: i32) -> Vec<(CellKey, PlacedCell)> {
        let (position, normal) = (seen.point.position, seen.point.shading_normal);
        let side = libm::exp2f(level as f32);
        let steps = 1 << below;
        let offsets = (-steps..=steps).map(|step| 0.5 * step as f32 * side);
        let grid = offsets
            .clone()
            .flat_map(|x| offsets.clone().map(move |y| (x, y)));
        let cell = |(x, y)| {
            let at = position + to_world(normal, Vec3::new(x, y, 0.0));
            let cell = CellKey::containing(at, normal, level);
            let placed = self.record(&cell)?;
            Some((cell, PlacedCell { placed, above: 0 }))
        };
        grid.filter_map(cell).collect()
    }

    /// The record of a cell; none if it has no surface. It depends on the scene, the cell and the seed alone.
    fn record(&self, cell: &CellKey) -> Option<PlacedRecord> {
        let place = || {
            let (radius, query_state) = (RADIUS * cell.side(), &mut QueryState::default());
            let (point, record) = record_in_cell(self.scene, cell, radius, self.seed, query_state)?;
            Some(PlacedRecord { point, record })
        };
        *self.records.entry(*cell).or_insert_with(place)
    }

    /// The level of the largest cell at a point that its surroundings allow.
    fn largest_level(&self, seen: &SeenPoint) -> i32 {
        let (finest, coarsest) = (seen.level + FINEST, seen.level + COARSEST);
        let largest = f64::from(libm::exp2f(coarsest as f32));
        let within = largest / RELATIVE_SIDE;
        let clearance = self.scene.clearance(&seen.point, ELEVATION_SINE, within);
        let side = clearance.map_or(largest, |distance| distance * RELATIVE_SIDE);
        CellKey::level_of_side(side as f32).clamp(finest, coarsest)
    }

    /// The cell whose record covers a point: at a level, or below if several surfaces share that.
    fn cell_of(&self, seen: &SeenPoint, level: i32) -> Option<(CellKey, PlacedCell)> {
        let (point, finest) = (&seen.point, seen.level + FINEST);
        let (position, normal) = (point.position, point.shading_normal);
        let of_level = |level: i32| {
            let narrow = (level <= finest).then(|| CellKey::narrow(position, normal, level));
            [Some(CellKey::containing(position, normal, level)), narrow]
        };
        let mut cells = (finest - BELOW..=level).rev().flat_map(of_level).flatten();
        cells.find_map(|cell| {
            let record = self.record(&cell);
            let placed = record.filter(|placed| self.covers(&placed.record, point))?;
            let above = (cell.level() - finest).max(0) as u8;
            Some((cell, PlacedCell { placed, above }))
        })
    }

    fn covers(&self, record: &IrradianceRecord, point: &SurfacePoint) -> bool {
        let angle_weight = IrradianceRecord::angle_weight(MAX_ANGLE);
        record.weight(point.position, point.shading_normal, angle_weight) > 0.0
            && sees_record(self.scene, point, record, &mut QueryState::default())
    }
}
