//! The camera that looks at a point with +Y up, and where that is undefined.

use super::Camera;
use super::error::CameraPathError;
use super::rotation::basis_from_backward_up;
use glam::{DMat3, DVec3};

/// Sine of the angle to the vertical below which the right direction is rounding error.
const MIN_SINE: f64 = 1e-7;

/// The orientation of a camera that looks at a point with +Y up, before roll.
pub(super) struct LookAt {
    /// From the point to the eye.
    offset: DVec3,
    pub(super) rotation: DMat3,
}

impl LookAt {
    /// From `eye` to `target`. An error names `frame` and `time`.
    pub(super) fn new(
        eye: DVec3,
        target: DVec3,
        frame: u32,
        time: f64,
    ) -> Result<LookAt, CameraPathError> {
        let offset = eye - target;
        let Some(backward) = offset.try_normalize() else {
            return Err(CameraPathError::LooksAtItself { frame, time });
        };
        if DVec3::Y.cross(backward).length() < MIN_SINE {
            return Err(CameraPathError::LooksVertically { frame, time });
        }
        let rotation = basis_from_backward_up(backward, DVec3::Y);
        Ok(LookAt { offset, rotation })
    }

    /// Refuses a camera that has passed its point since the frame before: through it, or so closely over or under it
    /// that the picture flips while the view direction hardly changes.
    pub(super) fn check_from(
        &self,
        before: &LookAt,
        frame: u32,
        time: f64,
    ) -> Result<(), CameraPathError> {
        /// Cosine of the change of the view direction below which it is no flip.
        const MIN_COSINE: f64 = 0.5;
        let turned = before.rotation.z_axis.dot(self.rotation.z_axis);
        if before.rotation.x_axis.dot(self.rotation.x_axis) < 0.0 && turned > MIN_COSINE {
            return Err(CameraPathError::Flips { frame, time });
        }
        /// Distance to the point, relative to the step between the frames, that counts as through it.
        const THROUGH: f64 = 1e-3;
        let step = self.offset - before.offset;
        let nearest = self.offset.cross(before.offset).length() / step.length();
        match turned < 0.0 && nearest < THROUGH * step.length() {
            true => Err(CameraPathError::LooksAtItself { frame, time }),
            false => Ok(()),
        }
    }
}

impl Camera {
    /// A camera at `eye` that looks at `target` with +Y up; the vertical field of view in radians. An error if
    /// `target` is `eye` or vertically above or below it.
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        field_of_view: f64,
    ) -> Result<Camera, CameraPathError> {
        Ok(Camera {
            position: eye,
            rotation: LookAt::new(eye, target, 0, 0.0)?.rotation,
            half_height: libm::tan(0.5 * field_of_view),
        })
    }
}
