use super::Camera;
use super::error::PathError;
use glam::{DMat3, DVec3};

/// Nearer to the vertical than this, the right direction would be made of rounding errors.
const SMALLEST_SINE: f64 = 1e-7;

/// The rotation of a camera that looks from `eye` to `target` with +Y up. An error is about this frame and time.
pub(super) fn look_at(
    eye: DVec3,
    target: DVec3,
    frame: u32,
    time: f64,
) -> Result<DMat3, PathError> {
    let Some(backward) = (eye - target).try_normalize() else {
        return Err(PathError::LooksAtItself { frame, time });
    };
    let right = DVec3::Y.cross(backward);
    if right.length() < SMALLEST_SINE {
        return Err(PathError::LooksVertically { frame, time });
    }
    let right = right.normalize();
    Ok(DMat3::from_cols(right, backward.cross(right), backward))
}

/// Whether a camera that was to keep +Y up has turned its picture upside down while it hardly looks elsewhere.
pub(super) fn is_flipped(before: &DMat3, after: &DMat3) -> bool {
    const HARDLY: f64 = 0.5;
    before.x_axis.dot(after.x_axis) < 0.0 && before.z_axis.dot(after.z_axis) > HARDLY
}

impl Camera {
    /// One at `eye` that looks at `target` with +Y up, its vertical field of view in radians. Refuses to look
    /// straight up or down, or at itself.
    pub fn look_at(eye: DVec3, target: DVec3, field_of_view: f64) -> Result<Camera, PathError> {
        Ok(Camera {
            position: eye,
            rotation: look_at(eye, target, 0, 0.0)?,
            half_height: libm::tan(0.5 * field_of_view),
        })
    }
}
