//! Rotations by Euler angles, and orthonormal bases around a normal.

use glam::{DMat3, DVec3, Vec3};

/// The rotation about the fixed axes X, then Y, then Z by `angles` in radians, counter-clockwise
/// seen from the axis' tip.
pub fn rotation_xyz(angles: DVec3) -> DMat3 {
    let turn = |axis: usize| {
        let (sin, cos) = libm::sincos(angles[axis]);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut matrix = DMat3::IDENTITY;
        (matrix.col_mut(a)[a], matrix.col_mut(a)[b]) = (cos, sin);
        (matrix.col_mut(b)[a], matrix.col_mut(b)[b]) = (-sin, cos);
        matrix
    };
    turn(2) * turn(1) * turn(0)
}

/// Rotates a vector from the local frame whose z axis is the unit vector `normal` to world space.
///
/// The frame is orthonormal and right-handed; Duff et al. 2017, "Building an Orthonormal Basis,
/// Revisited" (JCGT 6(1)), which has no branch and no direction where it loses accuracy.
#[inline]
pub fn to_world(normal: Vec3, local: Vec3) -> Vec3 {
    let sign = 1.0_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3::new(
        1.0 + sign * normal.x * normal.x * a,
        sign * b,
        -sign * normal.x,
    );
    let bitangent = Vec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    tangent * local.x + bitangent * local.y + normal * local.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_is_orthonormal_and_right_handed_for_every_direction() {
        let directions = [
            Vec3::X,
            Vec3::NEG_X,
            Vec3::Y,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
            Vec3::new(1e-6, 0.0, -1.0).normalize(),
            Vec3::new(0.3, -0.5, 0.7).normalize(),
            Vec3::new(-0.9, 0.1, -0.2).normalize(),
        ];
        for n in directions {
            let x = to_world(n, Vec3::X);
            let y = to_world(n, Vec3::Y);
            let z = to_world(n, Vec3::Z);
            assert!((z - n).length() < 1e-6);
            assert!((x.length() - 1.0).abs() < 1e-6 && (y.length() - 1.0).abs() < 1e-6);
            assert!(x.dot(y).abs() < 1e-6 && x.dot(z).abs() < 1e-6 && y.dot(z).abs() < 1e-6);
            assert!((x.cross(y) - z).length() < 1e-6, "{n}");
        }
    }
}
