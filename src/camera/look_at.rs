use super::Camera;
use super::error::PathError;
use super::rotation::upright;
use glam::{DMat3, DVec3};

/// Nearer to the vertical than this, the right direction would be made of rounding errors.
const SMALLEST_SINE: f64 = 1e-7;

/// How a camera looks at a point with +Y up, before it is rolled.
pub(super) struct LookAt {
    /// From the point to the eye.
    offset: DVec3,
    pub(super) rotation: DMat3,
}

impl LookAt {
    /// From `eye` to `target`. An error is about this frame and time.
    pub(super) fn new(
        eye: DVec3,
        target: DVec3,
        frame: u32,
        time: f64,
    ) -> Result<LookAt, PathError> {
        let offset = eye - target;
        let Some(backward) = offset.try_normalize() else {
            return Err(PathError::LooksAtItself { frame, time });
        };
        if DVec3::Y.cross(backward).length() < SMALLEST_SINE {
            return Err(PathError::LooksVertically { frame, time });
        }
        let rotation = upright(backward, DVec3::Y);
        Ok(LookAt { offset, rotation })
    }

    /// Refuses a camera that since the frame before has passed through its point, or so straight over it that its picture
    /// is turned upside down while it hardly looks elsewhere.
    pub(super) fn check_from(
        &self,
        before: &LookAt,
        frame: u32,
        time: f64,
    ) -> Result<(), PathError> {
        const HARDLY: f64 = 0.5;
        let turned = before.rotation.z_axis.dot(self.rotation.z_axis);
        if before.rotation.x_axis.dot(self.rotation.x_axis) < 0.0 && turned > HARDLY {
            return Err(PathError::Flips { frame, time });
        }
        // Nearer than this share of the way between two frames is through.
        const THROUGH: f64 = 1e-3;
        let way = self.offset - before.offset;
        let nearest = self.offset.cross(before.offset).length() / way.length();
        match turned < 0.0 && nearest < THROUGH * way.length() {
            true => Err(PathError::LooksAtItself { frame, time }),
            false => Ok(()),
        }
    }
}

impl Camera {
    /// One at `eye` that looks at `target` with +Y up, its vertical field of view in radians. Refuses to look
    /// straight up or down, or at itself.
    pub fn look_at(eye: DVec3, target: DVec3, field_of_view: f64) -> Result<Camera, PathError> {
        Ok(Camera {
            position: eye,
            rotation: LookAt::new(eye, target, 0, 0.0)?.rotation,
            half_height: libm::tan(0.5 * field_of_view),
        })
    }
}
