//! Tests of camera paths: known answers, and properties of random paths.

mod hard_cases;
mod known_paths;
mod orientations;
mod promises;
mod segments;

use super::error::CameraPathError;
use super::keyframe::{CameraPathTiming, Interpolation, Keyframe, Orientation, Segment, Speed};
use super::{Camera, CameraPath};
use crate::sampling::Random;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

const AHEAD: Orientation = Orientation::Rotation(DQuat::IDENTITY);

const CONSTANT: CameraPathTiming = CameraPathTiming {
    speed: Speed::Constant,
    ..CameraPathTiming::BY_KEYS
};

const CLOSED: CameraPathTiming = CameraPathTiming {
    closed: true,
    ..CameraPathTiming::BY_KEYS
};

fn key(time: f64, position: DVec3, orientation: Orientation) -> Keyframe {
    Keyframe {
        time,
        position,
        orientation,
        field_of_view: FRAC_PI_2,
        segment: Segment::of(Interpolation::CatmullRom),
    }
}

fn at(target: DVec3) -> Orientation {
    Orientation::LookAt { target, roll: 0.0 }
}

fn with(interpolation: Interpolation, mut keys: Vec<Keyframe>) -> Vec<Keyframe> {
    for key in &mut keys {
        key.segment.interpolation = interpolation;
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
        let interpolation = match (5.0 * random.unit()) as u32 {
            0 => Interpolation::Hold,
            1 => Interpolation::Linear,
            2 => Interpolation::Hermite(5.0 * random.point(), 5.0 * random.point()),
            _ => Interpolation::CatmullRom,
        };
        keys.push(Keyframe {
            field_of_view: 0.05 + 2.5 * f64::from(random.unit()),
            segment: Segment {
                interpolation,
                ease_in: random.unit() < 0.2,
                ease_out: random.unit() < 0.2,
            },
            ..key(time, position, Orientation::Rotation(rotation(random)))
        });
    }
    keys
}
