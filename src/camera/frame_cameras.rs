//! The cameras of all frames of a video, as other programs keep them.

use super::{Camera, CameraPath};
use std::ops::Range;

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
    /// Whether the first frame follows the last one.
    pub is_closed: bool,
}

impl FrameCameras {
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
            is_closed: path.is_closed(),
        }
    }

    /// When a frame is shown, in seconds.
    pub fn time_of(&self, frame: usize) -> f64 {
        self.start + frame as f64 / self.fps
    }

    /// Whether there is a cut between a frame and the next one.
    pub fn is_cut(&self, frame: usize) -> bool {
        self.cuts.binary_search(&frame).is_ok()
    }

    /// The frames between cuts, in their order.
    pub fn shots(&self) -> Vec<Range<usize>> {
        let count = self.cameras.len();
        let ends = self.cuts.iter().map(|cut| cut + 1);
        let ends = ends.filter(|end| *end < count).chain([count]);
        ends.scan(0, |start, end| Some(std::mem::replace(start, end)..end))
            .collect()
    }
}
