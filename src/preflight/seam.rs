//! Paths that end where they start.

use super::flight::Flight;
use super::{FrameRuns, PathWarning, WarningKind};
use crate::camera::Camera;

/// Cameras are the same whose turns and zooms differ by less, and whose places do by a smaller share of the path.
const SAME: f64 = 1e-9;

pub(super) fn find(flight: &Flight) -> Vec<PathWarning> {
    let Some((first, others)) = flight.cameras.split_first() else {
        return Vec::new();
    };
    let way = |camera: &Camera| camera.position.distance(first.position);
    let extent = others.iter().map(way).fold(0.0, f64::max);
    let is_first = |camera: &Camera| {
        way(camera) <= SAME * extent
            && camera.rotation.abs_diff_eq(first.rotation, SAME)
            && (camera.half_height - first.half_height).abs() <= SAME * first.half_height
    };
    let repeats =
        !flight.is_closed && others.last().is_some_and(is_first) && !others.iter().all(is_first);
    let finding = PathWarning {
        frames: FrameRuns::of([others.len() as u32]),
        kind: WarningKind::RepeatsFirstFrame,
    };
    repeats.then_some(finding).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::super::stage::{flight, path, still};
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
            let mut flight = Flight::new(&path(interpolation, &back));
            let found = find(&flight);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].frames, FrameRuns::of([48]));
            assert_eq!(found[0].kind, WarningKind::RepeatsFirstFrame);
            flight.is_closed = true;
            assert_eq!(find(&flight), []);
            flight.is_closed = false;
            flight.cameras.pop();
            assert_eq!(find(&flight), []);
        }
    }

    #[test]
    fn cameras_that_stand_still_repeat_nothing() {
        let camera = still(DVec3::ONE, DVec3::X);
        for count in [0, 1, 2, 9] {
            assert_eq!(find(&flight(vec![camera; count])), []);
        }
    }
}
