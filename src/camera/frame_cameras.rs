use super::{Camera, CameraPath};

/// A camera for each frame of a video and no way between them, as other programs keep it.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCameras {
    /// Frames per second.
    pub fps: f64,
    /// When the first frame is shown, in seconds.
    pub start: f64,
    /// In the order of the frames, at least one.
    pub cameras: Vec<Camera>,
    /// The frames after which the camera jumps to the next; rising.
    pub cuts: Vec<usize>,
}

impl FrameCameras {
    /// When a frame is shown, in seconds.
    pub fn time_of(&self, frame: usize) -> f64 {
        self.start + frame as f64 / self.fps
    }

    /// Those of all frames of a path.
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
