use crate::camera::{Camera, CameraPath, OrientationMode};
use rayon::prelude::*;
use std::ops::Range;

/// The cameras of all frames of a path, and which of them follow each other.
#[derive(Debug)]
pub(super) struct Flight {
    pub(super) cameras: Vec<Camera>,
    /// Whether the camera jumps between each frame and the next.
    pub(super) cuts: Vec<bool>,
    /// Whether the first frame follows the last.
    pub(super) is_closed: bool,
    /// Frames per second.
    pub(super) fps: f64,
    pub(super) orientation_mode: OrientationMode,
}

impl Flight {
    pub(super) fn new(path: &CameraPath) -> Flight {
        let timeline = path.timeline();
        let frames = 0..timeline.frame_count();
        Flight {
            cameras: frames.clone().map(|frame| path.camera(frame)).collect(),
            cuts: frames.map(|frame| path.is_cut(frame)).collect(),
            is_closed: path.is_closed(),
            fps: timeline.fps,
            orientation_mode: path.orientation_mode(),
        }
    }

    /// Measures the step from each frame to the next; none where the camera jumps, and after the last
    /// frame of a path that is not closed.
    pub(super) fn steps<T: Send>(
        &self,
        measure: impl Fn(&Camera, &Camera) -> T + Sync,
    ) -> Vec<Option<T>> {
        let count = self.cameras.len();
        let step = |frame: usize| {
            let goes_on = frame + 1 < count || (self.is_closed && count > 1);
            (goes_on && !self.cuts[frame])
                .then(|| measure(&self.cameras[frame], &self.cameras[(frame + 1) % count]))
        };
        (0..count).into_par_iter().map(step).collect()
    }

    /// The frames between jumps of the camera.
    pub(super) fn shots(&self) -> Vec<Range<usize>> {
        let mut shots = Vec::new();
        let mut first = 0;
        for end in 1..=self.cameras.len() {
            if end == self.cameras.len() || self.cuts[end - 1] {
                shots.push(first..end);
                first = end;
            }
        }
        shots
    }
}

#[cfg(test)]
mod tests {
    use super::super::stage::{flight, still};
    use glam::DVec3;

    #[test]
    fn steps_end_where_the_camera_jumps() {
        let places = [0.0, 1.0, 2.0, 7.0, 9.0].map(|x| still(DVec3::X * x, DVec3::NEG_Z));
        let mut flight = flight(places.to_vec());
        flight.cuts[2] = true;
        let moved = |flight: &super::Flight| flight.steps(|a, b| (b.position - a.position).x);
        assert_eq!(
            moved(&flight),
            [Some(1.0), Some(1.0), None, Some(2.0), None]
        );
        assert_eq!(flight.shots(), [0..3, 3..5]);
        flight.is_closed = true;
        assert_eq!(moved(&flight)[4], Some(-9.0));
        flight.cuts[4] = true;
        assert_eq!(moved(&flight)[4], None);
        assert_eq!(flight.shots(), [0..3, 3..5]);
    }
}
