//! Cameras, and the keyframed path that gives one for each frame.
//!
//! Knows nothing of files, pixels' colours or the scene.

mod arc_length;
mod camera_path;
mod error;
mod frame_cameras;
mod hermite;
mod key_checks;
mod keyframe;
mod look_at;
mod orientation_track;
mod pinhole;
mod position_timing;
mod ramp;
mod rotation;
#[cfg(test)]
mod tests;
mod timeline;
mod track;

pub use camera_path::CameraPath;
pub use error::CameraPathError;
pub use frame_cameras::FrameCameras;
pub use keyframe::{CameraPathTiming, Interpolation, Keyframe, Orientation, Segment, Speed};
pub use orientation_track::OrientationMode;
pub use pinhole::{Camera, CameraRays};
pub use timeline::Timeline;
