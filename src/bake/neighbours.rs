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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    /// All records of like radii within reach are visited, each once.
    #[test]
    fn finds_what_brute_force_finds() {
        let mut random = Random::new(3);
        let records: Vec<IrradianceRecord> = (0..2000)
            .map(|_| IrradianceRecord {
                position: random.vector(1.0),
                normal: Vec3::Y,
                radius: 0.01 * libm::exp2f(random.below(5) as f32),
                eye: Vec3::ZERO,
                free_radius: f32::INFINITY,
            })
            .collect();
        let neighbours = Neighbours::new(&records);
        let mut found = 0;
        for record in &records[..200] {
            let mut visits = vec![0; records.len()];
            let reach = 4.0 * record.radius;
            neighbours.visit(record.position, record.radius, 2.1, reach, |i| {
                visits[i] += 1
            });
            for (other, visits) in records.iter().zip(visits) {
                let ratio = other.radius / record.radius;
                let is_alike = (1.0 / 2.1..=2.1).contains(&ratio);
                let is_near = other.position.distance(record.position) <= reach;
                assert!(visits <= u32::from(is_alike));
                assert!(visits == 1 || !is_alike || !is_near);
                found += u32::from(is_alike && is_near);
            }
        }
        assert!(found > 500, "{found}");
    }
}
