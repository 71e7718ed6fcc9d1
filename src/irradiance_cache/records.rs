//! A set of irradiance records with the octree that finds those around a point.

use super::octree::Octree;
use super::record::IrradianceRecord;
use crate::math::Aabb;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::ops::Index;

/// Records, numbered from 0, and an octree over their bounds.
#[derive(Debug, Serialize, Deserialize)]
#[serde(from = "StoredRecords")]
pub struct IrradianceRecords {
    list: Vec<IrradianceRecord>,
    #[serde(skip_serializing)]
    tree: Octree,
    /// Bounds of all points of the scene.
    bounds: Aabb,
    /// Weight of the angle between normals: see [`IrradianceRecord::weight`].
    normal_weight: f32,
}

impl IrradianceRecords {
    /// No records yet, of a scene with these bounds. A record is valid up to an angle of `max_angle` radians, above
    /// 0, between the normals.
    pub fn new(bounds: Aabb, max_angle: f32) -> IrradianceRecords {
        IrradianceRecords::of(bounds, 1.0 / (1.0 - libm::cosf(max_angle)), [])
    }

    fn of(
        bounds: Aabb,
        normal_weight: f32,
        list: impl IntoIterator<Item = IrradianceRecord>,
    ) -> IrradianceRecords {
        let mut records = IrradianceRecords {
            list: Vec::new(),
            tree: Octree::new(bounds),
            bounds,
            normal_weight,
        };
        list.into_iter().for_each(|record| records.push(record));
        records
    }

    /// Adds a record.
    pub fn push(&mut self, record: IrradianceRecord) {
        self.tree.insert(record.bounds());
        self.list.push(record);
    }

    /// Limits the radius of a record to `radius`.
    pub fn shrink(&mut self, index: usize, radius: f32) {
        let record = &mut self.list[index];
        record.radius = record.radius.min(radius);
    }

    /// The same records with tight bounds, sorted by leaf for locality; and the old number of each new record.
    pub fn compacted(&self) -> (IrradianceRecords, Vec<usize>) {
        let tight =
            IrradianceRecords::of(self.bounds, self.normal_weight, self.list.iter().cloned());
        let mut order: Vec<usize> = (0..self.list.len()).collect();
        order.sort_by_cached_key(|&index| tight.tree.leaf(self[index].position).node);
        let list = order.iter().map(|&index| self[index].clone());
        (
            IrradianceRecords::of(self.bounds, self.normal_weight, list),
            order,
        )
    }

    /// The number of records.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are no records.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(super) fn tree(&self) -> &Octree {
        &self.tree
    }

    pub(super) fn normal_weight(&self) -> f32 {
        self.normal_weight
    }

    /// Calls `visitor` with the number and the weight of each record that covers a point. With a `support_radius`
    /// above 1, in units of a record's radius, only records that overlap the point's leaf are visited.
    #[inline]
    pub fn visit(
        &self,
        position: Vec3,
        normal: Vec3,
        support_radius: f32,
        mut visitor: impl FnMut(usize, f32),
    ) {
        for &index in self.tree.around(position) {
            let record = &self.list[index as usize];
            let weight = record.weight(position, normal, self.normal_weight, support_radius);
            if weight > 0.0 {
                visitor(index as usize, weight);
            }
        }
    }

    /// Weighted mean of a value per record over the records of [`IrradianceRecords::visit`]; none if there are none.
    #[inline]
    pub(super) fn mean(
        &self,
        position: Vec3,
        normal: Vec3,
        support_radius: f32,
        value: impl Fn(usize) -> Vec3,
    ) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        self.visit(position, normal, support_radius, |index, weight| {
            sum += weight * value(index);
            weights += weight;
        });
        (weights > 0.0).then(|| sum / weights)
    }

    /// Whether a point lies within `support_radius`, in units of a record's radius, of any record.
    pub fn covers(&self, position: Vec3, normal: Vec3, support_radius: f32) -> bool {
        self.tree.around(position).iter().any(|&index| {
            let record = &self.list[index as usize];
            record.weight(position, normal, self.normal_weight, support_radius) > 0.0
        })
    }

    /// Memory in bytes.
    pub fn memory(&self) -> usize {
        let occluders = self.list.iter().map(|record| record.occluders.memory());
        size_of_val(&*self.list) + occluders.sum::<usize>() + self.tree.memory()
    }
}

impl Index<usize> for IrradianceRecords {
    type Output = IrradianceRecord;

    fn index(&self, index: usize) -> &IrradianceRecord {
        &self.list[index]
    }
}

/// What is stored of [`IrradianceRecords`]; the octree is rebuilt.
#[derive(Deserialize)]
struct StoredRecords {
    list: Vec<IrradianceRecord>,
    bounds: Aabb,
    normal_weight: f32,
}

impl From<StoredRecords> for IrradianceRecords {
    fn from(
        StoredRecords {
            list,
            bounds,
            normal_weight,
        }: StoredRecords,
    ) -> IrradianceRecords {
        IrradianceRecords::of(bounds, normal_weight, list)
    }
}
