use super::{BoxTree, Place};
use crate::math::Aabb;
use glam::Vec3;
use std::ops::Index;

/// Places, and which of them a point lies in.
#[derive(Debug)]
pub struct Places {
    list: Vec<Place>,
    tree: BoxTree,
    /// What an angle counts: see [`Place::distance_squared`].
    turn: f32,
}

impl Places {
    /// None yet, for points within `bounds`. A normal that is turned by `angle` radians, above 0, is as far
    /// as the radius.
    pub fn new(bounds: Aabb, angle: f32) -> Places {
        Places {
            list: Vec::new(),
            tree: BoxTree::new(bounds),
            turn: 1.0 / (1.0 - libm::cosf(angle)),
        }
    }

    /// Adds one; they are numbered from 0 on.
    pub fn push(&mut self, place: Place) {
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
    pub fn settled(&self, bounds: Aabb) -> (Places, Vec<u32>) {
        let mut order: Vec<u32> = (0..self.list.len() as u32).collect();
        order.sort_by_cached_key(|&number| self.tree.leaf(self[number as usize].position).node);
        let mut settled = Places {
            list: Vec::new(),
            tree: BoxTree::new(bounds),
            turn: self.turn,
        };
        for &number in &order {
            settled.push(self[number as usize].clone());
        }
        (settled, order)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(super) fn tree(&self) -> &BoxTree {
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

    /// Whether a point lies within `share` of the radius of a place.
    pub fn cover(&self, position: Vec3, normal: Vec3, share: f32) -> bool {
        self.tree.around(position).iter().any(|&number| {
            let place = &self.list[number as usize];
            place.weight(position, normal, self.turn, share) > 0.0
        })
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.list) + self.tree.memory()
    }
}

impl Index<usize> for Places {
    type Output = Place;

    fn index(&self, number: usize) -> &Place {
        &self.list[number]
    }
}
