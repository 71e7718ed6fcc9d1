//! What camera paths promise, on paths with known answers and on random ones.

use super::error::PathError;
use super::keyframe::{Keyframe, Orientation, Pace, Segment, Shape, Speed};
use super::{Camera, CameraPath};
use crate::sampling::Random;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

const AHEAD: Orientation = Orientation::Rotation(DQuat::IDENTITY);

const CONSTANT: Pace = Pace {
    speed: Speed::Constant,
    ..Pace::BY_KEYS
};

const CLOSED: Pace = Pace {
    closed: true,
    ..Pace::BY_KEYS
};

fn key(time: f64, position: DVec3, orientation: Orientation) -> Keyframe {
    Keyframe {
        time,
        position,
        orientation,
        field_of_view: FRAC_PI_2,
        segment: Segment::of(Shape::CatmullRom),
    }
}

fn at(target: DVec3) -> Orientation {
    Orientation::LookAt { target, roll: 0.0 }
}

fn with(shape: Shape, mut keys: Vec<Keyframe>) -> Vec<Keyframe> {
    for key in &mut keys {
        key.segment.shape = shape;
    }
    keys
}

fn cameras(path: &CameraPath) -> Vec<Camera> {
    let frames = 0..path.timeline().frame_count();
    frames.map(|frame| path.camera(frame)).collect()
}

fn positions(path: &CameraPath) -> Vec<DVec3> {
    cameras(path).iter().map(|camera| camera.position).collect()
}

fn steps(path: &CameraPath) -> Vec<f64> {
    let positions = positions(path);
    positions.windows(2).map(|p| p[0].distance(p[1])).collect()
}

/// The largest over the smallest.
fn ratio(values: &[f64]) -> f64 {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    values.iter().copied().fold(0.0, f64::max) / least
}

/// The angle between two cameras, in radians.
fn turn(a: &Camera, b: &Camera) -> f64 {
    let turned = DQuat::from_mat3(&(a.rotation.transpose() * b.rotation));
    2.0 * turned.xyz().length().min(1.0).asin()
}

fn rotation(random: &mut Random) -> DQuat {
    let axis = random.point().normalize();
    DQuat::from_axis_angle(axis, PI * f64::from(random.unit()))
}

/// Six keys of 300 frames whose distances and times differ by more than ten times.
fn uneven() -> Vec<Keyframe> {
    let points = [
        (0.0, 1.0, 0.0),
        (0.4, 1.0, -0.1),
        (2.5, 1.4, 1.2),
        (3.3, 1.5, 3.4),
        (0.5, 2.0, 7.5),
        (-1.0, 2.0, 7.8),
    ];
    let times: [f64; 6] = [0.0, 1.0, 3.0, 4.5, 8.0, 299.0 / 24.0];
    let yaws = [0.0, 0.3, 1.2, 0.7, 2.0, 2.1];
    let keys = points.into_iter().zip(times).zip(yaws);
    let keys = keys.map(|(((x, y, z), time), yaw)| {
        let rotation = DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(0.4 * time.sin());
        key(time, DVec3::new(x, y, z), Orientation::Rotation(rotation))
    });
    keys.collect()
}

fn random_keys(random: &mut Random) -> Vec<Keyframe> {
    let count = 1 + (8.0 * random.unit()) as usize;
    let mut time = 100.0 * f64::from(random.unit()) - 50.0;
    let mut keys: Vec<Keyframe> = Vec::new();
    for _ in 0..count {
        time += 0.01 + 3.0 * f64::from(random.unit()).powi(3);
        let scale = 10_f64.powf(4.0 * f64::from(random.unit()) - 2.0);
        let mut position = scale * random.point();
        if let (Some(last), true) = (keys.last(), random.unit() < 0.2) {
            position = last.position;
        }
        let shape = match (5.0 * random.unit()) as u32 {
            0 => Shape::Hold,
            1 => Shape::Linear,
            2 => Shape::Cubic(5.0 * random.point(), 5.0 * random.point()),
            _ => Shape::CatmullRom,
        };
        keys.push(Keyframe {
            field_of_view: 0.05 + 2.5 * f64::from(random.unit()),
            segment: Segment {
                shape,
                ease_in: random.unit() < 0.2,
                ease_out: random.unit() < 0.2,
            },
            ..key(time, position, Orientation::Rotation(rotation(random)))
        });
    }
    keys
}

