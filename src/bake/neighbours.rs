//! Finds records of about the same size around a point: a grid for each radius.

use crate::irradiance_cache::IrradianceRecord;
use glam::{IVec3, Vec3};
use rustc_hash::FxHashMap;

/// The side of the cells of a grid, in radii of its records.
const SIDE: f32 = 4.0;

/// Records by radius and cell.
#[derive(Debug)]
pub(super) struct Neighbours {
    /// All radii, growing.
    radii: Vec<f32>,
    cells: FxHashMap<(u32, IVec3), Vec<u32>>,
}

fn cell(position: Vec3, radius: f32) -> IVec3 {
    (position / (SIDE * radius)).floor().as_ivec3()
}

impl Neighbours {
    pub(super) fn new(records: &[IrradianceRecord]) -> Neighbours {
        let mut cells: FxHashMap<_, Vec<u32>> = FxHashMap::default();
        for (index, record) in (0..).zip(records.iter()) {
            let key = (
                record.radius.to_bits(),
                cell(record.position, record.radius),
            );
            cells.entry(key).or_default().push(index);
        }
        let mut radii: Vec<f32> = records.iter().map(|record| record.radius).collect();
        radii.sort_unstable_by(f32::total_cmp);
        radii.dedup();
        Neighbours { radii, cells }
    }

    /// Calls `visitor` with the numbers of all records that have radii within a factor of `radius`, up or down, and are at
    /// most `reach` from a position, and of some that are farther.
    pub(super) fn visit(
        &self,
        position: Vec3,
        radius: f32,
        factor: f32,
        reach: f32,
        mut visitor: impl FnMut(usize),
    ) {
        let is_alike = |&other: &f32| (radius / factor..=radius * factor).contains(&other);
        for other in self.radii.iter().copied().filter(is_alike) {
            let (min, max) = (cell(position - reach, other), cell(position + reach, other));
            for x in min.x..=max.x {
                for y in min.y..=max.y {
                    for z in min.z..=max.z {
                        let key = (other.to_bits(), IVec3::new(x, y, z));
                        let found = self.cells.get(&key).into_iter().flatten();
                        found.for_each(|&index| visitor(index as usize));
                    }
                }
            }
        }
    }
}
