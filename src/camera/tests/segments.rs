//! Cuts, rests, easing and loops.

use super::*;

#[test]
fn held_keys_are_cut_from() {
    let mut keys = uneven();
    keys[2].segment.interpolation = Interpolation::Hold;
    for timing in [CameraPathTiming::BY_KEYS, CONSTANT] {
        let path = CameraPath::new(24.0, &keys, &timing).expect("keys");
        let positions = positions(&path);
        let cuts: Vec<u32> = (0..300).filter(|&frame| path.is_cut(frame)).collect();
        assert_eq!(cuts.len(), 1);
        let cut = cuts[0] as usize;
        let held = positions.iter().filter(|&&p| p == keys[2].position).count();
        assert!((35..=37).contains(&held), "{held} frames in 1.5 s");
        assert_eq!(positions[cut], keys[2].position);
        assert!(positions[cut + 1].distance(keys[3].position) < 0.2);
        // Nothing else jumps.
        let mut steps = steps(&path);
        steps.remove(cut);
        assert!(steps.iter().all(|&step| step < 0.3), "{steps:?}");
    }
}

#[test]
fn eased_segments_start_from_rest_and_come_to_rest() {
    let mut keys = with(Interpolation::Linear, uneven());
    for ease in [[true, false], [false, true], [true, true]] {
        [keys[2].segment.ease_in, keys[2].segment.ease_out] = ease;
        let path = CameraPath::new(24.0, &keys, &CameraPathTiming::BY_KEYS).expect("keys");
        let camera = |time: f64| path.camera_at(time, 0).expect("a camera").position;
        let h = 1e-6;
        let speeds = [
            camera(keys[2].time + h).distance(keys[2].position) / h,
            camera(keys[3].time - h).distance(keys[3].position) / h,
        ];
        for (speed, eased) in speeds.into_iter().zip(ease) {
            assert_eq!(speed < 1e-3, eased, "{speed}");
        }
    }
}

#[test]
fn whole_paths_start_from_rest_and_come_to_rest() {
    for speed in [Speed::ByKeys, Speed::Constant] {
        let timing = CameraPathTiming {
            speed,
            ease_in: 2.0,
            ease_out: 3.0,
            ..CameraPathTiming::BY_KEYS
        };
        let keys = uneven();
        let path = CameraPath::new(24.0, &keys, &timing).expect("keys");
        let steps = steps(&path);
        assert!(steps[0] < 0.2 * steps[40] && steps[298] < 0.2 * steps[200]);
        for (&time, key) in path.keys().iter().zip(&keys) {
            let camera = path.camera_at(time, 0).expect("a camera");
            assert!((camera.position - key.position).length() < 1e-12);
        }
        if speed == Speed::Constant {
            // 2 s, its speed, 3 s.
            assert!(ratio(&steps[49..226]) < 1.01);
            let rise = steps[23] / steps[100];
            assert!((rise - 23.5 / 48.0).abs() < 0.01, "{rise}");
        }
    }
}

#[test]
fn a_closed_path_has_no_seam() {
    let mut keys = uneven();
    keys.push(Keyframe {
        time: 16.0,
        ..keys[0]
    });
    for timing in [
        CLOSED,
        CameraPathTiming {
            closed: true,
            ..CONSTANT
        },
    ] {
        let path = CameraPath::new(1000.0, &keys, &timing).expect("keys");
        assert!(path.is_closed());
        assert_eq!(path.timeline().frame_count(), 16000);
        let frame = |frame: i32| path.camera(frame.rem_euclid(16000) as u32);
        let (before, seam, after) = (frame(-1), frame(0), frame(1));
        let steps = [
            seam.position - before.position,
            after.position - seam.position,
        ];
        assert!((steps[1] - steps[0]).length() < 0.05 * steps[0].length());
        let turns = [before.turn_to(&seam), seam.turn_to(&after)].map(DVec3::length);
        assert!((turns[1] - turns[0]).abs() < 0.05 * turns[0]);
    }
}

#[test]
fn standing_keys_last_as_long_as_they_say() {
    let mut keys = uneven();
    keys[3].position = keys[2].position;
    for timing in [CameraPathTiming::BY_KEYS, CONSTANT] {
        let path = CameraPath::new(24.0, &keys, &timing).expect("keys");
        let stands = positions(&path);
        let stands = stands.iter().filter(|&&p| p == keys[2].position).count();
        assert!((35..=37).contains(&stands), "{stands} frames in 1.5 s");
        assert!((path.keys()[3] - path.keys()[2] - 1.5).abs() < 1e-12);
    }
}
