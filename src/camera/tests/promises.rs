//! Properties of every path, tested on random ones.

use super::*;

/// Every key is passed at its time, bit-equal, whatever the interpolation, and every frame has a camera.
#[test]
fn random_paths_pass_through_their_keys() {
    let mut random = Random::new(3);
    for _ in 0..300 {
        let keys = random_keys(&mut random);
        let path = CameraPath::new(17.0, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
        for (i, key) in keys.iter().enumerate() {
            let camera = path.camera_at(key.time, 0).expect("a camera");
            assert_eq!(camera.position, key.position);
            assert_eq!(path.keys()[i], key.time);
            let half_height = (0.5 * key.field_of_view).tan();
            assert!((camera.half_height / half_height - 1.0).abs() < 1e-14);
            let Orientation::Rotation(rotation) = key.orientation else {
                panic!("all are rotations");
            };
            let turned = rotation * DVec3::new(1.0, 2.0, 3.0);
            assert!((camera.rotation * DVec3::new(1.0, 2.0, 3.0) - turned).length() < 1e-14);
        }
        let cameras = cameras(&path);
        let last = cameras.len() - 1;
        assert_eq!(cameras[0].position, keys[0].position);
        if last > 0 {
            assert_eq!(cameras[last].position, keys[keys.len() - 1].position);
        }
        for camera in cameras {
            assert!(camera.position.is_finite() && camera.half_height > 0.0);
            let turned = camera.rotation * camera.rotation.transpose();
            assert!(turned.abs_diff_eq(Default::default(), 1e-12));
        }
    }
}

/// Frames depend on later keys only from the key before the change on, and where the curve is smooth from one key
/// earlier; all others are bit-equal.
#[test]
fn frames_do_not_know_what_comes_later() {
    for (interpolation, first_changed) in
        [(Interpolation::Linear, 5), (Interpolation::CatmullRom, 4)]
    {
        let keys = with(interpolation, uneven());
        let last = keys[5];
        let longer = Keyframe {
            time: last.time + 1.0,
            position: last.position + DVec3::new(0.0, 1.0, 0.5),
            ..last
        };
        let path = |keys: &[Keyframe]| {
            CameraPath::new(24.0, keys, &CameraPathTiming::BY_KEYS).expect("keys")
        };
        let short = cameras(&path(&keys));
        let longer = cameras(&path(&[&keys[..], &[longer]].concat()));
        assert_eq!(longer.len(), short.len() + 24);
        let same = (keys[first_changed].time * 24.0).round() as usize;
        assert_eq!(short[..=same], longer[..=same]);
        let is_changed = short[same + 1..] != longer[same + 1..short.len()];
        assert_eq!(is_changed, interpolation == Interpolation::CatmullRom);
    }
}

/// Steps along the chord from key to key are never negative.
#[test]
fn no_frame_runs_backward() {
    let mut random = Random::new(5);
    for round in 0..300 {
        let keys = match round {
            0 => uneven(),
            _ => with(Interpolation::CatmullRom, random_keys(&mut random)),
        };
        for timing in [CameraPathTiming::BY_KEYS, CONSTANT] {
            let mut keys = keys.clone();
            for key in &mut keys {
                key.segment = Segment::of(key.segment.interpolation);
            }
            let path = CameraPath::new(24.0, &keys, &timing).expect("keys");
            for (i, pair) in keys.windows(2).enumerate() {
                let [from, to] = [path.keys()[i], path.keys()[i + 1]];
                let chord = pair[1].position - pair[0].position;
                let mut before = 0.0;
                for part in 0..=200 {
                    let time = from + (to - from) * f64::from(part) / 200.0;
                    let camera = path.camera_at(time, 0).expect("a camera");
                    let done = (camera.position - pair[0].position).dot(chord);
                    let slack = 1e-12 * chord.length_squared();
                    assert!(done >= before - slack, "{round}: {before} {done}");
                    before = done;
                }
            }
        }
    }
}

/// On smooth paths, before and after each key.
#[test]
fn velocities_do_not_jump_at_keys() {
    let mut random = Random::new(7);
    let look_at = |keys: Vec<Keyframe>| -> Vec<Keyframe> {
        let keys = keys.into_iter().enumerate().map(|(i, key)| Keyframe {
            orientation: Orientation::LookAt {
                target: DVec3::new(5.0 + i as f64, 1.0, -9.0 + 0.3 * (i * i) as f64),
                roll: 0.2 * (i as f64).sin(),
            },
            ..key
        });
        keys.collect()
    };
    let angles = |keys: Vec<Keyframe>| -> Vec<Keyframe> {
        let keys = keys.into_iter().enumerate().map(|(i, key)| Keyframe {
            orientation: Orientation::YawPitchRoll(DVec3::new(i as f64, 0.3, 0.1 * i as f64)),
            field_of_view: 1.0 + 0.2 * (i as f64).sin(),
            ..key
        });
        keys.collect()
    };
    let mut paths = vec![uneven(), look_at(uneven()), angles(uneven())];
    while paths.len() < 60 {
        let keys = random_keys(&mut random);
        let keys = keys.into_iter().map(|key| Keyframe {
            segment: Segment::of(Interpolation::CatmullRom),
            ..key
        });
        paths.push(keys.collect());
    }
    for (number, keys) in paths.iter().enumerate() {
        for timing in [CameraPathTiming::BY_KEYS, CONSTANT] {
            let path = CameraPath::new(24.0, keys, &timing).expect("keys");
            let camera = |time: f64| path.camera_at(time, 0).expect("a camera");
            // Derivatives at a time, towards one side of it, to the second order.
            let rate = |time: f64, h: f64| {
                let [a, b, c] = [0.0, h, 2.0 * h].map(|h| camera(time + h));
                let turned = |to: &Camera| a.rotation * a.turn_to(to);
                let zoomed = |to: &Camera| (to.half_height / a.half_height).ln();
                let moved = |to: &Camera| to.position - a.position;
                (
                    (4.0 * moved(&b) - moved(&c)) / (2.0 * h),
                    (4.0 * turned(&b) - turned(&c)) / (2.0 * h),
                    (4.0 * zoomed(&b) - zoomed(&c)) / (2.0 * h),
                )
            };
            let duration = path.timeline().end - path.timeline().start;
            let samples: Vec<_> = (0..200)
                .map(|i| path.timeline().start + duration * (f64::from(i) + 0.5) / 200.0)
                .map(|time| rate(time, 1e-6))
                .collect();
            let mean =
                |of: fn(&(DVec3, DVec3, f64)) -> f64| samples.iter().map(of).sum::<f64>() / 200.0;
            let speed = mean(|rate| rate.0.length());
            let angular = mean(|rate| rate.1.length());
            let zoom = mean(|rate| rate.2.abs());
            for (key, around) in path.keys().windows(3).enumerate() {
                let time = around[1];
                let h = 1e-8 * (time - around[0]).min(around[2] - time);
                let (before, after) = (rate(time, -h), rate(time, h));
                let jump = (after.0 - before.0).length();
                // At constant speed it goes into a rest all at once, and turns back in no time.
                let to = keys[key + 1].position - keys[key].position;
                let on = keys[key + 2].position - keys[key + 1].position;
                let stands = to == DVec3::ZERO || on == DVec3::ZERO;
                let may_jump = stands || to.angle_between(on) > 0.99 * PI;
                let may_jump = may_jump && timing.speed == Speed::Constant;
                assert!(
                    jump < 0.01 * speed || may_jump,
                    "{number} {time}: {jump} of {speed}"
                );
                let jump = (after.1 - before.1).length();
                assert!(
                    jump <= 0.01 * angular,
                    "{number} {time}: {jump} of {angular}"
                );
                let jump = (after.2 - before.2).abs();
                assert!(
                    jump <= 0.01 * zoom + 1e-9,
                    "{number} {time}: {jump} of {zoom}"
                );
            }
        }
    }
}

/// A smooth segment takes over direction and speed of a neighbour with given tangents, up to three times its own mean
/// speed, the limit of a monotone cubic.
#[test]
fn smooth_segments_join_given_ones() {
    let mut keys = uneven();
    keys[1].segment.interpolation = Interpolation::Linear;
    keys[3].segment.interpolation =
        Interpolation::Hermite(DVec3::new(-1.0, 0.2, 3.0), DVec3::new(-4.0, 1.0, 0.5));
    // A loop that comes back to where it starts.
    let mut looping = uneven();
    looping[3].position = looping[2].position;
    looping[2].segment.interpolation =
        Interpolation::Hermite(DVec3::new(2.0, 0.0, 4.0), DVec3::new(-4.0, 1.0, 5.0));
    for (keys, joints) in [(keys, &[1, 2, 3, 4][..]), (looping, &[2, 3])] {
        let path = CameraPath::new(24.0, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
        let camera = |time: f64| path.camera_at(time, 0).expect("a camera").position;
        let h = 1e-6;
        for &key in joints {
            let time = keys[key].time;
            let before = (camera(time) - camera(time - h)) / h;
            let after = (camera(time + h) - camera(time)) / h;
            let cosine = before.normalize().dot(after.normalize());
            assert!(cosine > 1.0 - 1e-9, "{key}: {before} {after}");
            let is_smooth_after = keys[key].segment.interpolation == Interpolation::CatmullRom;
            let (smooth, given, start) = match is_smooth_after {
                true => (after, before, key),
                false => (before, after, key - 1),
            };
            let [from, to] = [keys[start], keys[start + 1]];
            let mean = from.position.distance(to.position) / (to.time - from.time);
            let expected = given.length().min(3.0 * mean);
            assert!((smooth.length() / expected - 1.0).abs() < 1e-4, "{key}");
        }
    }
}
