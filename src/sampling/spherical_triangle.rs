//! Uniform sampling of the directions to a triangle: Arvo 1995, "Stratified Sampling of Spherical Triangles".
//!
//! Of Arvo's formulas, those for the first direction subtract angles that nearly agree where the triangle is small or
//! thin. Here both that step and the solid angle use tan(E/2) of two sides and the angle between them instead
//! (Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle"), in products of vectors.

use glam::DVec3;

/// A triangle as seen from a reference point: the part of the sphere of directions that it covers.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    /// The unit direction to the vertex between the two sides.
    a: DVec3,
    /// The unit direction to the vertex at the end of the fixed side.
    b: DVec3,
    /// The unit tangent at `a` of the great circle to the third vertex.
    tangent: DVec3,
    /// 1 + a . b.
    one_plus_cos: f64,
    /// The sine of the side a-b times the cosine and the sine of the angle at `a`.
    sin_times_cos: f64,
    sin_times_sin: f64,
    /// Half the solid angle E, in (0, pi).
    half_angle: f64,
}

impl SphericalTriangle {
    /// The triangle with these vertices relative to the reference point, in any order and at any distance.
    ///
    /// None where, to the precision of the numbers, the reference point lies in the triangle's plane or the triangle
    /// has no area; and for vertices that are not finite.
    pub fn new(mut vertices: [DVec3; 3]) -> Option<SphericalTriangle> {
        // The nearest vertex comes first: edges from it lose the least to rounding.
        let mut lengths = vertices.map(DVec3::length);
        let nearest = (0..3).min_by(|i, j| lengths[*i].total_cmp(&lengths[*j]))?;
        vertices.rotate_left(nearest);
        lengths.rotate_left(nearest);
        let [p, q, r] = vertices;
        let (side, other) = (q - p, r - p);
        let volume = p.dot(side.cross(other)).abs();
        let rounding = 4.0 * f64::EPSILON * lengths[0] * side.length() * other.length();
        if !(volume > rounding && volume.is_finite()) {
            return None;
        }
        let [a, b, c] = [p / lengths[0], q / lengths[1], r / lengths[2]];
        let sine = volume / (lengths[0] * lengths[1] * lengths[2]);
        let half_angle = libm::atan2(sine, 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let across = perpendicular(c - a, a);
        let sin_of_third = across.length();
        let triangle = SphericalTriangle {
            a,
            b,
            tangent: across / sin_of_third,
            one_plus_cos: 1.0 + a.dot(b),
            sin_times_cos: (b - a).dot(across) / sin_of_third,
            sin_times_sin: sine / sin_of_third,
            half_angle,
        };
        let valid = half_angle > 0.0 && triangle.sin_times_sin.is_finite();
        valid.then_some(triangle)
    }

    /// The solid angle, in sr: more than 0, at most 2 pi. 1 over it is the pdf of [`SphericalTriangle::sample`].
    #[inline]
    pub fn solid_angle(&self) -> f64 {
        2.0 * self.half_angle
    }

    /// A unit direction uniform in the triangle, from two numbers in 0..=1.
    pub fn sample(&self, u: f32, v: f32) -> DVec3 {
        // The point c on the side from a that cuts off the part u of the solid angle. For the length s of the way to
        // it, tan(E/2) = tan(s/2) sin(ab) sin(A) / (1 + cos(ab) + tan(s/2) sin(ab) cos(A)).
        let (sin, cos) = libm::sincos(f64::from(u) * self.half_angle);
        let rise = sin * self.one_plus_cos;
        // Rounding can pass the opposite of a, where tan(s/2) is infinite.
        let run = (cos * self.sin_times_sin - sin * self.sin_times_cos).max(0.0);
        let (rise2, run2) = (rise * rise, run * run);
        let c = ((run2 - rise2) * self.a + 2.0 * run * rise * self.tangent) / (run2 + rise2);
        // The direction on the way from b to c whose 1 - cos is the part v of that of c.
        let chord = c - self.b;
        let one_minus_cos = f64::from(v) * 0.5 * chord.length_squared();
        let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
        let tangent = perpendicular(chord, self.b).normalize_or_zero();
        ((1.0 - one_minus_cos) * self.b + sin * tangent).normalize()
    }
}

/// The part of a vector that is perpendicular to a unit axis.
fn perpendicular(vector: DVec3, axis: DVec3) -> DVec3 {
    vector - vector.dot(axis) * axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Random, SobolSequence};
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    fn solid_angle(vertices: [DVec3; 3]) -> f64 {
        SphericalTriangle::new(vertices)
            .expect("a triangle")
            .solid_angle()
    }

