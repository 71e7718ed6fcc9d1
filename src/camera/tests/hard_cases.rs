//! What is hard to have a camera for, and what has none.

use super::*;

#[test]
fn hard_cases_have_cameras() {
    // Keys at once, far away.
    let mut keys = uneven();
    keys[3].time = keys[2].time + 1e-6;
    for pace in [Pace::BY_KEYS, CONSTANT] {
        CameraPath::new(24.0, &keys, &pace).expect("keys 1e-6 s apart");
    }
    // All at one place.
    let still: Vec<Keyframe> = (0..4)
        .map(|i| key(f64::from(i), DVec3::ONE, AHEAD))
        .collect();
    for pace in [Pace::BY_KEYS, CONSTANT, CLOSED] {
        let path = CameraPath::new(24.0, &still, &pace).expect("a camera that stands");
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
    let path = CameraPath::new(1.0, &many, &Pace::BY_KEYS).expect("10,000 keys");
    for (camera, key) in cameras(&path).iter().zip(&many) {
        assert_eq!(camera.position, key.position);
    }
    let path = CameraPath::new(1.0, &many, &CONSTANT).expect("10,000 keys");
    assert_eq!(path.timeline().frame_count(), 10_000);
}

#[test]
fn refuses_what_has_no_camera() {
    let looks = |time, position, target| Keyframe {
        segment: Segment::of(Shape::Linear),
        ..key(time, position, at(target))
    };
    let refusal = |keys: &[Keyframe]| CameraPath::new(10.0, keys, &Pace::BY_KEYS).err();
    assert_eq!(refusal(&[]), Some(PathError::NoKeys));
    let still = looks(1.0, DVec3::ZERO, DVec3::X);
    let expected = PathError::TimesDoNotRise { key: 1, time: 1.0 };
    assert_eq!(refusal(&[still, still]), Some(expected));
    // Passes through its target half way.
    let through = [
        looks(0.0, DVec3::X, DVec3::ZERO),
        looks(1.0, DVec3::NEG_X, DVec3::ZERO),
    ];
    let (frame, time) = (5, 0.5);
    assert_eq!(
        refusal(&through),
        Some(PathError::LooksAtItself { frame, time })
    );
    let (frame, time) = (0, 0.0);
    let above = looks(0.0, DVec3::Y, DVec3::ZERO);
    assert_eq!(
        refusal(&[above]),
        Some(PathError::LooksVertically { frame, time })
    );
    // Passes above its target, on a frame and between two.
    let over = |from: f64, to: f64| {
        let key = |time, x| looks(time, DVec3::new(x, 3.0, 0.0), DVec3::ZERO);
        refusal(&[key(0.0, from), key(1.0, to)])
    };
    let (frame, time) = (5, 0.5);
    assert_eq!(
        over(-1.0, 1.0),
        Some(PathError::LooksVertically { frame, time })
    );
    assert_eq!(
        over(-1.05, 1.0),
        Some(PathError::Flips {
            frame: 6,
            time: 0.6
        })
    );
    // Either way around is as short.
    let half = [AHEAD, Orientation::Rotation(DQuat::from_rotation_y(PI))];
    let half = half.map(|aim| key(if aim == AHEAD { 0.0 } else { 1.0 }, DVec3::ZERO, aim));
    assert_eq!(refusal(&half), Some(PathError::HalfTurn { key: 1 }));
    // What cannot be had together.
    let pace = |ease_in, ease_out, speed| Pace {
        ease_in,
        ease_out,
        speed,
        ..Pace::BY_KEYS
    };
    let keys = [
        looks(0.0, DVec3::X, DVec3::ZERO),
        looks(1.0, DVec3::Z, DVec3::ZERO),
    ];
    let error = CameraPath::new(10.0, &keys, &pace(0.6, 0.6, Speed::ByKeys)).err();
    assert!(matches!(error, Some(PathError::EaseTooLong { .. })));
    let mut keys = keys;
    keys[0].segment.ease_in = true;
    let error = CameraPath::new(10.0, &keys, &CONSTANT).err();
    assert_eq!(error, Some(PathError::EaseAtConstantSpeed { key: 0 }));
}
