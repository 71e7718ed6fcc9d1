//! The steps of the camera from frame to frame.

use crate::camera::{Camera, FrameCameras};
use rayon::prelude::*;

/// Measures the step from each frame to the next. None at cuts, and after the last frame of a path that is not
/// closed.
pub(super) fn measure_steps<T: Send>(
    frames: &FrameCameras,
    measure: impl Fn(&Camera, &Camera) -> T + Sync,
) -> Vec<Option<T>> {
    let cameras = &frames.cameras;
    let count = cameras.len();
    let step = |frame: usize| {
        let has_next = frame + 1 < count || (frames.is_closed && count > 1);
        (has_next && !frames.is_cut(frame))
            .then(|| measure(&cameras[frame], &cameras[(frame + 1) % count]))
    };
    (0..count).into_par_iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{open_shot, still};
    use super::measure_steps;
    use crate::camera::FrameCameras;
    use glam::DVec3;

    #[test]
    fn steps_end_at_cuts() {
        let cameras = [0.0, 1.0, 2.0, 7.0, 9.0].map(|x| still(DVec3::X * x, DVec3::NEG_Z));
        let mut frames = open_shot(cameras.to_vec());
        frames.cuts.push(2);
        let moved =
            |frames: &FrameCameras| measure_steps(frames, |a, b| (b.position - a.position).x);
        assert_eq!(
            moved(&frames),
            [Some(1.0), Some(1.0), None, Some(2.0), None]
        );
        assert_eq!(frames.shots(), [0..3, 3..5]);
        frames.is_closed = true;
        assert_eq!(moved(&frames)[4], Some(-9.0));
        frames.cuts.push(4);
        assert_eq!(moved(&frames)[4], None);
        assert_eq!(frames.shots(), [0..3, 3..5]);
    }
}
