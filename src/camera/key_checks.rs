//! What keys must satisfy before a path is made of them: rising times, easing that fits, a closed path that closes.

use super::error::CameraPathError;
use super::keyframe::{CameraPathTiming, Keyframe, Orientation, Speed};
use super::rotation::{roll, yaw_pitch_roll};
use glam::DMat3;

/// Checks the keys and the timing against each other.
pub(super) fn check(keys: &[Keyframe], timing: &CameraPathTiming) -> Result<(), CameraPathError> {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else {
        return Err(CameraPathError::NoKeys);
    };
    if let Some(i) = keys.windows(2).position(|k| k[1].time <= k[0].time) {
        return Err(CameraPathError::TimesDoNotRise {
            key: i + 1,
            time: keys[i + 1].time,
        });
    }
    let (seconds, duration) = (timing.ease_in + timing.ease_out, last.time - first.time);
    // Allows for the rounding of sums of decimals.
    if seconds > duration * (1.0 + 1e-12) {
        return Err(CameraPathError::EaseTooLong { seconds, duration });
    }
    if timing.closed && (timing.ease_in > 0.0) != (timing.ease_out > 0.0) {
        return Err(CameraPathError::EasesOneSide);
    }
    let eases = |key: &Keyframe| key.segment.ease_in || key.segment.ease_out;
    if let (Speed::Constant, Some(key)) = (timing.speed, keys.iter().position(eases)) {
        return Err(CameraPathError::EaseAtConstantSpeed { key });
    }
    match difference(first, last) {
        Some(what) if timing.closed => Err(CameraPathError::NotClosed { what }),
        _ => Ok(()),
    }
}

/// The first property in which two keys differ, if any.
fn difference(a: &Keyframe, b: &Keyframe) -> Option<&'static str> {
    if a.position != b.position {
        return Some("position");
    }
    if a.field_of_view != b.field_of_view {
        return Some("fov");
    }
    // Angles may differ by whole turns.
    let turned = |matrix: DMat3, other: DMat3| !matrix.abs_diff_eq(other, 1e-9);
    match (a.orientation, b.orientation) {
        (
            Orientation::LookAt { target: p, roll: r },
            Orientation::LookAt { target: q, roll: s },
        ) => {
            if p != q {
                return Some("look_at");
            }
            turned(roll(r), roll(s)).then_some("roll")
        }
        (Orientation::YawPitchRoll(p), Orientation::YawPitchRoll(q)) => {
            turned(yaw_pitch_roll(p), yaw_pitch_roll(q)).then_some("yaw_pitch_roll")
        }
        (Orientation::Rotation(p), Orientation::Rotation(q)) => {
            turned(DMat3::from_quat(p), DMat3::from_quat(q)).then_some("rotation")
        }
        _ => Some("how the orientation is given"),
    }
}