#[test]
fn looks_at_its_target_with_y_up_and_then_rolls() {
    let target = DVec3::new(3.0, 1.0, -2.0);
    for roll in [0.0, 0.3, -2.0] {
        let keys = [key(0.0, DVec3::ONE, Orientation::LookAt { target, roll })];
        let path = CameraPath::new(24.0, &keys, &Pace::BY_KEYS).expect("a still");
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

/// Every key at its time, to the last bit of what it was given, whatever the shapes; nothing beyond is defined, and
/// every frame is a camera.
#[test]
fn random_paths_pass_through_their_keys() {
    let mut random = Random::new(3);
    for _ in 0..300 {
        let keys = random_keys(&mut random);
        let path = CameraPath::new(17.0, &keys, &Pace::BY_KEYS).expect("keys");
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

/// The camera of a frame depends on its number: a path asked backwards, or longer by a key whose segment is given,
/// has the same.
#[test]
fn frames_know_their_cameras_alone() {
    let keys = with(Shape::Linear, uneven());
    let path = CameraPath::new(24.0, &keys, &Pace::BY_KEYS).expect("keys");
    let forward = cameras(&path);
    for frame in (0..300).rev() {
        assert_eq!(path.camera(frame), forward[frame as usize]);
    }
}

#[test]
fn constant_speed_on_uneven_paths() {
    // Equal times, from 0.4 to 5 m apart.
    let apart = [
        (0.0, 1.0, 0.0),
        (0.4, 1.0, 0.0),
        (5.2, 1.2, 1.4),
        (5.6, 1.3, 1.8),
        (5.0, 1.6, 5.0),
        (4.0, 1.6, 5.4),
    ];
    let apart = (0..).zip(apart).map(|(i, (x, y, z))| {
        let time = 299.0 / 24.0 * f64::from(i) / 5.0;
        key(time, DVec3::new(x, y, z), AHEAD)
    });
    for keys in [uneven(), apart.collect()] {
        let by_keys = CameraPath::new(24.0, &keys, &Pace::BY_KEYS).expect("keys");
        assert_eq!(by_keys.timeline().frame_count(), 300);
        assert!(ratio(&steps(&by_keys)) > 5.0);
        let path = CameraPath::new(24.0, &keys, &CONSTANT).expect("keys");
        assert!(ratio(&steps(&path)) < 1.01, "{}", ratio(&steps(&path)));
        // Chords are shorter than the way along them: of steps so short that they hardly are, it is the same.
        let path = CameraPath::new(2400.0, &keys, &CONSTANT).expect("keys");
        let ratio = ratio(&steps(&path));
        assert!(ratio < 1.0001, "{ratio}");
    }
}

/// The step of each frame along the line from key to key.
#[test]
fn no_frame_runs_backward() {
    let mut random = Random::new(5);
    for round in 0..300 {
        let keys = match round {
            0 => uneven(),
            _ => with(Shape::CatmullRom, random_keys(&mut random)),
        };
        for pace in [Pace::BY_KEYS, CONSTANT] {
            let mut keys = keys.clone();
            for key in &mut keys {
                key.segment = Segment::of(key.segment.shape);
            }
            let path = CameraPath::new(24.0, &keys, &pace).expect("keys");
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

/// Of a smooth path, before and after each key.
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
            segment: Segment::of(Shape::CatmullRom),
            ..key
        });
        paths.push(keys.collect());
    }
    for (number, keys) in paths.iter().enumerate() {
        for pace in [Pace::BY_KEYS, CONSTANT] {
            let path = CameraPath::new(24.0, keys, &pace).expect("keys");
            let camera = |time: f64| path.camera_at(time, 0).expect("a camera");
            // Derivatives at a time, towards one side of it, to the second order.
            let rate = |time: f64, h: f64| {
                let [a, b, c] = [0.0, h, 2.0 * h].map(|h| camera(time + h));
                let turned = |to: &Camera| {
                    let turned = to.rotation * a.rotation.transpose();
                    super::rotation::log(DQuat::from_mat3(&turned))
                };
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
            let keys = path.keys();
            for around in keys.windows(3) {
                let time = around[1];
                let h = 1e-4 * (time - around[0]).min(around[2] - time);
                let (before, after) = (rate(time, -h), rate(time, h));
                let jump = (after.0 - before.0).length();
                // The constant speed turns a corner where the way does.
                let is_corner = pace.speed == Speed::Constant && number >= 3;
                assert!(
                    jump < 0.01 * speed || is_corner,
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

/// Beside a straight segment or one with given tangents a smooth one goes on as that does.
#[test]
fn smooth_segments_join_given_ones() {
    let mut keys = uneven();
    keys[1].segment.shape = Shape::Linear;
    keys[3].segment.shape = Shape::Cubic(DVec3::new(-1.0, 0.2, 3.0), DVec3::new(-4.0, 1.0, 0.5));
    let path = CameraPath::new(24.0, &keys, &Pace::BY_KEYS).expect("keys");
    let camera = |time: f64| path.camera_at(time, 0).expect("a camera").position;
    let h = 1e-6;
    for key in [1, 2, 3, 4] {
        let time = keys[key].time;
        let before = (camera(time) - camera(time - h)) / h;
        let after = (camera(time + h) - camera(time)) / h;
        let cosine = before.normalize().dot(after.normalize());
        assert!(cosine > 1.0 - 1e-9, "{key}: {before} {after}");
    }
}

#[test]
fn circles_and_helices_of_many_keys() {
    // The distance to the true curve, as a share of its radius.
    for (count, error) in [(8_usize, 0.03), (16, 0.008), (64, 5e-4)] {
        let point = |turn: f64| DVec3::new((TAU * turn).cos(), 0.0, (TAU * turn).sin());
        let keys: Vec<Keyframe> = (0..=count)
            .map(|i| {
                let part = (i % count) as f64 / count as f64;
                key(i as f64 * 8.0 / count as f64, point(part), at(DVec3::NEG_Y))
            })
            .collect();
        for pace in [
            CLOSED,
            Pace {
                closed: true,
                ..CONSTANT
            },
        ] {
            let path = CameraPath::new(30.0, &keys, &pace).expect("a circle");
            assert_eq!(path.timeline().frame_count(), 240);
            for (frame, camera) in cameras(&path).iter().enumerate() {
                let expected = point(frame as f64 / 240.0);
                assert!(
                    (camera.position - expected).length() < error,
                    "{count} {frame}"
                );
            }
            if pace.speed == Speed::Constant {
                // Also across the seam.
                let mut steps = steps(&path);
                steps.push(path.camera(239).position.distance(path.camera(0).position));
                assert!(
                    ratio(&steps) < 1.0 + 0.1 * error,
                    "{count}: {}",
                    ratio(&steps)
                );
            }
        }
        let rising = |turn: f64| point(turn) + DVec3::Y * turn;
        let keys: Vec<Keyframe> = (0..=3 * count)
            .map(|i| i as f64 / count as f64)
            .map(|turn| key(turn, rising(turn), AHEAD))
            .collect();
        let path = CameraPath::new(100.0, &keys, &CONSTANT).expect("a helix");
        for (frame, camera) in cameras(&path).iter().enumerate() {
            let expected = rising(frame as f64 / 100.0);
            // The first and the last segments have no neighbours to be bent by.
            let error = if (50..250).contains(&frame) {
                error
            } else {
                8.0 * error
            };
            assert!(
                (camera.position - expected).length() < error,
                "{count} {frame}"
            );
        }
    }
}

#[test]
fn lines_are_walked_at_constant_speed() {
    let places = [0.0, 0.1, 4.0, 4.0 + 1e-6, 9.0];
    let keys = places.map(|x| key(x * x + x, DVec3::new(2.0 * x, -x, x), AHEAD));
    for shape in [Shape::CatmullRom, Shape::Linear] {
        let path = CameraPath::new(10.0, &with(shape, keys.to_vec()), &CONSTANT).expect("keys");
        let count = f64::from(path.timeline().frame_count() - 1);
        for (frame, position) in positions(&path).iter().enumerate() {
            let x = 9.0 * frame as f64 / count;
            let error = (*position - DVec3::new(2.0 * x, -x, x)).length();
            assert!(error < 2e-11, "{frame}: {error}");
        }
    }
}

#[test]
fn a_zoom_magnifies_evenly() {
    let zoomed = |time: f64, degrees: f64| Keyframe {
        field_of_view: degrees.to_radians(),
        ..key(time, DVec3::ZERO, AHEAD)
    };
    for shape in [Shape::Linear, Shape::CatmullRom] {
        let keys = with(shape, vec![zoomed(0.0, 60.0), zoomed(10.0, 6.0)]);
        let path = CameraPath::new(10.0, &keys, &Pace::BY_KEYS).expect("keys");
        let sizes: Vec<f64> = cameras(&path).iter().map(|c| c.half_height).collect();
        let first = sizes[0] / sizes[1];
        let expected = (30_f64.to_radians().tan() / 3_f64.to_radians().tan()).powf(0.01);
        assert!((first - expected).abs() < 1e-12);
        assert!(
            sizes
                .windows(2)
                .all(|s| (s[0] / s[1] - first).abs() < 1e-12)
        );
    }
}

#[test]
fn rotations_take_the_short_way_at_an_even_pace() {
    let aim = |degrees: f64| {
        let q = DQuat::from_rotation_y(degrees.to_radians());
        Orientation::Rotation(if degrees > 180.0 { -q } else { q })
    };
    for shape in [Shape::Linear, Shape::CatmullRom] {
        let keys = vec![
            key(0.0, DVec3::ZERO, aim(10.0)),
            key(1.0, DVec3::ZERO, aim(350.0)),
        ];
        let path = CameraPath::new(8.0, &with(shape, keys), &Pace::BY_KEYS).expect("two keys");
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
    let path = CameraPath::new(24.0, &keys, &Pace::BY_KEYS).expect("keys");
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
    for pace in [CLOSED, Pace::BY_KEYS] {
        let path = CameraPath::new(10.0, &keys, &pace).expect("keys");
        assert_eq!(path.timeline().frame_count(), 41 - u32::from(pace.closed));
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
    let path = CameraPath::new(10.0, &keys, &Pace::BY_KEYS).expect("two keys");
    let forward = path.camera(5).rotation * DVec3::NEG_Z;
    let expected = DVec3::new(FRAC_PI_4.sin(), 0.0, -FRAC_PI_4.cos());
    assert!((forward - expected).length() < 1e-9, "{forward}");
}

#[test]
fn held_keys_are_cut_from() {
    let mut keys = uneven();
    keys[2].segment.shape = Shape::Hold;
    for pace in [Pace::BY_KEYS, CONSTANT] {
        let path = CameraPath::new(24.0, &keys, &pace).expect("keys");
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
    let mut keys = with(Shape::Linear, uneven());
    for ease in [[true, false], [false, true], [true, true]] {
        [keys[2].segment.ease_in, keys[2].segment.ease_out] = ease;
        let path = CameraPath::new(24.0, &keys, &Pace::BY_KEYS).expect("keys");
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
        let pace = Pace {
            speed,
            ease_in: 2.0,
            ease_out: 3.0,
            ..Pace::BY_KEYS
        };
        let keys = uneven();
        let path = CameraPath::new(24.0, &keys, &pace).expect("keys");
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
    for pace in [
        CLOSED,
        Pace {
            closed: true,
            ..CONSTANT
        },
    ] {
        let path = CameraPath::new(1000.0, &keys, &pace).expect("keys");
        assert!(path.is_closed());
        assert_eq!(path.timeline().frame_count(), 16000);
        let frame = |frame: i32| path.camera(frame.rem_euclid(16000) as u32);
        let (before, seam, after) = (frame(-1), frame(0), frame(1));
        let steps = [
            seam.position - before.position,
            after.position - seam.position,
        ];
        assert!((steps[1] - steps[0]).length() < 0.05 * steps[0].length());
        let turns = [turn(&before, &seam), turn(&seam, &after)];
        assert!((turns[1] - turns[0]).abs() < 0.05 * turns[0]);
    }
    let keys: Vec<Keyframe> = uneven();
    let error = CameraPath::new(24.0, &keys, &CLOSED).err();
    assert_eq!(error, Some(PathError::NotClosed { what: "position" }));
}

#[test]
fn standing_keys_last_as_long_as_they_say() {
    let mut keys = uneven();
    keys[3].position = keys[2].position;
    for pace in [Pace::BY_KEYS, CONSTANT] {
        let path = CameraPath::new(24.0, &keys, &pace).expect("keys");
        let stands = positions(&path);
        let stands = stands.iter().filter(|&&p| p == keys[2].position).count();
        assert!((35..=37).contains(&stands), "{stands} frames in 1.5 s");
        assert!((path.keys()[3] - path.keys()[2] - 1.5).abs() < 1e-12);
    }
}

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