    /// Triangles as seen from the origin: ordinary, of 1e-4 sr, slivers, nearly edge-on from outside and from above
    /// the inside, a side and a vertex, with angles near 0 and pi, and with sides near pi.
    fn shapes() -> Vec<[DVec3; 3]> {
        let v = DVec3::new;
        let flat = |h: f64, x: f64, z: f64| {
            [
                v(-1.0 - x, h, -1.0 - z),
                v(2.0 - x, h, -1.0 - z),
                v(-1.0 - x, h, 3.0 - z),
            ]
        };
        let mut shapes = vec![
            [DVec3::X, DVec3::Y, DVec3::Z],
            [v(3.0, 0.1, 0.0), v(-1.0, 2.0, 0.5), v(0.3, -0.4, 9.0)],
            [v(0.0, 0.0, 1.0), v(0.0143, 0.0, 1.0), v(0.0, 0.0143, 1.0)],
            [v(-1.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.5, 1e-4, 1.0)],
            [v(-1e4, 0.0, 1.0), v(1e4, 0.0, 1.0), v(0.0, 1.0, 1.0)],
            [v(-1e3, 1e-4, 0.0), v(1e3, 1e-4, 0.0), v(0.0, 1e-4, 1.0)],
            [v(1e-4, 1e-4, 0.0), v(1e4, 3.0, -1e4), v(1e4, 5.0, 2e4)],
            [v(1e-3, 1.0, 2e-3), v(1e3, 3.0, -1e3), v(1e3, 5.0, 2e3)],
        ];
        for h in [1e-4, 0.01, 1.0] {
            shapes.push(flat(h, 0.0, 0.0));
            for (x, z) in [
                (2.1, 0.0),
                (-3.0, 0.5),
                (-0.9999, 0.5),
                (-1.0, -1.0),
                (0.5, 1.0),
                (0.0, -1.0),
                (7.0, -5.0),
            ] {
                shapes.push(flat(h, x, z));
            }
        }
        shapes
    }

