//! The cameras of all frames of a video, as other programs keep them.

use super::{Camera, CameraPath};

/// A camera for each frame of a video, without a curve between them.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCameras {
    /// Frames per second.
    pub fps: f64,
    /// When the first frame is shown, in seconds.
    pub start: f64,
    /// In the order of the frames, at least one.
    pub cameras: Vec<Camera>,
    /// The frames after which there is a cut; rising.
    pub cuts: Vec<usize>,
}

impl FrameCameras {
    /// When a frame is shown, in seconds.
    pub fn time_of(&self, frame: usize) -> f64 {
        self.start + frame as f64 / self.fps
    }

    /// The cameras of all frames of a path.
    pub fn of(path: &CameraPath) -> FrameCameras {
        let timeline = path.timeline();
        let frames = 0..timeline.frame_count();
        let cuts = frames.clone().filter(|frame| path.is_cut(*frame));
        FrameCameras {
            fps: timeline.fps,
            start: timeline.start,
            cuts: cuts.map(|frame| frame as usize).collect(),
            cameras: frames.map(|frame| path.camera(frame)).collect(),
        }
    }
}
