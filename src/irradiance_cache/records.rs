use super::{IrradianceRecord, Octree};
use crate::math::Aabb;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::ops::Index;

/// IrradianceRecords, and which of them a point lies in.
#[derive(Debug, Serialize, Deserialize)]
#[serde(from = "Listed")]
pub struct IrradianceRecords {
    list: Vec<IrradianceRecord>,
    #[serde(skip_serializing)]
    tree: Octree,
    /// Of all points.
    bounds: Aabb,
    /// What an angle counts: see [`IrradianceRecord::weight`].
    turn: f32,
}

impl IrradianceRecords {
    /// None yet, for points within `bounds`. A normal that is turned by `angle` radians, above 0, is as far
    /// as the radius.
    pub fn new(bounds: Aabb, angle: f32) -> IrradianceRecords {
        IrradianceRecords::of(bounds, 1.0 / (1.0 - libm::cosf(angle)), [])
    }

    fn of(
        bounds: Aabb,
        turn: f32,
        list: impl IntoIterator<Item = IrradianceRecord>,
    ) -> IrradianceRecords {
        let mut places = IrradianceRecords {
            list: Vec::new(),
            tree: Octree::new(bounds),
            bounds,
            turn,
        };
        list.into_iter().for_each(|place| places.push(place));
        places
    }

    /// Adds one; they are numbered from 0 on.
    pub fn push(&mut self, place: IrradianceRecord) {
        self.tree.insert(place.bounds());
        self.list.push(place);
    }

    /// Makes a place smaller, if it is larger than `radius`.
    pub fn shrink(&mut self, number: usize, radius: f32) {
        let place = &mut self.list[number];
        place.radius = place.radius.min(radius);
    }

    /// The same places with boxes of what they have become, those that lie close to each other side by side;
    /// and the former number of each.
    pub fn settled(&self) -> (IrradianceRecords, Vec<usize>) {
        let of_now = IrradianceRecords::of(self.bounds, self.turn, self.list.iter().cloned());
        let mut order: Vec<usize> = (0..self.list.len()).collect();
        order.sort_by_cached_key(|&number| of_now.tree.leaf(self[number].position).node);
        let list = order.iter().map(|&number| self[number].clone());
        (IrradianceRecords::of(self.bounds, self.turn, list), order)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(super) fn tree(&self) -> &Octree {
        &self.tree
    }

    pub(super) fn turn(&self) -> f32 {
        self.turn
    }

    /// Calls `visitor` with the number and the weight of each place that a point lies in, or, for a `reach`
    /// beyond 1, of those of the tree's leaf around it that it lies within so many radii of.
    #[inline]
    pub fn visit(
        &self,
        position: Vec3,
        normal: Vec3,
        reach: f32,
        mut visitor: impl FnMut(usize, f32),
    ) {
        for &number in self.tree.around(position) {
            let place = &self.list[number as usize];
            let weight = place.weight(position, normal, self.turn, reach);
            if weight > 0.0 {
                visitor(number as usize, weight);
            }
        }
    }

    /// The mean of a value that each place has, over the places and with the weights of [`IrradianceRecords::visit`]; none
    /// if there are none.
    #[inline]
    pub(super) fn mean(
        &self,
        position: Vec3,
        normal: Vec3,
        reach: f32,
        value: impl Fn(usize) -> Vec3,
    ) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        self.visit(position, normal, reach, |number, weight| {
            sum += weight * value(number);
            weights += weight;
        });
        (weights > 0.0).then(|| sum / weights)
    }

    /// Whether a point lies within `share` of the radius of a place.
    pub fn cover(&self, position: Vec3, normal: Vec3, share: f32) -> bool {
        self.tree.around(position).iter().any(|&number| {
            let place = &self.list[number as usize];
            place.weight(position, normal, self.turn, share) > 0.0
        })
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
        let walls = self.list.iter().map(|place| place.walls.memory());
        size_of_val(&*self.list) + walls.sum::<usize>() + self.tree.memory()
    }
}

impl Index<usize> for IrradianceRecords {
    type Output = IrradianceRecord;

    fn index(&self, number: usize) -> &IrradianceRecord {
        &self.list[number]
    }
}

/// What is kept of [`IrradianceRecords`]: the tree follows.
#[derive(Deserialize)]
struct Listed {
    list: Vec<IrradianceRecord>,
    bounds: Aabb,
    turn: f32,
}

impl From<Listed> for IrradianceRecords {
    fn from(Listed { list, bounds, turn }: Listed) -> IrradianceRecords {
        IrradianceRecords::of(bounds, turn, list)
    }
}
