//! How evenly cameras move, and what a path costs: the figures of tests/bench/README.md.
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "talking to the user is its job")]

use flythrough::camera::{
    Camera, CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment, Speed,
};
use glam::{DQuat, DVec3};
use std::time::Instant;

/// Seconds of 300 frames.
const DURATION: f64 = 299.0 / 24.0;

/// Six keys at equal times, from 0.4 to 5 m apart, and where the camera turns.
const KEYS: [(DVec3, f64); 6] = [
    (DVec3::new(0.0, 1.0, 0.0), 0.0),
    (DVec3::new(0.4, 1.0, 0.0), 0.3),
    (DVec3::new(5.2, 1.2, 1.4), 1.2),
    (DVec3::new(5.6, 1.3, 1.8), 0.7),
    (DVec3::new(5.0, 1.6, 5.0), 2.0),
    (DVec3::new(4.0, 1.6, 5.4), 2.1),
];

fn time_of(key: usize) -> f64 {
    DURATION * key as f64 / 5.0
}

fn keys() -> Vec<Keyframe> {
    let keys = KEYS
        .iter()
        .enumerate()
        .map(|(i, &(position, yaw))| Keyframe {
            time: time_of(i),
            position,
            orientation: Orientation::Rotation(
                DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(0.4 * (i as f64).sin()),
            ),
            field_of_view: 1.0,
            segment: Segment::of(Interpolation::CatmullRom),
        });
    keys.collect()
}

fn cameras(path: &CameraPath) -> Vec<Camera> {
    let frames = 0..path.timeline().frame_count();
    frames.map(|frame| path.camera(frame)).collect()
}

/// The largest step from frame to frame over the smallest, and how many steps lead backward between their keys.
fn steps(positions: &[DVec3], keys: &[f64]) -> (f64, usize) {
    let steps = positions.windows(2).map(|p| p[1] - p[0]);
    let lengths = steps.clone().map(DVec3::length);
    let largest = lengths.clone().fold(0.0, f64::max);
    let smallest = lengths.fold(f64::INFINITY, f64::min);
    let backward = steps.enumerate().filter(|(frame, step)| {
        let time = (*frame as f64 + 0.5) / 24.0;
        let i = keys
            .partition_point(|&key| key <= time)
            .clamp(1, keys.len() - 1);
        step.dot(KEYS[i].0 - KEYS[i - 1].0) < 0.0
    });
    (largest / smallest, backward.count())
}

/// The uniform Catmull-Rom spline of most programs.
fn uniform(time: f64) -> DVec3 {
    let i = (5.0 * time / DURATION).min(4.0) as usize;
    let s = 5.0 * time / DURATION - i as f64;
    let point = |i: usize| KEYS[i].0;
    let (a, b) = (point(i), point(i + 1));
    let before = if i == 0 { 2.0 * a - b } else { point(i - 1) };
    let after = if i == 4 { 2.0 * b - a } else { point(i + 2) };
    let (da, db) = (0.5 * (b - before), 0.5 * (after - a));
    let t = 1.0 - s;
    a * (t * t * (1.0 + 2.0 * s)) + da * (s * t * t) + b * (s * s * (3.0 - 2.0 * s))
        - db * (s * s * t)
}

/// The largest jump of the angular velocity at a key, as a fraction of its mean.
fn turn_jump(timing: &CameraPathTiming) -> f64 {
    const FPS: f64 = 240_000.0;
    let path = CameraPath::new(FPS, &keys(), timing).unwrap();
    let turn = |from: u32, to: u32| {
        let [from, to] = [from, to].map(|frame| path.camera(frame));
        from.rotation * from.turn_to(&to)
    };
    let count = path.timeline().frame_count();
    let turns = (0..count - 100)
        .step_by(100)
        .map(|frame| turn(frame, frame + 100).length());
    let mean = FPS * turns.sum::<f64>() / f64::from(count);
    let inner = &path.keys()[1..5];
    let jumps = inner.iter().map(|key| {
        let frame = (key * FPS).round() as u32;
        // Frames beside the key, so that no difference goes across it.
        let side = |a: u32, b: u32, c: u32| (4.0 * turn(a, b) - turn(a, c)) / 2.0;
        let after = side(frame + 1, frame + 2, frame + 3);
        let before = -side(frame - 1, frame - 2, frame - 3);
        FPS * (after - before).length()
    });
    jumps.fold(0.0, f64::max) / mean
}

fn main() {
    let times: Vec<f64> = (0..6).map(time_of).collect();
    let constant = CameraPathTiming {
        speed: Speed::Constant,
        ..CameraPathTiming::BY_KEYS
    };
    println!("6 uneven keys, 300 frames              largest/smallest step   frames backward");
    let others: Vec<DVec3> = (0..300)
        .map(|frame| uniform(f64::from(frame) / 24.0))
        .collect();
    let mut rows = vec![("uniform Catmull-Rom, as elsewhere", others, times)];
    for (name, timing) in [
        ("speed: by_keys", CameraPathTiming::BY_KEYS),
        ("speed: constant", constant),
    ] {
        let path = CameraPath::new(24.0, &keys(), &timing).unwrap();
        let positions = cameras(&path)
            .iter()
            .map(|camera| camera.position)
            .collect();
        rows.push((name, positions, path.keys().to_vec()));
    }
    for (name, positions, keys) in rows {
        let (ratio, backward) = steps(&positions, &keys);
        println!("{name:<38} {ratio:>21.4} {backward:>17}");
    }
    for (name, timing) in [
        ("by_keys", CameraPathTiming::BY_KEYS),
        ("constant", constant),
    ] {
        let jump = 100.0 * turn_jump(&timing);
        println!("angular velocity at keys, {name:<8}      jumps by {jump:.4} % of its mean");
    }

    let zoom = [60.0, 6.0].map(|degrees: f64| Keyframe {
        time: if degrees > 30.0 { 0.0 } else { 100.0 / 24.0 },
        field_of_view: degrees.to_radians(),
        ..keys()[0]
    });
    let zoom = CameraPath::new(24.0, &zoom, &CameraPathTiming::BY_KEYS).unwrap();
    let sizes: Vec<f64> = cameras(&zoom)
        .iter()
        .map(|camera| camera.half_height)
        .collect();
    let factors: Vec<f64> = sizes.windows(2).map(|pair| pair[0] / pair[1]).collect();
    let most = factors.iter().copied().fold(0.0, f64::max);
    let least = factors.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "zoom from 60 to 6 degrees in 100 frames: {:.3} % a frame, differing by {:.0e}",
        100.0 * (most - 1.0),
        most / least - 1.0
    );

    let many: Vec<Keyframe> = (0..10_000)
        .map(|i| {
            let position = DVec3::new((0.3 * f64::from(i)).sin(), 0.0, f64::from(i));
            Keyframe {
                time: f64::from(i),
                position,
                ..keys()[i as usize % 6]
            }
        })
        .collect();
    for (name, timing) in [
        ("by_keys", CameraPathTiming::BY_KEYS),
        ("constant", constant),
    ] {
        let start = Instant::now();
        let path = CameraPath::new(24.0, &many, &timing).unwrap();
        let frames = path.timeline().frame_count();
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "10,000 keys, {frames} frames, {name:<8}: every camera checked in {seconds:.2} s, {:.2} us each",
            1e6 * seconds / f64::from(frames)
        );
    }
}