    /// How far, in sines, a direction is outside the cone of a triangle: the largest of three planes.
    fn outside([a, b, c]: [DVec3; 3], direction: DVec3) -> f64 {
        let turn = a.dot((b - a).cross(c - a)).signum();
        [(a, b), (b, c), (c, a)]
            .map(|(p, q)| -turn * p.cross(q).normalize().dot(direction))
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn solid_angles_in_closed_form() {
        let octant = solid_angle([DVec3::X * 5.0, DVec3::Y, DVec3::Z * 1e-3]);
        assert!((octant - FRAC_PI_2).abs() < 1e-15);
        let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        let halves = [
            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)],
            [corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        ];
        let face: f64 = halves.into_iter().map(solid_angle).sum();
        assert!((face - 4.0 * PI / 6.0).abs() < 1e-14);
        // Small triangles, also nearly edge-on, of vertices without rounding: area times cosine over distance^2.
        for size in [14, 20, 30].map(|bits| 1.0 / f64::from(1 << bits)) {
            for height in [1.0, 1.0 / 1024.0] {
                let centre = DVec3::new(3.0, height, -2.0);
                let vertices = [
                    DVec3::new(2.0, 0.0, -1.0),
                    DVec3::new(-1.0, 0.0, 2.0),
                    DVec3::new(-1.0, 0.0, -1.0),
                ]
                .map(|d| centre + size * d);
                let expected = 4.5 * size * size * height / centre.length().powi(3);
                let relative = solid_angle(vertices) / expected - 1.0;
                assert!(relative.abs() < 2.0 * size * size + 1e-9, "{relative}");
            }
        }
        // A plane seen from just above it.
        let plane = [
            DVec3::new(-3.0, 1e-6, -2.0),
            DVec3::new(3.0, 1e-6, -2.0),
            DVec3::new(0.0, 1e-6, 4.0),
        ];
        assert!((TAU - 1e-5..TAU).contains(&solid_angle(plane)));
        // Whatever the order of the vertices, and as the sum of parts.
        for [a, b, c] in shapes() {
            let whole = solid_angle([a, b, c]);
            let middle = (a + b + c) / 3.0;
            let parts = solid_angle([a, b, middle])
                + solid_angle([b, c, middle])
                + solid_angle([c, a, middle]);
            assert!((parts / whole - 1.0).abs() < 1e-9, "{whole}");
            assert!((solid_angle([c, b, a]) / whole - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn none_without_a_solid_angle() {
        let v = DVec3::new;
        for vertices in [
            [DVec3::X, DVec3::Y, v(-1.0, -1.0, 0.0)],
            [DVec3::X, DVec3::Y, v(3.0, 1.0, 0.0)],
            [
                v(0.1, 0.2, 0.3),
                v(0.3, 0.1, 0.7),
                v(0.1, 0.2, 0.3) - v(0.3, 0.1, 0.7) * 0.3,
            ],
            [DVec3::ZERO, DVec3::Y, DVec3::Z],
            [DVec3::X, DVec3::X, DVec3::Z],
            [DVec3::X, DVec3::Y, 0.3 * DVec3::X + 0.7 * DVec3::Y],
            [DVec3::X, DVec3::Y, DVec3::NAN],
            [DVec3::X, DVec3::Y, DVec3::Z * f64::INFINITY],
        ] {
            assert!(SphericalTriangle::new(vertices).is_none(), "{vertices:?}");
        }
    }

    /// Parts of a triangle, large and small, get as many samples as their solid angles say, and nothing else gets any.
    #[test]
    fn samples_are_uniform() {
        let sequence = SobolSequence::new(0, 0, 0, 0);
        let count = 1 << 13;
        for (pair, vertices) in shapes().into_iter().enumerate() {
            let triangle = SphericalTriangle::new(vertices).expect("a triangle");
            let [a, b, c] = vertices;
            for weights in [
                (1.0, 1.0, 1.0),
                (10.0, 1.0, 1.0),
                (1.0, 30.0, 1.0),
                (1.0, 1.0, 100.0),
            ] {
                let (x, y, z) = weights;
                let middle = (x * a + y * b + z * c) / (x + y + z);
                let parts = [[a, b, middle], [b, c, middle], [c, a, middle]];
                let mut hits = [0; 3];
                for i in 0..count {
                    let [u, v] = sequence.sample_2d(i, pair as u32);
                    let direction = triangle.sample(u, v);
                    assert!((direction.length() - 1.0).abs() < 1e-14);
                    assert!(
                        outside(vertices, direction) < 1e-9,
                        "{vertices:?} {}",
                        outside(vertices, direction)
                    );
                    let depths = parts.map(|part| outside(part, direction));
                    let nearest = (0..3).min_by(|i, j| depths[*i].total_cmp(&depths[*j]));
                    hits[nearest.expect("three")] += 1;
                }
                for (part, hits) in parts.into_iter().zip(hits) {
                    let share = solid_angle(part) / triangle.solid_angle();
                    let found = f64::from(hits) / f64::from(count);
                    // Random points would have a standard deviation of up to 0.0055.
                    assert!(
                        (found - share).abs() < 0.002,
                        "{vertices:?}: {found} {share}"
                    );
                }
            }
        }
    }

    #[test]
    fn extreme_numbers_and_shapes_stay_inside() {
        let ends = [0.0, 1e-7, 0.5, 1.0 - 1e-7, 1.0];
        let mut random = Random::new(7);
        let mut triangles = shapes();
        for _ in 0..20_000 {
            let size = libm::exp10(-8.0 * f64::from(random.unit()));
            let flat = DVec3::new(1.0, libm::exp10(-4.0 * f64::from(random.unit())), 1.0);
            let first = random.point();
            triangles.push(
                [
                    first,
                    first + size * random.point(),
                    first + size * random.point(),
                ]
                .map(|p| flat * p),
            );
        }
        for vertices in triangles {
            let Some(triangle) = SphericalTriangle::new(vertices) else {
                continue;
            };
            assert!(triangle.solid_angle() > 0.0 && triangle.solid_angle() <= TAU);
            for u in ends {
                for v in ends {
                    let direction = triangle.sample(u, v);
                    assert!((direction.length() - 1.0).abs() < 1e-14);
                    assert!(
                        outside(vertices, direction) < 1e-6,
                        "{vertices:?}, {u}, {v}: {}",
                        outside(vertices, direction)
                    );
                }
            }
        }
    }
}
