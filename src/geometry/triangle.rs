use crate::math::Ray;
use glam::{DVec3, Vec3};

/// The parameter at which the ray's line meets the triangle's plane, in double precision, where
/// the rounding of a few operations on single-precision corners does not show. Not finite for a
/// ray in the plane.
///
/// It says nothing of the triangle's edges.
#[inline]
pub fn plane_distance(ray: &Ray, corners: [Vec3; 3]) -> f64 {
    let a = corners[0].as_dvec3();
    let normal = normal(corners);
    normal.dot(a - ray.origin.as_dvec3()) / normal.dot(ray.direction.as_dvec3())
}

/// The weights of the second and the third corner at a point of the triangle's plane, clamped to
/// the triangle.
pub(super) fn barycentric(point: DVec3, corners: [Vec3; 3]) -> (f64, f64) {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let normal = normal(corners);
    let scale = 1.0 / normal.length_squared();
    let u = ((c - a).cross(a - point).dot(normal) * scale).clamp(0.0, 1.0);
    let v = ((a - point).cross(b - a).dot(normal) * scale).clamp(0.0, 1.0 - u);
    (u, v)
}

/// The normal of the winding, twice the area long.
pub(super) fn normal(corners: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(5.0, 0.0, 0.0),
        Vec3::new(1.0, 2.0, 0.0),
    ];

    #[test]
    fn barycentric_weights_of_known_points() {
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.25, 0.5)] {
            let point = DVec3::new(1.0 + 4.0 * u, 2.0 * v, 0.0);
            assert_eq!(barycentric(point, CORNERS), (u, v));
        }
        assert_eq!(
            barycentric(DVec3::new(0.999, -0.001, 0.0), CORNERS),
            (0.0, 0.0)
        );
    }

    #[test]
    fn distance_to_the_plane_in_lengths_of_the_direction() {
        let ray = Ray::new(Vec3::new(2.0, 0.5, 3.0), Vec3::new(0.0, 0.0, -0.5));
        assert_eq!(plane_distance(&ray, CORNERS), 6.0);
        let inside = Ray::new(Vec3::new(2.0, 0.5, 0.0), Vec3::X);
        assert!(!plane_distance(&inside, CORNERS).is_finite());
    }
}
