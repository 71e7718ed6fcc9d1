//! Orientations of cameras, and how they turn.

use super::*;

#[test]
fn looks_at_its_target_with_y_up_and_then_rolls() {
    let target = DVec3::new(3.0, 1.0, -2.0);
    for roll in [0.0, 0.3, -2.0] {
        let keys = [key(0.0, DVec3::ONE, Orientation::LookAt { target, roll })];
        let path = CameraPath::new(24.0, &keys, &CameraPathTiming::BY_KEYS).expect("a still");
        assert_eq!(path.timeline().frame_count(), 1);
        let camera = path.camera(0);
        let forward = (target - DVec3::ONE).normalize();
        assert!((camera.rotation * DVec3::NEG_Z - forward).length() < 1e-12);
        let side = forward.cross(DVec3::Y).normalize();
        let (right, up) = (camera.rotation * DVec3::X, camera.rotation * DVec3::Y);
        assert!((right.dot(side) - roll.cos()).abs() < 1e-12);
        assert!((up.dot(side) + roll.sin()).abs() < 1e-12);
        assert!((camera.rotation.determinant() - 1.0).abs() < 1e-12);
        assert!((camera.half_height - 1.0).abs() < 1e-12);
    }
}

#[test]
fn rotations_take_the_short_way_at_an_even_pace() {
    let aim = |degrees: f64| {
        let q = DQuat::from_rotation_y(degrees.to_radians());
        Orientation::Rotation(if degrees > 180.0 { -q } else { q })
    };
    for interpolation in [Interpolation::Linear, Interpolation::CatmullRom] {
        let keys = vec![
            key(0.0, DVec3::ZERO, aim(10.0)),
            key(1.0, DVec3::ZERO, aim(350.0)),
        ];
        let path = CameraPath::new(8.0, &with(interpolation, keys), &CameraPathTiming::BY_KEYS)
            .expect("two keys");
        for (frame, camera) in cameras(&path).iter().enumerate() {
            let degrees = 10.0 - 20.0 * frame as f64 / 8.0;
            let expected = DQuat::from_rotation_y(degrees.to_radians()) * DVec3::NEG_Z;
            assert!((camera.rotation * DVec3::NEG_Z - expected).length() < 1e-12);
        }
    }
}

/// Evenly spaced turns about one axis are the turn at a constant rate.
#[test]
fn turning_keys_make_a_steady_turn() {
    let axis = DVec3::new(0.48, 0.6, 0.64);
    let rotation = |time: f64| DQuat::from_axis_angle(axis, 1.1 * time);
    let keys: Vec<Keyframe> = (0..12)
        .map(f64::from)
        .map(|time| key(time, DVec3::ZERO, Orientation::Rotation(rotation(time))))
        .collect();
    let path = CameraPath::new(24.0, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
    for (frame, camera) in cameras(&path).iter().enumerate() {
        let expected = rotation(frame as f64 / 24.0) * DVec3::ONE;
        assert!(
            (camera.rotation * DVec3::ONE - expected).length() < 1e-12,
            "{frame}"
        );
    }
}

#[test]
fn angles_go_around_as_their_numbers_say() {
    let angles = |yaw: f64| Orientation::YawPitchRoll(DVec3::new(yaw, 0.2, 0.0));
    let keys = [
        key(0.0, DVec3::ZERO, angles(0.0)),
        key(4.0, DVec3::ZERO, angles(TAU)),
    ];
    for timing in [CLOSED, CameraPathTiming::BY_KEYS] {
        let path = CameraPath::new(10.0, &keys, &timing).expect("keys");
        assert_eq!(path.timeline().frame_count(), 41 - u32::from(timing.closed));
        for (frame, camera) in cameras(&path).iter().enumerate() {
            let yaw = DQuat::from_rotation_y(TAU * frame as f64 / 40.0);
            let expected = yaw * DQuat::from_rotation_x(0.2) * DVec3::NEG_Z;
            assert!((camera.rotation * DVec3::NEG_Z - expected).length() < 1e-12);
        }
    }
}

#[test]
fn mixed_keys_become_rotations() {
    let keys = [
        key(0.0, DVec3::ZERO, at(DVec3::X)),
        key(1.0, DVec3::ZERO, AHEAD),
    ];
    let path = CameraPath::new(10.0, &keys, &CameraPathTiming::BY_KEYS).expect("two keys");
    let forward = path.camera(5).rotation * DVec3::NEG_Z;
    let expected = DVec3::new(FRAC_PI_4.sin(), 0.0, -FRAC_PI_4.cos());
    assert!((forward - expected).length() < 1e-9, "{forward}");
}
