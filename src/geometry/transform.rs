//! Placement of objects: scale, rotation and translation.

use crate::math::rotation_xyz;
use glam::{DMat3, DVec3};

/// Object space to world space: scale, then rotation about X, then Y, then Z, then translation.
#[derive(Clone, Copy, Debug)]
pub struct Transform {
    linear: DMat3,
    rotation: DMat3,
    translation: DVec3,
}

impl Transform {
    /// `scale` has no zero factor, `rotation` is in radians, all are finite. A negative factor
    /// mirrors.
    pub fn new(scale: DVec3, rotation: DVec3, translation: DVec3) -> Transform {
        let rotation = rotation_xyz(rotation);
        Transform {
            linear: rotation * DMat3::from_diagonal(scale),
            rotation,
            translation,
        }
    }

    /// A point of object space in world space.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.translation
    }

    /// A normal of object space in world space, of unit length; zero if it has no direction.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        (self.linear.inverse().transpose() * normal).normalize_or_zero()
    }

    /// A triangle in the order that keeps its front where the object has it: a mirror reverses it.
    pub fn wound<T: Copy>(&self, [a, b, c]: [T; 3]) -> [T; 3] {
        if self.linear.determinant() < 0.0 {
            [a, c, b]
        } else {
            [a, b, c]
        }
    }

    /// The rotation alone, object to world.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn scales_then_rotates_about_x_then_y_then_z_then_translates() {
        let quarter = DVec3::splat(FRAC_PI_2);
        let t = Transform::new(
            DVec3::new(2.0, 3.0, 4.0),
            quarter,
            DVec3::new(10.0, 0.0, 0.0),
        );
        // Y scaled: (0,3,0); about X: (0,0,3); about Y: (3,0,0); about Z: (0,3,0).
        let p = t.point(DVec3::Y);
        assert!((p - DVec3::new(10.0, 3.0, 0.0)).length() < 1e-12, "{p}");
        // X scaled: (2,0,0); about X: same; about Y: (0,0,-2); about Z: same.
        let p = t.point(DVec3::X);
        assert!((p - DVec3::new(10.0, 0.0, -2.0)).length() < 1e-12, "{p}");
    }

    #[test]
    fn normals_stay_perpendicular_to_scaled_surfaces() {
        let t = Transform::new(
            DVec3::new(1.0, 5.0, -0.1),
            DVec3::new(0.3, 1.0, -2.0),
            DVec3::ONE,
        );
        let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-2.0, 0.5, 1.0));
        let n = t.normal(a.cross(b));
        for edge in [a, b] {
            let image = t.point(edge) - t.point(DVec3::ZERO);
            assert!(n.dot(image.normalize()).abs() < 1e-12);
        }
    }
}
