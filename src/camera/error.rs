//! Errors of camera paths.

use thiserror::Error;

/// Why keys do not make a path.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "each variant is described by its message")]
pub enum CameraPathError {
    #[error("there are none; write at least one")]
    NoKeys,
    #[error("key {key}, at {time} s, is not after the key before it; times must rise")]
    TimesDoNotRise { key: usize, time: f64 },
    #[error(
        "key {key} is half a turn from the key before it, so both ways around are equally short; add a \
         key between them, or give yaw_pitch_roll in all keys, which interpolates the angles as given"
    )]
    HalfTurn { key: usize },
    #[error(
        "the last key of a closed path repeats its first one at a later time; they differ in {what}"
    )]
    NotClosed { what: &'static str },
    #[error("a closed path loops: give both ease_in and ease_out, to stop at its seam, or neither")]
    EasesOneSide,
    #[error("ease_in and ease_out take {seconds} s together, and the path lasts {duration} s")]
    EaseTooLong { seconds: f64, duration: f64 },
    #[error(
        "key {key} has `ease`, but `speed: constant` sets the timing of all keys; remove one of them, or give \
         ease_in and ease_out of the path"
    )]
    EaseAtConstantSpeed { key: usize },
    #[error(
        "at {time} s (frame {frame}) the camera is at its look_at point; move one of them, or give \
         yaw_pitch_roll in all keys instead"
    )]
    LooksAtItself { frame: u32, time: f64 },
    #[error(
        "at {time} s (frame {frame}) the camera looks straight up or down, where look_at does not \
         determine its roll; give yaw_pitch_roll in all keys instead"
    )]
    LooksVertically { frame: u32, time: f64 },
    #[error(
        "at {time} s (frame {frame}) the camera is not finite in double precision; give a larger fov, or \
         times and positions closer to each other"
    )]
    NoCamera { frame: u32, time: f64 },
    #[error(
        "at {time} s (frame {frame}) the camera has passed straight over or under its look_at \
         point, and its picture flips; move one of them aside, or give yaw_pitch_roll in \
         all keys instead"
    )]
    Flips { frame: u32, time: f64 },
}
