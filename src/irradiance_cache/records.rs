//! A set of irradiance records with the octree that finds those around a point.

use super::octree::Octree;
use super::record::IrradianceRecord;
use crate::math::Aabb;
use glam::Vec3;
use std::ops::Index;

/// Records, numbered from 0 with growing radii, and an octree over their bounds.
#[derive(Debug)]
pub struct IrradianceRecords {
    list: Vec<IrradianceRecord>,
    tree: Octree,
    /// Weight of the angle between normals: see [`IrradianceRecord::weight`].
    angle_weight: f32,
}

impl IrradianceRecords {
    /// The records of a scene with these bounds, with growing radii and those of one radius in the order of the tree; and
    /// the number that each had in the list. A record is valid up to an angle of `max_angle` radians, above 0, between the
    /// normals.
    pub fn new(
        bounds: Aabb,
        max_angle: f32,
        list: Vec<IrradianceRecord>,
    ) -> (IrradianceRecords, Vec<usize>) {
        let mut order: Vec<usize> = (0..list.len()).collect();
        let tree = Octree::of(bounds, list.iter().map(IrradianceRecord::bounds));
        let leaf = |index: usize| tree.leaf(list[index].position).node;
        order.sort_by_cached_key(|&index| (list[index].radius.to_bits(), leaf(index), index));
        let list: Vec<IrradianceRecord> = order.iter().map(|&index| list[index]).collect();
        let records = IrradianceRecords {
            tree: Octree::of(bounds, list.iter().map(IrradianceRecord::bounds)),
            list,
            angle_weight: IrradianceRecord::angle_weight(max_angle),
        };
        (records, order)
    }

    /// The number of records.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are no records.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The records.
    pub fn iter(&self) -> impl Iterator<Item = &IrradianceRecord> {
        self.list.iter()
    }

    pub(super) fn tree(&self) -> &Octree {
        &self.tree
    }

    pub(super) fn angle_weight(&self) -> f32 {
        self.angle_weight
    }

    /// The smallest radius of records that cover a point; none if there are none.
    pub fn smallest_around(&self, position: Vec3, normal: Vec3) -> Option<f32> {
        let candidates = self.tree.boxes(self.tree.leaf(position).node).iter();
        // Radii grow.
        candidates
            .map(|&index| &self.list[index as usize])
            .find(|record| record.weight(position, normal, self.angle_weight) > 0.0)
            .map(|record| record.radius)
    }

    /// The smallest radius of records around a point, whether they cover it or not; none if there are none.
    pub fn smallest_near(&self, position: Vec3) -> Option<f32> {
        let near = self.tree.boxes(self.tree.leaf(position).node).first();
        near.map(|&index| self.list[index as usize].radius)
    }

    /// Memory in bytes.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.list) + self.tree.memory()
    }
}

impl Index<usize> for IrradianceRecords {
    type Output = IrradianceRecord;

    fn index(&self, index: usize) -> &IrradianceRecord {
        &self.list[index]
    }
}
