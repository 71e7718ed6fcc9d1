//! Irradiance at what the camera sees, interpolated for many points at once.

use super::irradiance_gradient::LinearIrradiance;
use super::lookup::{Interpolate, LANES, Sight};
use super::octree::{Leaf, Octree};
use super::records::IrradianceRecords;
use crate::simd::{Kernel, SetBits};
use glam::Vec3;
use std::sync::Arc;

/// Mean incident radiance at surfaces that the camera sees with a certain number of bounces left.
#[derive(Debug)]
pub struct PrimaryIrradiance {
    /// The records.
    pub records: Arc<IrradianceRecords>,
    /// Indexed by record.
    pub values: Vec<LinearIrradiance>,
    /// Half the difference between what each half of the paths would give, indexed by record.
    pub half_difference: Vec<LinearIrradiance>,
}

impl PrimaryIrradiance {
    /// The interpolated value, E / π in W/(sr m²), at each point, given as position and unit normal; none where no
    /// record covers it. The result at a point does not depend on the other points.
    ///
    /// Weighted mean of the values of all records that cover a point (Shepard 1968, "A Two-Dimensional
    /// Interpolation Function for Irregularly-Spaced Data"; of linear functions as in Renka 1988, "Multivariate
    /// Interpolation of Large Sets of Scattered Data"), and that it sees: of up to sixteen points, by their numbers, each
    /// with the eye of a record, `blocked` gives the mask of those that do not see it. It is asked where that is in doubt.
    pub fn mean_radiance(
        &self,
        points: &[(Vec3, Vec3)],
        kernel: Kernel,
        mut blocked: impl FnMut(&[(u32, Vec3)]) -> u32,
    ) -> Vec<Option<Vec3>> {
        let mut values = vec![None; points.len()];
        let tree = self.records.tree();
        for group in groups(tree, points) {
            let of_group = group.points.map(|index| points[index as usize]);
            let candidates = tree.boxes(group.leaf.node);
            let numbers = &group.points[..group.count];
            let used = u32::MAX >> (u32::BITS - group.count as u32);
            let mut sight = Vec::new();
            let found = loop {
                let interpolated = kernel.run(Interpolate {
                    points: &of_group,
                    candidates,
                    records: &self.records,
                    values: &self.values,
                    sight: &sight,
                });
                let doubts = interpolated
                    .doubts
                    .into_iter()
                    .flat_map(|(place, mask)| SetBits(mask & used).map(move |lane| (place, lane)));
                let doubts: Vec<(usize, usize)> = doubts.collect();
                if doubts.is_empty() {
                    break interpolated.values;
                }
                sight.resize(candidates.len(), Sight::default());
                for doubts in doubts.chunks(LANES) {
                    let eye = |place: usize| self.records[candidates[place] as usize].eye;
                    let pairs = doubts
                        .iter()
                        .map(|&(place, lane)| (numbers[lane], eye(place)));
                    let blocked = blocked(&pairs.collect::<Vec<_>>());
                    for (bit, &(place, lane)) in doubts.iter().enumerate() {
                        sight[place].asked |= 1 << lane;
                        sight[place].blocked |= (blocked >> bit & 1) << lane;
                    }
                }
            };
            for (&index, value) in numbers.iter().zip(found) {
                values[index as usize] = value;
            }
        }
        values
    }

    /// What each half of the paths would give.
    pub(super) fn halves(&self) -> [PrimaryIrradiance; 2] {
        [1.0, -1.0].map(|sign| {
            let both = self.values.iter().zip(&self.half_difference);
            PrimaryIrradiance {
                records: self.records.clone(),
                values: both.map(|(value, half)| value.plus(sign, half)).collect(),
                half_difference: Vec::new(),
            }
        })
    }

    /// Memory in bytes.
    pub fn memory(&self) -> usize {
        let values = size_of_val(&*self.values) + size_of_val(&*self.half_difference);
        self.records.memory() + values
    }
}

/// Points of one leaf that are looked up together.
struct Group {
    leaf: Leaf,
    /// How many lanes are used.
    count: usize,
    /// Indices of the points, by lane; unused lanes repeat the first.
    points: [u32; LANES],
}

/// Points go to one of so many groups, if any takes them.
const OPEN: usize = 8;

/// Divides points into groups.
fn groups(tree: &Octree, points: &[(Vec3, Vec3)]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (index, (position, _)) in (0..).zip(points) {
        let takes = |group: &&mut Group| group.count < LANES && group.leaf.contains(*position);
        if let Some(group) = groups.iter_mut().rev().take(OPEN).find(takes) {
            group.points[group.count] = index;
            group.count += 1;
        } else {
            groups.push(Group {
                leaf: tree.leaf(*position),
                count: 1,
                points: [index; LANES],
            });
        }
    }
    groups
}
