//! One record of the irradiance cache: where it is valid, and its interpolation weight.

use crate::math::Aabb;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Distances along the normal are scaled by this: what lies above or below is another surface. So the validity
/// region is an oblate spheroid.
const FLATNESS: f32 = 5.0;

/// Extra weight of the squared height in the squared distance, which contains it once.
pub(super) const HEIGHT_WEIGHT: f32 = FLATNESS * FLATNESS - 1.0;

/// Heights of points, in radii, up to which they surely lie on the surface of the record.
pub(super) const SURE_HEIGHT: f32 = 0.02;

/// A record is not valid where one of less than its radius over this is: that stands closer to other surfaces, from which
/// the larger one knows nothing.
pub(super) const MAX_RADIUS_RATIO: f32 = 6.0;

/// A cache record: where irradiance was gathered, and where that value may be used. The value is stored apart.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct IrradianceRecord {
    /// Position in metres, relative to the scene's origin.
    pub position: Vec3,
    /// The unit shading normal.
    pub normal: Vec3,
    /// Validity radius in metres; above 0.
    pub radius: f32,
    /// A point above the record: what sees it sees the record.
    pub eye: Vec3,
    /// The distance in metres up to which no other surface stands between the record and points of its own, as far as that
    /// is known: the radius, if none is near.
    pub free_radius: f32,
}

impl IrradianceRecord {
    /// The weight of the angle between normals: records are valid up to an angle of `max_angle` radians, above 0.
    pub fn angle_weight(max_angle: f32) -> f32 {
        1.0 / (1.0 - libm::cosf(max_angle))
    }

    /// Whether no other surface is so close that points within the radius may lie behind it.
    pub fn is_free(&self) -> bool {
        self.free_radius >= self.radius
    }

    /// Squared distance of a surface point in units of the radius, plus `angle_weight` (1 - cos) for the angle
    /// between the normals.
    #[inline]
    pub fn distance_squared(&self, position: Vec3, normal: Vec3, angle_weight: f32) -> f32 {
        let offset = position - self.position;
        let height = offset.dot(self.normal);
        let squared = offset.length_squared() + HEIGHT_WEIGHT * height * height;
        squared / (self.radius * self.radius) + (1.0 - normal.dot(self.normal)) * angle_weight
    }

    /// Interpolation weight at a surface point: falls smoothly to 0 at the radius. Of overlapping records the smaller ones,
    /// which stand where irradiance changes fast, decide. Whether the point sees the record is another question: see
    /// [`IrradianceRecord::is_doubtful`].
    #[inline]
    pub fn weight(&self, position: Vec3, normal: Vec3, angle_weight: f32) -> f32 {
        let rest = (1.0 - self.distance_squared(position, normal, angle_weight)).max(0.0);
        let scale = 1.0 / (self.radius * self.radius);
        rest * rest * scale * scale
    }

    /// Whether a point within the radius may be on another surface, or behind one: then it has to see the eye.
    #[inline]
    pub fn is_doubtful(&self, position: Vec3, normal: Vec3) -> bool {
        let offset = position - self.position;
        let height = offset.dot(self.normal).abs();
        let cos = normal.dot(self.normal);
        // Curved surfaces fall below the tangent plane by half of that.
        let turned = (1.0 - cos * cos).max(0.0) * offset.length_squared();
        let sure = SURE_HEIGHT * self.radius;
        let is_free = offset.length_squared() <= self.free_radius * self.free_radius;
        !is_free || height * height > sure * sure + turned
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

    fn record(position: Vec3, normal: Vec3, radius: f32) -> IrradianceRecord {
        IrradianceRecord {
            position,
            normal,
            radius,
            eye: position,
            free_radius: f32::INFINITY,
        }
    }

    #[test]
    fn points_within_the_radius_are_within_the_bounds() {
        let mut random = Random::new(3);
        let mut inside = 0;
        for _ in 0..20_000 {
            let normal = random.vector(1.0).normalize();
            let record = record(random.vector(5.0), normal, 0.5);
            let point = record.position + random.vector(0.5);
            if record.distance_squared(point, normal, 1.0) < 1.0 {
                inside += 1;
                let bounds = record.bounds();
                assert!((point.cmpge(bounds.min) & point.cmple(bounds.max)).all());
                assert!(record.weight(point, normal, 1.0) > 0.0);
            }
        }
        assert!(inside > 1000);
    }

    #[test]
    fn distances_by_hand() {
        let record = record(Vec3::ONE, Vec3::Y, 2.0);
        let distance =
            |offset: Vec3, normal: Vec3| record.distance_squared(Vec3::ONE + offset, normal, 0.5);
        assert_eq!(distance(Vec3::X, Vec3::Y), 0.25);
        assert!((distance(0.2 * Vec3::Y, Vec3::Y) - 0.25).abs() < 1e-6);
        assert_eq!(distance(Vec3::ZERO, Vec3::X), 0.5);
        assert_eq!(record.weight(Vec3::ONE + 2.0 * Vec3::X, Vec3::Y, 0.5), 0.0);
    }

    /// Points of a sphere are on the surface of a record on it; those of a parallel plate are in doubt.
    #[test]
    fn doubt_by_hand() {
        let record = record(Vec3::ZERO, Vec3::Y, 0.3);
        for angle in [0.0_f32, 0.1, 0.2, 0.3] {
            let normal = Vec3::new(angle.sin(), angle.cos(), 0.0);
            assert!(!record.is_doubtful(normal - Vec3::Y, normal));
            assert!(!record.is_doubtful(Vec3::Y - normal, normal));
        }
        assert!(!record.is_doubtful(Vec3::new(0.1, 0.005, 0.0), Vec3::Y));
        assert!(record.is_doubtful(Vec3::new(0.1, -0.01, 0.0), Vec3::Y));
        let obstructed = IrradianceRecord {
            free_radius: 0.1,
            ..record
        };
        assert!(!obstructed.is_free());
        assert!(!obstructed.is_doubtful(0.09 * Vec3::X, Vec3::Y));
        assert!(obstructed.is_doubtful(0.11 * Vec3::X, Vec3::Y));
    }
}
