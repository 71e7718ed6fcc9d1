//! Paths that end where they start, but are not closed.

use super::{FrameRuns, PathWarning, WarningKind};
use crate::camera::{Camera, FrameCameras};

/// Tolerance for equal cameras: of rotation and zoom, and of the position relative to the extent of the path.
const SAME: f64 = 1e-9;

pub(super) fn find(frames: &FrameCameras) -> Vec<PathWarning> {
    let Some((first, others)) = frames.cameras.split_first() else {
        return Vec::new();
    };
    let distance = |camera: &Camera| camera.position.distance(first.position);
    let extent = others.iter().map(distance).fold(0.0, f64::max);
    let is_first = |camera: &Camera| {
        distance(camera) <= SAME * extent
            && camera.rotation.abs_diff_eq(first.rotation, SAME)
            && (camera.half_height - first.half_height).abs() <= SAME * first.half_height
    };
    let repeats =
        !frames.is_closed && others.last().is_some_and(is_first) && !others.iter().all(is_first);
    let warning = PathWarning {
        frames: FrameRuns::of([others.len() as u32]),
        kind: WarningKind::RepeatsFirstFrame,
    };
    repeats.then_some(warning).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{open_shot, path, still};
    use super::*;
    use crate::camera::Interpolation;
    use glam::DVec3;

    #[test]
    fn a_path_that_comes_back_repeats_its_first_frame() {
        let target = DVec3::new(1.0, 0.0, -9.0);
        let at = |x: f64| DVec3::new(1e6 + x, 0.1, 0.3);
        for interpolation in [Interpolation::Linear, Interpolation::CatmullRom] {
            let back = [
                (0.0, at(0.0), target),
                (1.0, at(2.0), target),
                (2.0, at(0.0), target),
            ];
            let mut frames = FrameCameras::of(&path(interpolation, &back));
            let found = find(&frames);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].frames, FrameRuns::of([48]));
            assert_eq!(found[0].kind, WarningKind::RepeatsFirstFrame);
            frames.is_closed = true;
            assert_eq!(find(&frames), []);
            frames.is_closed = false;
            frames.cameras.pop();
            assert_eq!(find(&frames), []);
        }
    }

    #[test]
    fn cameras_that_stand_still_repeat_nothing() {
        let camera = still(DVec3::ONE, DVec3::X);
        for count in [0, 1, 2, 9] {
            assert_eq!(find(&open_shot(vec![camera; count])), []);
        }
    }
}
