//! Cameras, and the keyframed path that gives one for each frame.
//!
//! Knows nothing of files, pixels' colours or the scene.

mod camera_path;
mod curve;
mod timeline;

pub use camera_path::{CameraPath, Interpolation, Keyframe, Orientation, PathError};
pub use timeline::Timeline;

use crate::math::Ray;
use glam::{DMat3, DVec2, DVec3};

/// A pinhole camera in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye.
    pub position: DVec3,
    /// Camera to world: the columns are the camera's right, up and backward directions.
    pub rotation: DMat3,
    /// The tangent of half the vertical field of view.
    pub half_height: f64,
}

impl Camera {
    /// The ray through a point of the film, with unit direction, relative to a scene's `origin`.
    ///
    /// `film` counts pixels from the upper left corner of a film of `size` pixels, so the centre of
    /// the first pixel is (0.5, 0.5). Pixels are square.
    pub fn ray(&self, film: DVec2, size: DVec2, origin: DVec3) -> Ray {
        let scale = 2.0 * self.half_height / size.y;
        let x = (film.x - 0.5 * size.x) * scale;
        let y = (0.5 * size.y - film.y) * scale;
        let direction = self.rotation * DVec3::new(x, y, -1.0).normalize();
        Ray::new((self.position - origin).as_vec3(), direction.as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn film_corners_see_the_field_of_view() {
        let camera = Camera {
            position: DVec3::new(1.0, 2.0, 3.0),
            rotation: DMat3::IDENTITY,
            half_height: 1.0,
        };
        let size = DVec2::new(200.0, 100.0);
        let ray = |x, y| camera.ray(DVec2::new(x, y), size, DVec3::ONE);
        assert_eq!(ray(100.0, 50.0).direction, Vec3::NEG_Z);
        assert_eq!(ray(100.0, 50.0).origin, Vec3::new(0.0, 1.0, 2.0));
        let top = ray(100.0, 0.0).direction;
        assert!((top - Vec3::new(0.0, 1.0, -1.0).normalize()).length() < 1e-7);
        let right = ray(200.0, 50.0).direction;
        assert!((right - Vec3::new(2.0, 0.0, -1.0).normalize()).length() < 1e-7);
    }
}
