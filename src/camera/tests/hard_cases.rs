//! Extreme keys, and keys that are refused.

use super::*;

#[test]
fn hard_cases_have_cameras() {
    // Keys at once, far away.
    let mut keys = uneven();
    keys[3].time = keys[2].time + 1e-6;
    for timing in [CameraPathTiming::BY_KEYS, CONSTANT] {
        CameraPath::new(24.0, &keys, &timing).expect("keys 1e-6 s apart");
    }
    // All at one place.
    let still: Vec<Keyframe> = (0..4)
        .map(|i| key(f64::from(i), DVec3::ONE, AHEAD))
        .collect();
    for timing in [CameraPathTiming::BY_KEYS, CONSTANT, CLOSED] {
        let path = CameraPath::new(24.0, &still, &timing).expect("a camera that stands");
        assert!(positions(&path).iter().all(|&p| p == DVec3::ONE));
    }
    // Small steps far from the origin.
    let far: Vec<Keyframe> = (0..6)
        .map(|i| {
            key(
                f64::from(i * i),
                DVec3::splat(1e6) + DVec3::X * 1e-3 * f64::from(i),
                AHEAD,
            )
        })
        .collect();
    let path = CameraPath::new(2.0, &far, &CONSTANT).expect("keys far away");
    assert!(
        ratio(&steps(&path)) < 1.0 + 1e-5,
        "{}",
        ratio(&steps(&path))
    );
    // Many.
    let mut random = Random::new(11);
    let many: Vec<Keyframe> = (0..10_000)
        .map(|i| {
            let orientation = Orientation::Rotation(rotation(&mut random));
            key(f64::from(i), 10.0 * random.point(), orientation)
        })
        .collect();
    let path = CameraPath::new(1.0, &many, &CameraPathTiming::BY_KEYS).expect("10,000 keys");
    for (camera, key) in cameras(&path).iter().zip(&many) {
        assert_eq!(camera.position, key.position);
    }
    let path = CameraPath::new(1.0, &many, &CONSTANT).expect("10,000 keys");
    assert_eq!(path.timeline().frame_count(), 10_000);
}

#[test]
fn refuses_what_has_no_camera() {
    let looks = |time, position, target| Keyframe {
        segment: Segment::of(Interpolation::Linear),
        ..key(time, position, at(target))
    };
    let refusal = |keys: &[Keyframe]| CameraPath::new(10.0, keys, &CameraPathTiming::BY_KEYS).err();
    // Passes through its target half way.
    let through = [
        looks(0.0, DVec3::X, DVec3::ZERO),
        looks(1.0, DVec3::NEG_X, DVec3::ZERO),
    ];
    let (frame, time) = (5, 0.5);
    assert_eq!(
        refusal(&through),
        Some(CameraPathError::LooksAtItself { frame, time })
    );
    // Passes above its target, on a frame and between two.
    let over = |from: f64, to: f64| {
        let key = |time, x| looks(time, DVec3::new(x, 3.0, 0.0), DVec3::ZERO);
        refusal(&[key(0.0, from), key(1.0, to)])
    };
    let (frame, time) = (5, 0.5);
    assert_eq!(
        over(-1.0, 1.0),
        Some(CameraPathError::LooksVertically { frame, time })
    );
    assert_eq!(
        over(-1.05, 1.0),
        Some(CameraPathError::Flips {
            frame: 6,
            time: 0.6
        })
    );
}

/// Decimals of keys and frames are rounded otherwise.
#[test]
fn frames_on_keys_show_them() {
    for (fps, count) in [
        (25.0, 30),
        (30.0, 124),
        (23.976, 98),
        (49.0, 100),
        (60.0, 999),
    ] {
        for start in [0.0, 0.2, 7.1] {
            let keys = (0..count).map(|i| {
                let x = DVec3::X * f64::from(i);
                key(start + f64::from(i) / fps, x, AHEAD)
            });
            let keys = with(Interpolation::Hold, keys.collect());
            let path = CameraPath::new(fps, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
            for (camera, key) in cameras(&path).iter().zip(&keys) {
                assert_eq!(camera.position, key.position, "{fps}");
            }
            assert!((0..count as u32 - 1).all(|frame| path.is_cut(frame)));
        }
    }
}

#[test]
fn every_frame_has_numbers_or_is_refused() {
    // A segment so short that at constant speed it takes less time than numbers tell apart.
    let angles = |yaw| Orientation::YawPitchRoll(DVec3::new(yaw, 0.0, 0.0));
    let keys = [
        key(1e6, DVec3::ZERO, angles(0.0)),
        key(1e6 + 5.0, DVec3::X * 500.0, angles(0.2)),
        key(1e6 + 6.0, DVec3::X * 500.000_000_001_5, angles(0.2)),
        key(1e6 + 10.0, DVec3::X * 1000.0, angles(0.7)),
    ];
    let path = CameraPath::new(1.0, &keys, &CONSTANT).expect("keys");
    for camera in cameras(&path) {
        assert!(camera.rotation.is_finite() && camera.position.is_finite());
    }
    let narrow = Keyframe {
        field_of_view: 0.0,
        ..keys[0]
    };
    for keys in [&[narrow][..], &[narrow, keys[1]]] {
        let error = CameraPath::new(1.0, keys, &CameraPathTiming::BY_KEYS).err();
        assert!(
            matches!(error, Some(CameraPathError::NoCamera { frame: 0, .. })),
            "{error:?}"
        );
    }
}

#[test]
fn targets_are_not_met_between_frames_nor_at_the_seam() {
    let walk = |from: f64, to: f64, beside: f64| {
        let key = |time, x| Keyframe {
            segment: Segment::of(Interpolation::Linear),
            ..key(time, DVec3::new(x, 0.0, beside), at(DVec3::ZERO))
        };
        CameraPath::new(
            10.0,
            &[key(0.0, from), key(1.0, to)],
            &CameraPathTiming::BY_KEYS,
        )
        .err()
    };
    let (frame, time) = (6, 0.6);
    assert_eq!(
        walk(-1.05, 1.0, 0.0),
        Some(CameraPathError::LooksAtItself { frame, time })
    );
    assert_eq!(walk(-1.05, 1.0, 0.3), None);
    // A fast roll is no flip.
    let rolled = |time, roll| {
        let target = DVec3::NEG_Z;
        key(time, DVec3::ZERO, Orientation::LookAt { target, roll })
    };
    let keys = [rolled(0.0, 0.0), rolled(1.0, PI)];
    CameraPath::new(1.0, &keys, &CameraPathTiming::BY_KEYS).expect("a camera that is tipped over");
    // Passes over its target where it closes.
    let over = |time, x: f64, z: f64| Keyframe {
        segment: Segment::of(Interpolation::Linear),
        ..key(time, DVec3::new(x, 3.0, z), at(DVec3::ZERO))
    };
    let keys = [
        over(0.0, 0.05, 0.0),
        over(1.0, 2.0, 0.0),
        over(2.0, 0.0, 2.0),
        over(3.0, -2.0, 0.0),
        over(3.9, -0.05, 0.0),
        over(4.0, 0.05, 0.0),
    ];
    let error = CameraPath::new(10.0, &keys, &CLOSED).err();
    assert_eq!(
        error,
        Some(CameraPathError::Flips {
            frame: 0,
            time: 0.0
        })
    );
}
