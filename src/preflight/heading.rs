//! Cameras that keep +Y up and look almost straight up or down: their pictures spin.

use super::finding::Measured;
use super::flight::Flight;
use super::{Finding, Oddity};
use crate::camera::Camera;
use std::f64::consts::PI;

/// A heading that turns by more from one frame to the next spins: 120 degrees in a second, at 24 frames.
const LEAST_TURN: f64 = 5.0 * PI / 180.0;

/// So much more than the view the heading turns near the vertical: within 5 degrees of it, and where the camera
/// gets past it from one frame to the next.
const MORE: f64 = 11.0;

/// A camera whose right is horizontal but for so much keeps +Y up.
const LEVEL: f64 = 1e-6;

pub(super) fn find(flight: &Flight) -> Vec<Finding> {
    let turns = flight.steps(spin);
    let found: Vec<Measured> = (turns.into_iter().enumerate())
        .filter_map(|(frame, turn)| Some((frame, turn??)))
        .collect();
    let count = flight.cameras.len();
    let from_vertical = |frame: usize| {
        let up = flight.cameras[frame % count].rotation.z_axis.y.abs();
        up.min(1.0).acos()
    };
    let finding = Finding::of(&found, |frame, turn| Oddity::Spinning {
        frame,
        turn,
        from_vertical: from_vertical(frame as usize).min(from_vertical(frame as usize + 1)),
    });
    finding.into_iter().collect()
}

/// How far a heading turns that spins, in radians; none if it does not.
fn spin(from: &Camera, to: &Camera) -> Option<f64> {
    let rights = [from, to].map(|camera| camera.rotation.x_axis);
    let is_level = rights.iter().all(|right| right.y.abs() < LEVEL);
    let heading = rights[0].angle_between(rights[1]);
    let view = from.rotation.z_axis.angle_between(to.rotation.z_axis);
    (is_level && heading > LEAST_TURN && heading > MORE * view).then_some(heading)
}

#[cfg(test)]
mod tests {
    use super::super::stage::{flight, path, still};
    use super::*;
    use crate::camera::Shape;
    use glam::{DMat3, DVec3};

    /// Past a point 3 m below, so many metres beside it.
    fn fly_over(beside: f64) -> Vec<Finding> {
        let target = DVec3::new(beside, -3.0, 0.0);
        let at = |z| DVec3::new(0.0, 0.0, z);
        let keys = [(0.0, at(3.0), target), (4.0, at(-3.0), target)];
        find(&Flight::new(&path(Shape::Linear, &keys)))
    }

    #[test]
    fn flying_over_the_target_spins() {
        assert_eq!(fly_over(1.0), []);
        let found = fly_over(0.1);
        assert_eq!(found.len(), 1);
        let Oddity::Spinning {
            frame,
            turn,
            from_vertical,
        } = found[0].kind
        else {
            panic!("{found:?}")
        };
        // Half way in the frames between 0 and 96, where a step is 1/16 m.
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
        let found = find(&flight([0.5, 0.12, -0.12, -0.5].map(camera).to_vec()));
        assert_eq!(found.len(), 1);
        let Oddity::Spinning { frame: 1, turn, .. } = found[0].kind else {
            panic!("{found:?}")
        };
        assert!((turn - PI).abs() < 1e-6);
    }

    #[test]
    fn fast_pans_and_cameras_without_an_up_do_not_spin() {
        let pan = |i: u32| {
            let (sin, cos) = (0.3 * f64::from(i)).sin_cos();
            still(DVec3::ZERO, DVec3::new(cos, -1.0, sin))
        };
        assert_eq!(find(&flight((0..20).map(pan).collect())), []);
        // Loops the loop.
        let turned = |i: u32| Camera {
            rotation: DMat3::from_rotation_x(-0.3 * f64::from(i)),
            ..still(DVec3::ZERO, DVec3::X)
        };
        assert_eq!(find(&flight((0..20).map(turned).collect())), []);
    }
}
