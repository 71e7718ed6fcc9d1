//! Spins of the image: a camera that keeps +Y up, or a given roll from it, turns fast about the vertical when it looks
//! almost straight up or down.

use super::steps::measure_steps;
use super::warning::Measured;
use super::{PathWarning, WarningKind};
use crate::camera::{Camera, FrameCameras, OrientationMode};
use glam::DVec3;
use std::f64::consts::PI;

/// The least angular velocity of the heading that counts as a spin, in radians per second.
const MIN_TURN: f64 = 2.0 / 3.0 * PI;

/// The least ratio of the heading's turn to that of the view direction in a spin: that of a view within 5 degrees of
/// the vertical, or of one that passes it between two frames.
const MIN_RATIO: f64 = 11.0;

/// Tolerance for "no roll": the vertical component of the camera's right direction.
const LEVEL: f64 = 1e-6;

pub(super) fn find(frames: &FrameCameras, mode: OrientationMode) -> Vec<PathWarning> {
    // The right direction of the camera without its roll.
    let right = |camera: &Camera| match mode {
        OrientationMode::LookAt => Some(DVec3::Y.cross(camera.rotation.z_axis)),
        // Explicit angles are intended.
        OrientationMode::YawPitchRoll => None,
        OrientationMode::Rotation => {
            Some(camera.rotation.x_axis).filter(|right| right.y.abs() < LEVEL)
        }
    };
    let turns = measure_steps(frames, |from, to| {
        let heading = right(from)?.angle_between(right(to)?);
        let view = from.rotation.z_axis.angle_between(to.rotation.z_axis);
        (heading > MIN_TURN / frames.fps && heading > MIN_RATIO * view).then_some(heading)
    });
    let found: Vec<Measured> = (turns.into_iter().enumerate())
        .filter_map(|(frame, turn)| Some((frame, turn??)))
        .collect();
    let count = frames.cameras.len();
    let from_vertical = |frame: usize| {
        let up = frames.cameras[frame % count].rotation.z_axis.y.abs();
        up.min(1.0).acos()
    };
    let warning = PathWarning::of(&found, |frame, turn| WarningKind::SpinsNearVertical {
        frame,
        turn,
        from_vertical: from_vertical(frame as usize).min(from_vertical(frame as usize + 1)),
    });
    warning.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{FPS, open_shot, path, still};
    use super::*;
    use crate::camera::{
        CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment,
    };
    use glam::DMat3;

    fn of_path(path: &CameraPath) -> Vec<PathWarning> {
        find(&FrameCameras::of(path), path.orientation_mode())
    }

    fn of_cameras(cameras: Vec<Camera>) -> Vec<PathWarning> {
        find(&open_shot(cameras), OrientationMode::Rotation)
    }

    /// Warnings of a camera that flies past a point 3 m below it, `offset` m to the side, and looks at it.
    fn fly_over(offset: f64) -> Vec<PathWarning> {
        let target = DVec3::new(offset, -3.0, 0.0);
        let at = |z| DVec3::new(0.0, 0.0, z);
        let keys = [(0.0, at(3.0), target), (4.0, at(-3.0), target)];
        of_path(&path(Interpolation::Linear, &keys))
    }

    #[test]
    fn flying_over_the_target_spins() {
        assert_eq!(fly_over(1.0), []);
        let found = fly_over(0.1);
        assert_eq!(found.len(), 1);
        let WarningKind::SpinsNearVertical {
            frame,
            turn,
            from_vertical,
        } = found[0].kind
        else {
            panic!("{found:?}")
        };
        // Half way between frames 0 and 96, where a step is 1/16 m.
        assert!(frame == 47 || frame == 48);
        assert!((turn - 0.625_f64.atan()).abs() < 1e-9, "{turn}");
        assert!(
            (from_vertical - (0.1_f64 / 3.0).atan()).abs() < 1e-9,
            "{from_vertical}"
        );
    }

    #[test]
    fn looking_past_the_vertical_in_one_step_is_found() {
        let camera = |z: f64| still(DVec3::ZERO, DVec3::new(0.0, -1.0, z));
        let found = of_cameras([0.5, 0.12, -0.12, -0.5].map(camera).to_vec());
        assert_eq!(found.len(), 1);
        let WarningKind::SpinsNearVertical { frame: 1, turn, .. } = found[0].kind else {
            panic!("{found:?}")
        };
        assert!((turn - PI).abs() < 1e-6);
    }

    #[test]
    fn rolled_cameras_spin_and_explicit_angles_do_not() {
        let target = DVec3::new(0.1, -3.0, 0.0);
        let key = |(time, z): (f64, f64), orientation| Keyframe {
            time,
            position: DVec3::new(0.0, 0.0, z),
            orientation,
            field_of_view: 1.0,
            segment: Segment::of(Interpolation::Linear),
        };
        let found = |keys: [Keyframe; 2]| {
            let path = CameraPath::new(FPS, &keys, &CameraPathTiming::BY_KEYS).expect("a path");
            of_path(&path)
        };
        let rolled = [(0.0, 3.0), (4.0, -3.0)]
            .map(|time_and_z| key(time_and_z, Orientation::LookAt { target, roll: 0.3 }));
        assert_eq!(found(rolled).len(), 1);
        // Almost straight down, a quarter of a turn in half a second.
        let down = |yaw| Orientation::YawPitchRoll(DVec3::new(yaw, -0.499 * PI, 0.0));
        let turned = [key((0.0, 0.0), down(0.0)), key((0.5, 0.0), down(0.5 * PI))];
        assert_eq!(found(turned), []);
    }

    #[test]
    fn fast_pans_and_cameras_without_an_up_do_not_spin() {
        let pan = |i: u32| {
            let (sin, cos) = (0.3 * f64::from(i)).sin_cos();
            still(DVec3::ZERO, DVec3::new(cos, -1.0, sin))
        };
        assert_eq!(of_cameras((0..20).map(pan).collect()), []);
        // A vertical loop.
        for step in [0.02, 0.3] {
            let turned = |i: u32| Camera {
                rotation: DMat3::from_rotation_x(-step * f64::from(i)),
                ..still(DVec3::ZERO, DVec3::X)
            };
            assert_eq!(of_cameras((0..400).map(turned).collect()), []);
        }
    }
}
