//! Triangles in double precision: plane intersection, barycentric coordinates and closest points.

use glam::{DVec3, Vec3};

/// Intersects lines with a triangle that they are known to pass through: in double precision, where the rounding
/// of a few operations on single-precision vertices is negligible.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePlane {
    point: DVec3,
    normal: DVec3,
    /// The triangle's box.
    min: DVec3,
    max: DVec3,
}

impl TrianglePlane {
    /// The plane through three vertices.
    #[inline(always)]
    pub fn through([a, b, c]: [Vec3; 3]) -> TrianglePlane {
        TrianglePlane {
            point: a.as_dvec3(),
            normal: normal([a, b, c]),
            min: a.min(b).min(c).as_dvec3(),
            max: a.max(b).max(c).as_dvec3(),
        }
    }

    /// The parameter at which a line meets the plane. Not finite for a line in the plane.
    #[inline(always)]
    pub fn ray_parameter(&self, origin: DVec3, direction: DVec3) -> f64 {
        self.normal.dot(self.point - origin) / self.normal.dot(direction)
    }

    /// How far a point is outside the triangle's box along the axis where it is farthest; not above 0
    /// for a point inside.
    #[inline(always)]
    pub fn distance_outside_box(&self, point: DVec3) -> f64 {
        let (below, above) = (self.min - point, point - self.max);
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let x = larger(below.x, above.x);
        let y = larger(below.y, above.y);
        larger(larger(below.z, above.z), larger(x, y))
    }

    /// The largest absolute coordinate of the triangle.
    pub fn magnitude(&self) -> f64 {
        self.max.max(-self.min).max_element()
    }

    /// The parameter nearest to `t` at which the line is inside the triangle's box, padded on all sides; NaN if
    /// the line misses that box.
    ///
    /// It replaces a `t` whose point is outside, so that hits do not depend on which boxes of a tree are visited
    /// in which order, however steep the plane.
    #[cold]
    #[inline(never)]
    pub fn clamp_to_box(&self, origin: DVec3, direction: DVec3, padding: f64, t: f64) -> f64 {
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let inverse = 1.0 / direction[axis];
            let low = (self.min[axis] - padding - origin[axis]) * inverse;
            let high = (self.max[axis] + padding - origin[axis]) * inverse;
            // A line in the plane of a box's side gives NaN, which `min` and `max` ignore.
            near = near.max(low.min(high));
            far = far.min(low.max(high));
        }
        if near <= far && t.is_finite() {
            t.clamp(near, far)
        } else {
            f64::NAN
        }
    }
}

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

    fn distance(origin: Vec3, direction: Vec3) -> f64 {
        let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3());
        let plane = TrianglePlane::through(VERTICES);
        let t = plane.ray_parameter(origin, direction);
        if plane.distance_outside_box(origin + t * direction) <= 1e-6 {
            t
        } else {
            plane.clamp_to_box(origin, direction, 1e-6, t)
        }
    }

    #[test]
    fn distance_to_the_plane_in_lengths_of_the_direction() {
        let down = Vec3::new(0.0, 0.0, -0.5);
        assert_eq!(distance(Vec3::new(2.0, 0.5, 3.0), down), 6.0);
        assert_eq!(distance(Vec3::new(2.0, 0.5, -3.0), down), -6.0);
        assert!(distance(Vec3::new(2.0, 0.5, 0.0), Vec3::X).is_nan());
    }

    #[test]
    fn only_lines_through_the_box_meet_the_triangle() {
        let down = Vec3::new(0.0, 0.0, -0.5);
        assert!(distance(Vec3::new(0.9, 0.5, 3.0), down).is_nan());
        assert!(distance(Vec3::new(2.0, 2.1, 3.0), down).is_nan());
        // On the side of the box.
        assert_eq!(distance(Vec3::new(1.0, 0.5, 3.0), down), 6.0);
        // Past the vertex at (5, 0, 0), in the box all the same; and so steep that the plane is met
        // only far behind it: there it leaves the grown box.
        assert_eq!(distance(Vec3::new(5.0, 2.0, 3.0), down), 6.0);
        let steep = distance(Vec3::new(0.0, 0.5, 5e-7), Vec3::new(1.0, 0.0, -1e-9));
        assert!((steep - 5.0).abs() < 1e-5, "{steep}");
    }
}
