//! The pinhole camera: its rays through the film, and the projection of points onto it.

use super::rotation;
use crate::math::{Ray, RayDifferential};
use glam::{DMat3, DQuat, DVec2, DVec3, Vec3};

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
    /// A camera at `position` that looks along `-backward`, with `up` made perpendicular to it; the vertical field of
    /// view in radians. The directions need not have unit length.
    pub fn from_axes(position: DVec3, backward: DVec3, up: DVec3, field_of_view: f64) -> Camera {
        Camera {
            position,
            rotation: rotation::basis_from_backward_up(backward.normalize(), up),
            half_height: libm::tan(0.5 * field_of_view),
        }
    }

    /// Its rotation as a unit quaternion.
    pub fn quaternion(&self) -> DQuat {
        DQuat::from_mat3(&self.rotation)
    }

    /// The rotation vector (axis times angle in radians, at most pi) from this camera to another, in this camera's
    /// coordinates.
    pub fn turn_to(&self, other: &Camera) -> DVec3 {
        rotation::log(DQuat::from_mat3(
            &(self.rotation.transpose() * other.rotation),
        ))
    }

    /// Its vertical field of view in radians.
    pub fn field_of_view(&self) -> f64 {
        2.0 * libm::atan(self.half_height)
    }

    /// The camera's rays through a film of `size` pixels, relative to a scene's `origin`. Pixels are
    /// square.
    pub fn rays(&self, size: DVec2, origin: DVec3) -> CameraRays {
        let pixel = 2.0 * self.half_height / size.y;
        let right = self.rotation.x_axis * pixel;
        let down = -self.rotation.y_axis * pixel;
        CameraRays {
            eye: (self.position - origin).as_vec3(),
            corner: -self.rotation.z_axis - 0.5 * (size.x * right + size.y * down),
            right,
            down,
        }
    }

    /// Projects a point in world coordinates onto a film of `size` pixels, the inverse of [`CameraRays::through`]. The
    /// result may lie outside the film; none for a point that is not in front of the eye.
    pub fn project(&self, size: DVec2, point: DVec3) -> Option<DVec2> {
        // The rotation's transpose is its inverse.
        let DVec3 { x, y, z } = self.rotation.transpose() * (point - self.position);
        let pixel = 2.0 * self.half_height / size.y;
        (z < 0.0).then(|| 0.5 * size + DVec2::new(x, -y) / (-z * pixel))
    }
}

/// The rays of a camera through its film.
#[derive(Clone, Copy, Debug)]
pub struct CameraRays {
    eye: Vec3,
    /// From the eye to the film's upper left corner.
    corner: DVec3,
    /// From one pixel to the next, and from one row to the next.
    right: DVec3,
    down: DVec3,
}

impl CameraRays {
    /// The ray through a point of the film, with unit direction.
    ///
    /// `film` counts pixels from the upper left corner, so the centre of the first pixel is (0.5, 0.5).
    #[inline]
    pub fn through(&self, film: DVec2) -> Ray {
        Ray::new(self.eye, self.towards(film).normalize().as_vec3())
    }

    /// The differential of the ray through `film`, for a square footprint of `width` pixels around `middle`, which is
    /// less than some pixels away; zero for a width of 0.
    pub fn differential(&self, film: DVec2, middle: DVec2, width: f64) -> RayDifferential {
        if width == 0.0 {
            return RayDifferential::ZERO;
        }
        let towards = self.towards(film);
        let direction = towards.normalize();
        let change = |step: DVec3| {
            let across = step - direction * step.dot(direction);
            (width / towards.length() * across).as_vec3()
        };
        RayDifferential {
            origin: [Vec3::ZERO; 2],
            direction: [self.right, self.down].map(change),
            middle: ((middle - film) / width).as_vec2(),
        }
    }

    /// From the eye to a point of the film, in double precision.
    #[inline]
    fn towards(&self, film: DVec2) -> DVec3 {
        self.corner + film.x * self.right + film.y * self.down
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    #[test]
    fn film_corners_see_the_field_of_view() {
        let camera = Camera {
            position: DVec3::new(1.0, 2.0, 3.0),
            rotation: DMat3::IDENTITY,
            half_height: 1.0,
        };
        let size = DVec2::new(200.0, 100.0);
        let rays = camera.rays(size, DVec3::ONE);
        let ray = |x, y| rays.through(DVec2::new(x, y));
        assert_eq!(ray(100.0, 50.0).direction, Vec3::NEG_Z);
        assert_eq!(ray(100.0, 50.0).origin, Vec3::new(0.0, 1.0, 2.0));
        let top = ray(100.0, 0.0).direction;
        assert!((top - Vec3::new(0.0, 1.0, -1.0).normalize()).length() < 1e-7);
        let right = ray(200.0, 50.0).direction;
        assert!((right - Vec3::new(2.0, 0.0, -1.0).normalize()).length() < 1e-7);
    }

    #[test]
    fn differentials_are_the_differences_of_neighbouring_rays() {
        let axes = (DVec3::new(0.3, 0.4, 1.0), DVec3::Y);
        let camera = Camera::from_axes(DVec3::ONE, axes.0, axes.1, 1.0);
        let rays = camera.rays(DVec2::new(200.0, 100.0), DVec3::ZERO);
        for film in [
            DVec2::new(0.5, 0.5),
            DVec2::new(100.0, 50.0),
            DVec2::new(170.0, 10.0),
        ] {
            let width = 0.5;
            let found = rays.differential(film, film + DVec2::Y, width);
            let through = |film| rays.through(film).direction;
            for (axis, step) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
                let half = 0.5 * width * step;
                let difference = through(film + half) - through(film - half);
                assert!((found.direction[axis] - difference).length() < 3e-7);
                assert_eq!(found.origin[axis], Vec3::ZERO);
            }
            assert_eq!(found.middle, glam::Vec2::new(0.0, 2.0));
            assert_eq!(rays.differential(film, film, 0.0), RayDifferential::ZERO);
        }
    }

    #[test]
    fn projection_undoes_rays() {
        let mut random = Random::new(1);
        let size = DVec2::new(1920.0, 1080.0);
        for _ in 0..1000 {
            let axis = random.point().normalize();
            let rotation = DQuat::from_axis_angle(axis, 6.0 * f64::from(random.unit()));
            let camera = Camera {
                position: 100.0 * random.point(),
                rotation: DMat3::from_quat(rotation),
                half_height: 0.05 + f64::from(random.unit()),
            };
            let origin = camera.position + random.point();
            let rays = camera.rays(size, origin);
            let film = DVec2::new(random.unit().into(), random.unit().into()) * 3.0 * size - size;
            let distance = 1.0 + 1000.0 * f64::from(random.unit());
            let towards = rays.towards(film).normalize() * distance;
            let seen = camera.project(size, camera.position + towards);
            let seen = seen.expect("in front of the eye");
            assert!((seen - film).length() < 1e-9, "{seen} instead of {film}");
            // Rays themselves are rounded to single precision: what an angle is on the film grows with
            // the square of the distance from its middle.
            let seen = camera.project(size, origin + rays.through(film).at(distance));
            let seen = seen.expect("in front of the eye");
            let stretch = rays.towards(film).length_squared() * size.y / camera.half_height;
            assert!((seen - film).length() < f64::from(f32::EPSILON) * stretch);
            assert_eq!(camera.project(size, camera.position - towards), None);
        }
        let camera = Camera::look_at(DVec3::ONE, DVec3::ZERO, 1.0).expect("not straight down");
        assert_eq!(camera.project(size, camera.position), None);
    }
}
