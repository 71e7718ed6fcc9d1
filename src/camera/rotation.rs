//! Exponential and logarithmic maps of rotations, and the rotations of cameras. Uses libm, which gives the same bits on
//! every machine.

use glam::{DMat3, DQuat, DVec3};

/// The exponential map: the unit quaternion of a rotation about `vector` by its length, in radians.
pub(super) fn exp(vector: DVec3) -> DQuat {
    let angle = vector.length();
    // sin(x) / x rounds to 1 there.
    let scale = if angle < 1e-9 {
        0.5
    } else {
        libm::sin(0.5 * angle) / angle
    };
    let DVec3 { x, y, z } = vector * scale;
    DQuat::from_xyzw(x, y, z, libm::cos(0.5 * angle))
}

/// The logarithmic map, the inverse of [`exp`]: the rotation vector, at most pi long. The quaternion may have either
/// sign.
pub(super) fn log(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    let axis = rotation.xyz();
    let sine = axis.length();
    if sine < 1e-9 {
        return 2.0 * axis;
    }
    axis * (2.0 * libm::atan2(sine, rotation.w) / sine)
}

/// The rotation of a camera that looks along `-backward`, a unit vector, with `up` made perpendicular to it.
pub(super) fn basis_from_backward_up(backward: DVec3, up: DVec3) -> DMat3 {
    let right = up.cross(backward).normalize();
    DMat3::from_cols(right, backward.cross(right), backward)
}

/// The rotation by yaw, pitch and roll, in radians.
pub(super) fn yaw_pitch_roll(angles: DVec3) -> DMat3 {
    let turn = |axis: DVec3, angle: f64| exp(axis * angle);
    let DVec3 { x, y, z } = angles;
    let rotation = turn(DVec3::Y, x) * turn(DVec3::X, y) * turn(DVec3::Z, z);
    DMat3::from_quat(rotation)
}

/// The rotation about the backward axis, in radians.
pub(super) fn roll(angle: f64) -> DMat3 {
    DMat3::from_quat(exp(DVec3::Z * angle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    #[test]
    fn log_undoes_exp() {
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let length = 3.1 * f64::from(random.unit());
            let vector = random.point().normalize() * length;
            for rotation in [exp(vector), -exp(vector)] {
                assert!((log(rotation) - vector).length() < 1e-13, "{vector}");
            }
        }
        for length in [0.0, 1e-300, 1e-15, 1e-9, 1e-8, 3.1] {
            let vector = DVec3::new(0.6, 0.0, 0.8) * length;
            assert!((log(exp(vector)) - vector).length() <= 1e-15 + 1e-15 * length);
            assert!((exp(vector).length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn yaw_is_to_the_left_pitch_up_and_roll_to_the_left() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let close = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-15, "{a} {b}");
        close(
            yaw_pitch_roll(DVec3::X * quarter) * DVec3::NEG_Z,
            DVec3::NEG_X,
        );
        close(yaw_pitch_roll(DVec3::Y * quarter) * DVec3::NEG_Z, DVec3::Y);
        close(yaw_pitch_roll(DVec3::Z * quarter) * DVec3::Y, DVec3::NEG_X);
        close(roll(quarter) * DVec3::Y, DVec3::NEG_X);
    }
}
