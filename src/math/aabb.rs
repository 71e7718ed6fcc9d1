//! Axis-aligned bounding boxes.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// An axis-aligned box: every point p with `min <= p <= max`, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box of no point: the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box that holds `points`; [`Aabb::EMPTY`] for none.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points
            .into_iter()
            .fold(Aabb::EMPTY, |b, p| b.union(Aabb { min: p, max: p }))
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The middle of the box; NaN for the empty box.
    pub fn center(self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The lengths of the edges; negative for the empty box.
    pub fn extent(self) -> Vec3 {
        self.max - self.min
    }
}
