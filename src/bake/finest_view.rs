//! How closely the frames of a path see the surfaces of a scene at most: what is seen closest decides how fine records
//! are, wherever it comes in the path.

use super::candidates::{Candidate, PathProbe};
use crate::irradiance_cache::CellKey;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// The side of the cells in which views are noted, in pixels; or up to half of that.
const PIXELS: f32 = 16.0;

/// The views of points with a certain number of bounces left.
#[derive(Debug, Default)]
pub(super) struct FinestView {
    /// Cells that are seen with pixels of their size.
    seen: FxHashSet<CellKey>,
    /// The lowest of their levels.
    finest: i32,
}

impl FinestView {
    /// The views of all frames, by the number of bounces left less 1.
    pub(super) fn of(probe: &PathProbe, on_frame: impl Fn() + Sync) -> Vec<FinestView> {
        let cells = |frame: u32| -> Vec<FxHashSet<CellKey>> {
            on_frame();
            let candidates = probe.candidates(frame).into_iter();
            let cells = candidates.map(|seen| seen.iter().map(|c| cell(c, own_level(c))).collect());
            cells.collect()
        };
        let merged = |mut a: Vec<FxHashSet<CellKey>>, b: Vec<FxHashSet<CellKey>>| {
            if a.is_empty() {
                return b;
            }
            a.iter_mut().zip(b).for_each(|(a, b)| a.extend(b));
            a
        };
        let frames = probe.frames_in_order();
        let seen = frames.into_par_iter().map(cells).reduce(Vec::new, merged);
        let view = |seen: FxHashSet<CellKey>| FinestView {
            finest: seen.iter().map(CellKey::level).min().unwrap_or(0),
            seen,
        };
        seen.into_iter().map(view).collect()
    }

    /// The level of the smallest cells around a candidate that are seen with pixels of their size: their side is 8 to
    /// 16 of these.
    pub(super) fn level(&self, candidate: &Candidate) -> i32 {
        let own = own_level(candidate);
        let finer = self.finest..own;
        finer
            .into_iter()
            .find(|&level| self.seen.contains(&cell(candidate, level)))
            .unwrap_or(own)
    }
}

fn own_level(candidate: &Candidate) -> i32 {
    CellKey::level_of_side(PIXELS * candidate.pixel)
}

fn cell(candidate: &Candidate, level: i32) -> CellKey {
    let point = &candidate.point;
    CellKey::containing(point.position, point.shading_normal, level)
}
