//! The orientation of the camera along a path: a look_at point, angles or rotations, whichever the keys give.

use super::Timeline;
use super::error::CameraPathError;
use super::keyframe::{Interpolation, Keyframe, Orientation};
use super::look_at::LookAt;
use super::rotation::{roll, yaw_pitch_roll};
use super::track::{Track, TrackInput, TrackTime};
use glam::{DMat3, DQuat, DVec3};

/// How a path gives the orientation of its camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrientationMode {
    /// A point that the camera looks at, and a roll against +Y.
    LookAt,
    /// Yaw, pitch and roll.
    YawPitchRoll,
    /// Rotations; also where keys of different modes are mixed.
    Rotation,
}

/// The interpolated orientation, by mode.
#[derive(Clone, Debug)]
pub(super) enum OrientationTrack {
    LookAt {
        targets: Track<DVec3>,
        rolls: Track<f64>,
    },
    YawPitchRoll(Track<DVec3>),
    Rotation(Track<DQuat>),
}

impl OrientationTrack {
    pub(super) fn new(
        keys: &[Keyframe],
        tracks: &TrackInput,
        timeline: &Timeline,
    ) -> Result<OrientationTrack, CameraPathError> {
        let points = keys.iter().map(|key| match key.orientation {
            Orientation::LookAt { target, roll } => Some((target, roll)),
            _ => None,
        });
        if let Some(points) = points.collect::<Option<Vec<_>>>() {
            return Ok(OrientationTrack::LookAt {
                targets: tracks.through(points.iter().map(|point| point.0)),
                rolls: tracks.through(points.iter().map(|point| point.1)),
            });
        }
        let angles = keys.iter().map(|key| match key.orientation {
            Orientation::YawPitchRoll(angles) => Some(angles),
            _ => None,
        });
        if let Some(angles) = angles.collect::<Option<Vec<_>>>() {
            return Ok(OrientationTrack::YawPitchRoll(
                tracks.through(angles.into_iter()),
            ));
        }
        let rotations = keys.iter().map(|key| rotation(key, timeline));
        let rotations: Vec<DQuat> = rotations.collect::<Result<_, _>>()?;
        // Nearer to half a turn than this, the axis of the rotation is rounding error.
        const MIN_COSINE: f64 = 1e-9;
        for (i, pair) in rotations.windows(2).enumerate() {
            let is_half_turn = pair[0].dot(pair[1]).abs() < MIN_COSINE;
            if is_half_turn && tracks.segments[i].interpolation != Interpolation::Hold {
                return Err(CameraPathError::HalfTurn { key: i + 1 });
            }
        }
        Ok(OrientationTrack::Rotation(
            tracks.through(rotations.into_iter()),
        ))
    }

    pub(super) fn mode(&self) -> OrientationMode {
        match self {
            OrientationTrack::LookAt { .. } => OrientationMode::LookAt,
            OrientationTrack::YawPitchRoll(_) => OrientationMode::YawPitchRoll,
            OrientationTrack::Rotation(_) => OrientationMode::Rotation,
        }
    }

    /// The rotation of a camera at `position` and, if it has a look_at point, how it looks at it. An error names
    /// `frame` and `time`.
    pub(super) fn rotation(
        &self,
        track_time: TrackTime,
        position: DVec3,
        frame: u32,
        time: f64,
    ) -> Result<(DMat3, Option<LookAt>), CameraPathError> {
        Ok(match self {
            OrientationTrack::LookAt { targets, rolls } => {
                let look_at = LookAt::new(position, targets.at(track_time), frame, time)?;
                (look_at.rotation * roll(rolls.at(track_time)), Some(look_at))
            }
            OrientationTrack::YawPitchRoll(angles) => (yaw_pitch_roll(angles.at(track_time)), None),
            OrientationTrack::Rotation(rotations) => {
                (DMat3::from_quat(rotations.at(track_time)), None)
            }
        })
    }
}

/// The rotation of the camera at a key.
fn rotation(key: &Keyframe, timeline: &Timeline) -> Result<DQuat, CameraPathError> {
    let matrix = match key.orientation {
        Orientation::Rotation(rotation) => return Ok(rotation),
        Orientation::YawPitchRoll(angles) => yaw_pitch_roll(angles),
        Orientation::LookAt {
            target,
            roll: angle,
        } => {
            let frame = ((key.time - timeline.start) * timeline.fps).round() as u32;
            LookAt::new(key.position, target, frame, key.time)?.rotation * roll(angle)
        }
    };
    Ok(DQuat::from_mat3(&matrix))
}
