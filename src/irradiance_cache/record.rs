//! One record of the irradiance cache: where it is valid, and its interpolation weight.

use crate::math::Aabb;
use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};

/// Distances along the normal are scaled by this: what lies above or below is another surface. So the validity
/// region is an oblate spheroid, and parallel surfaces closer than 1 / `FLATNESS` of the radius share records.
const FLATNESS: f32 = 5.0;

/// Extra weight of the squared height in the squared distance, which contains it once.
pub(super) const HEIGHT_WEIGHT: f32 = FLATNESS * FLATNESS - 1.0;

/// A cache record: where irradiance was gathered, and where that value may be used. The value is stored apart.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct IrradianceRecord {
    /// Position in metres, relative to the scene's origin.
    pub position: Vec3,
    /// The unit shading normal.
    pub normal: Vec3,
    /// Validity radius in metres; above 0.
    pub radius: f32,
    /// Planes that bound its validity.
    pub occluders: OccluderPlanes,
}

/// Planes of surfaces close to a record. The record is not valid behind them, so light does not leak through walls.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct OccluderPlanes {
    /// Normal and offset. Empty, without an allocation, for most records.
    planes: Vec<Vec4>,
}

impl OccluderPlanes {
    /// Further planes are ignored: they are added nearest first.
    const MAX_PLANES: usize = 4;

    /// Adds the plane through a point at `distance` metres from the record, whose unit normal faces the record,
    /// unless an equal one is present or the limit is reached.
    pub fn add(&mut self, point: Vec3, normal: Vec3, distance: f32) {
        /// Relative to the distance: tolerance of equal planes, and by how much the plane is moved back.
        const EQUAL: f32 = 0.01;
        const MARGIN: f32 = 0.001;
        let is_present = self.planes().iter().any(|plane| {
            let is_parallel = plane.truncate().dot(normal) > 1.0 - EQUAL * EQUAL;
            is_parallel && signed_distance(*plane, point).abs() < EQUAL * distance
        });
        if !is_present && self.planes.len() < OccluderPlanes::MAX_PLANES {
            let offset = normal.dot(point) - MARGIN * distance;
            self.planes.push(normal.extend(-offset));
        }
    }

    /// The planes (n, d): valid points p have n · p + d >= 0.
    #[inline]
    pub(super) fn planes(&self) -> &[Vec4] {
        &self.planes
    }

    /// Heap memory in bytes.
    pub(super) fn memory(&self) -> usize {
        size_of_val(self.planes())
    }

    #[inline]
    fn occlude(&self, position: Vec3) -> bool {
        self.planes()
            .iter()
            .any(|plane| signed_distance(*plane, position) < 0.0)
    }
}

/// Signed distance of a point from a plane; negative behind it.
#[inline]
fn signed_distance(plane: Vec4, point: Vec3) -> f32 {
    plane.x * point.x + plane.y * point.y + plane.z * point.z + plane.w
}

impl IrradianceRecord {
    /// Squared distance of a surface point in units of the radius, plus `normal_weight` (1 - cos) for the angle
    /// between the normals. Ignores occluders.
    #[inline]
    fn distance_squared(&self, position: Vec3, normal: Vec3, normal_weight: f32) -> f32 {
        let offset = position - self.position;
        let height = offset.dot(self.normal);
        let squared = offset.length_squared() + HEIGHT_WEIGHT * height * height;
        squared / (self.radius * self.radius) + (1.0 - normal.dot(self.normal)) * normal_weight
    }

    /// Interpolation weight at a surface point: falls smoothly to 0 at `support_radius`, in units of the record's
    /// radius, and is 0 behind occluders. Smaller records, which stand where irradiance changes fast, weigh more.
    #[inline]
    pub fn weight(
        &self,
        position: Vec3,
        normal: Vec3,
        normal_weight: f32,
        support_radius: f32,
    ) -> f32 {
        let squared = self.distance_squared(position, normal, normal_weight);
        let rest = support_radius * support_radius - squared;
        if rest > 0.0 && !self.occluders.occlude(position) {
            rest * rest / (self.radius * self.radius)
        } else {
            0.0
        }
    }

    /// Bounds of all points within the radius.
    pub fn bounds(&self) -> Aabb {
        const ROUNDING: f32 = 1.0001;
        // Of a spheroid that is flat along the normal.
        let flattened = 1.0 - HEIGHT_WEIGHT / (FLATNESS * FLATNESS) * self.normal * self.normal;
        let extent = flattened.map(f32::sqrt) * self.radius * ROUNDING;
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
    fn points_within_the_radius_are_within_the_bounds() {
        let mut random = Random::new(3);
        let mut inside = 0;
        for _ in 0..20_000 {
            let normal = random.vector(1.0).normalize();
            let record = IrradianceRecord {
                position: random.vector(5.0),
                normal,
                radius: 0.5,
                occluders: OccluderPlanes::default(),
            };
            let point = record.position + random.vector(0.5);
            if record.distance_squared(point, normal, 1.0) < 1.0 {
                inside += 1;
                let bounds = record.bounds();
                assert!((point.cmpge(bounds.min) & point.cmple(bounds.max)).all());
                assert!(record.weight(point, normal, 1.0, 1.0) > 0.0);
            }
        }
        assert!(inside > 1000);
    }

    #[test]
    fn distances_by_hand() {
        let record = IrradianceRecord {
            position: Vec3::ONE,
            normal: Vec3::Y,
            radius: 2.0,
            occluders: OccluderPlanes::default(),
        };
        let distance =
            |offset: Vec3, normal: Vec3| record.distance_squared(Vec3::ONE + offset, normal, 0.5);
        assert_eq!(distance(Vec3::X, Vec3::Y), 0.25);
        assert!((distance(0.2 * Vec3::Y, Vec3::Y) - 0.25).abs() < 1e-6);
        assert_eq!(distance(Vec3::ZERO, Vec3::X), 0.5);
        assert_eq!(
            record.weight(Vec3::ONE + 2.0 * Vec3::X, Vec3::Y, 0.5, 1.0),
            0.0
        );
    }

    #[test]
    fn weights_are_zero_behind_occluders() {
        let mut occluders = OccluderPlanes::default();
        for _ in 0..9 {
            occluders.add(Vec3::new(0.5, 1.0, 0.0), Vec3::NEG_X, 0.5);
        }
        assert_eq!(occluders.planes().len(), 1);
        occluders.add(Vec3::new(0.0, 0.0, -0.7), Vec3::Z, 0.7);
        let record = IrradianceRecord {
            position: Vec3::ZERO,
            normal: Vec3::Y,
            radius: 2.0,
            occluders,
        };
        let weight = |x: f32, z: f32| record.weight(Vec3::new(x, 0.0, z), Vec3::Y, 1.0, 1.0);
        assert!(weight(0.49, 0.0) > 0.0 && weight(-1.0, -0.69) > 0.0);
        // On the occluder.
        assert!(weight(0.5, 1.0) > 0.0);
        assert_eq!(weight(0.51, 0.0), 0.0);
        assert_eq!(weight(-1.0, -0.71), 0.0);
    }
}
