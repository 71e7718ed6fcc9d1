//! Triangles in double precision: barycentric coordinates and closest points.

use glam::{DVec3, Vec3};

/// The barycentric coordinates (u, v) of a point of the triangle's plane, the weights of the second and third
/// vertex, clamped to the triangle.
#[inline(always)]
pub(super) fn barycentric(point: DVec3, vertices: [Vec3; 3]) -> (f64, f64) {
    let [a, b, c] = vertices.map(|p| p.as_dvec3());
    let normal = normal(vertices);
    let scale = 1.0 / normal.length_squared();
    let u = ((c - a).cross(a - point).dot(normal) * scale).clamp(0.0, 1.0);
    let v = ((a - point).cross(b - a).dot(normal) * scale).clamp(0.0, 1.0 - u);
    (u, v)
}

/// The changes of the barycentric coordinates (u, v) of a point that moves by `step` in the triangle's plane.
#[inline(always)]
pub(super) fn barycentric_changes(step: DVec3, vertices: [Vec3; 3]) -> (f64, f64) {
    let [a, b, c] = vertices.map(|p| p.as_dvec3());
    let normal = normal(vertices);
    let scale = 1.0 / normal.length_squared();
    let u = step.cross(c - a).dot(normal) * scale;
    let v = (b - a).cross(step).dot(normal) * scale;
    (u, v)
}

/// The distance from a point to the closest point of a triangle, which may be degenerate: to its plane where the
/// point projects inside, elsewhere to the nearest edge (the Voronoi regions of Ericson 2005, "Real-Time Collision
/// Detection", 5.1.5).
pub fn distance_to_triangle(point: DVec3, vertices: [Vec3; 3]) -> f64 {
    let normal = normal(vertices);
    let [a, b, c] = vertices.map(|p| p.as_dvec3());
    let edges = [(a, b), (b, c), (c, a)];
    let is_inside = |(from, to): (DVec3, DVec3)| (to - from).cross(point - from).dot(normal) > 0.0;
    if edges.into_iter().all(is_inside) {
        return (point - a).dot(normal).abs() / normal.length();
    }
    let to_edge = |(from, to): (DVec3, DVec3)| {
        let (along, point) = (to - from, point - from);
        // NaN where the edge has no length.
        let s = point.dot(along) / along.length_squared();
        let s = if s > 0.0 { s.min(1.0) } else { 0.0 };
        point.distance(s * along)
    };
    edges.map(to_edge).into_iter().fold(f64::INFINITY, f64::min)
}

/// The normal of the winding; its length is twice the area.
#[inline(always)]
pub(super) fn normal(vertices: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = vertices.map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VERTICES: [Vec3; 3] = [
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(5.0, 0.0, 0.0),
        Vec3::new(1.0, 2.0, 0.0),
    ];

    #[test]
    fn barycentric_weights_of_known_points() {
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.25, 0.5)] {
            let point = DVec3::new(1.0 + 4.0 * u, 2.0 * v, 0.0);
            assert_eq!(barycentric(point, VERTICES), (u, v));
        }
        assert_eq!(
            barycentric(DVec3::new(0.999, -0.001, 0.0), VERTICES),
            (0.0, 0.0)
        );
    }

    #[test]
    fn distances_to_face_edges_and_vertices() {
        for (x, y, z, distance) in [
            (2.0, 0.5, 3.0, 3.0),
            (2.0, 0.5, -0.25, 0.25),
            (2.0, 0.5, 0.0, 0.0),
            (3.0, -3.0, 4.0, 5.0),
            (-2.0, 1.0, 4.0, 5.0),
            (4.0, 3.0, 0.0, 5.0_f64.sqrt()),
            (9.0, 0.0, 3.0, 5.0),
            (1.0, 6.0, 3.0, 5.0),
            (0.0, -1.0, 0.0, 2.0_f64.sqrt()),
        ] {
            let found = distance_to_triangle(DVec3::new(x, y, z), VERTICES);
            assert!((found - distance).abs() < 1e-15, "{found} at {x} {y} {z}");
        }
    }

    #[test]
    fn triangles_without_area_have_a_distance() {
        let [a, b, _] = VERTICES;
        let point = DVec3::new(1.0, 3.0, 4.0);
        assert_eq!(distance_to_triangle(point, [a; 3]), 5.0);
        assert_eq!(distance_to_triangle(point, [a, b, a]), 5.0);
        assert_eq!(distance_to_triangle(point, [b, a, a.lerp(b, 0.5)]), 5.0);
    }

    /// No point of it is nearer, and one of many is almost as near.
    #[test]
    fn distances_are_those_of_the_nearest_point() {
        let mut random = crate::sampling::Random::new(5);
        for _ in 0..50 {
            let vertices = random.triangle(1.0, 1.0);
            let [a, b, c] = vertices.map(|p| p.as_dvec3());
            let point = 2.0 * random.point();
            let found = distance_to_triangle(point, vertices);
            let mut least = f64::INFINITY;
            for i in 0..=100 {
                for j in 0..=100 - i {
                    let (u, v) = (0.01 * f64::from(i), 0.01 * f64::from(j));
                    least = least.min(point.distance(a + u * (b - a) + v * (c - a)));
                }
            }
            assert!(
                found <= least + 1e-12 && found > least - 0.03,
                "{found} {least}"
            );
        }
    }
}
