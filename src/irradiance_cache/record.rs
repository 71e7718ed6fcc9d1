use crate::math::Aabb;
use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};

/// Distances along the normal count so many times: what lies above or below is another surface.
const FLATNESS: f32 = 5.0;

/// What the square of a height adds to the square of the distance, which holds it once.
pub(super) const HEIGHT: f32 = FLATNESS * FLATNESS - 1.0;

/// A disc of a surface that one value stands for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IrradianceRecord {
    /// The middle, relative to the scene's origin.
    pub position: Vec3,
    /// The unit shading normal.
    pub normal: Vec3,
    /// How far it reaches; above 0.
    pub radius: f32,
    /// What it does not reach behind.
    pub walls: OccluderPlanes,
}

/// Planes of surfaces that a place sees within its radius: what lies behind them has light of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OccluderPlanes {
    /// Most places have none, and pay for none.
    planes: Vec<Vec4>,
}

impl OccluderPlanes {
    /// More are not looked at: the nearest are the ones that matter.
    const MOST: usize = 4;

    /// Adds the plane through a point with a unit normal that faces the place, which is `distance` away from
    /// the point, unless there is one like it, or there are enough.
    pub fn add(&mut self, point: Vec3, normal: Vec3, distance: f32) {
        /// As shares of the distance: planes so close are one, and points so far behind are not behind.
        const SAME: f32 = 0.01;
        const SLACK: f32 = 0.001;
        let is_there = self.planes().iter().any(|plane| {
            let is_parallel = plane.truncate().dot(normal) > 1.0 - SAME * SAME;
            is_parallel && before(*plane, point).abs() < SAME * distance
        });
        if !is_there && self.planes.len() < OccluderPlanes::MOST {
            let offset = normal.dot(point) - SLACK * distance;
            self.planes.push(normal.extend(-offset));
        }
    }

    /// The planes, which points before them have a product with, and one, that is not below 0.
    #[inline]
    pub(super) fn planes(&self) -> &[Vec4] {
        &self.planes
    }

    /// Bytes on the heap.
    pub(super) fn memory(&self) -> usize {
        size_of_val(self.planes())
    }

    #[inline]
    fn hide(&self, position: Vec3) -> bool {
        self.planes()
            .iter()
            .any(|plane| before(*plane, position) < 0.0)
    }
}

/// How far a point is before a plane; below 0 behind it.
#[inline]
fn before(plane: Vec4, point: Vec3) -> f32 {
    plane.x * point.x + plane.y * point.y + plane.z * point.z + plane.w
}

impl IrradianceRecord {
    /// The square of the distance of a point of a surface, in radii. It grows, too, by `turn` times one less
    /// the cosine of the angle between the normals. OccluderPlanes are not looked at.
    #[inline]
    fn distance_squared(&self, position: Vec3, normal: Vec3, turn: f32) -> f32 {
        let way = position - self.position;
        let height = way.dot(self.normal);
        let squared = way.length_squared() + HEIGHT * height * height;
        squared / (self.radius * self.radius) + (1.0 - normal.dot(self.normal)) * turn
    }

    /// How much it counts for a point: 0 from a distance of `reach` radii on, smoothly. Small places, which
    /// are where light changes fast, count more.
    #[inline]
    pub fn weight(&self, position: Vec3, normal: Vec3, turn: f32, reach: f32) -> f32 {
        let squared = self.distance_squared(position, normal, turn);
        let rest = reach * reach - squared;
        if rest > 0.0 && !self.walls.hide(position) {
            rest * rest / (self.radius * self.radius)
        } else {
            0.0
        }
    }

    /// What holds all points within the radius.
    pub fn bounds(&self) -> Aabb {
        const ROUNDING: f32 = 1.0001;
        // Of an ellipsoid of revolution that is flat along the normal.
        let flat = 1.0 - HEIGHT / (FLATNESS * FLATNESS) * self.normal * self.normal;
        let extent = flat.map(f32::sqrt) * self.radius * ROUNDING;
        Aabb {
            min: self.position - extent,
            max: self.position + extent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    #[test]
    fn whoever_is_within_the_radius_is_in_the_box() {
        let mut random = Random::new(3);
        let mut inside = 0;
        for _ in 0..20_000 {
            let normal = random.vector(1.0).normalize();
            let place = IrradianceRecord {
                position: random.vector(5.0),
                normal,
                radius: 0.5,
                walls: OccluderPlanes::default(),
            };
            let point = place.position + random.vector(0.5);
            if place.distance_squared(point, normal, 1.0) < 1.0 {
                inside += 1;
                let bounds = place.bounds();
                assert!((point.cmpge(bounds.min) & point.cmple(bounds.max)).all());
                assert!(place.weight(point, normal, 1.0, 1.0) > 0.0);
            }
        }
        assert!(inside > 1000);
    }

    #[test]
    fn distances_by_hand() {
        let place = IrradianceRecord {
            position: Vec3::ONE,
            normal: Vec3::Y,
            radius: 2.0,
            walls: OccluderPlanes::default(),
        };
        let distance =
            |way: Vec3, normal: Vec3| place.distance_squared(Vec3::ONE + way, normal, 0.5);
        assert_eq!(distance(Vec3::X, Vec3::Y), 0.25);
        assert!((distance(0.2 * Vec3::Y, Vec3::Y) - 0.25).abs() < 1e-6);
        assert_eq!(distance(Vec3::ZERO, Vec3::X), 0.5);
        assert_eq!(
            place.weight(Vec3::ONE + 2.0 * Vec3::X, Vec3::Y, 0.5, 1.0),
            0.0
        );
    }

    #[test]
    fn nothing_counts_behind_a_wall() {
        let mut walls = OccluderPlanes::default();
        for _ in 0..9 {
            walls.add(Vec3::new(0.5, 1.0, 0.0), Vec3::NEG_X, 0.5);
        }
        assert_eq!(walls.planes().len(), 1);
        walls.add(Vec3::new(0.0, 0.0, -0.7), Vec3::Z, 0.7);
        let place = IrradianceRecord {
            position: Vec3::ZERO,
            normal: Vec3::Y,
            radius: 2.0,
            walls,
        };
        let weight = |x: f32, z: f32| place.weight(Vec3::new(x, 0.0, z), Vec3::Y, 1.0, 1.0);
        assert!(weight(0.49, 0.0) > 0.0 && weight(-1.0, -0.69) > 0.0);
        // On the wall.
        assert!(weight(0.5, 1.0) > 0.0);
        assert_eq!(weight(0.51, 0.0), 0.0);
        assert_eq!(weight(-1.0, -0.71), 0.0);
    }
}
