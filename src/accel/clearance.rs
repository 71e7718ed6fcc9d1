//! The clearance query: how far from a surface point the nearest surface is that rises above its tangent plane.

use super::bvh::Bvh;
use super::closest_point::{PointQuery, distance_to_box};
use crate::geometry::{Sphere, distance_to_triangle};
use crate::math::Aabb;
use glam::{DVec3, Vec3};

/// The directions above a surface point that count: a cone around its normal.
#[derive(Clone, Copy, Debug)]
pub struct ClearanceCone {
    /// The point.
    pub point: DVec3,
    /// The unit normal of the surface there.
    pub normal: DVec3,
    /// The sine of the least elevation above the tangent plane, in 0..1.
    pub sine: f64,
    /// Heights above the tangent plane up to this are rounding errors.
    pub tolerance: f64,
}

impl Bvh {
    /// A lower bound of the distance from the apex of a cone to the closest point of any primitive within it, or none if
    /// that is not below `within`. So nothing in the cone is nearer; small primitives are found as large ones are.
    pub fn clearance(&self, cone: &ClearanceCone, within: f64) -> Option<f64> {
        self.nearest(cone, within)
    }
}

impl ClearanceCone {
    fn height(&self, position: DVec3) -> f64 {
        (position - self.point).dot(self.normal)
    }

    /// The least height of points of the cone that are at least this far from its apex.
    fn least_height(&self, distance: f64) -> f64 {
        self.sine * distance + self.tolerance
    }
}

impl PointQuery for ClearanceCone {
    fn box_distance(&self, bounds: &Aabb) -> f64 {
        let distance = distance_to_box(self.point, bounds);
        if distance.is_infinite() {
            return distance;
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let highest = DVec3::select(self.normal.cmpge(DVec3::ZERO), max, min);
        if self.height(highest) < self.least_height(distance) {
            f64::INFINITY
        } else {
            distance
        }
    }

    /// What lies in the cone is at least as high as its least height at the distance that is known: by clipping the
    /// triangle there the distance grows, and so does that height.
    fn triangle_distance(&self, vertices: [Vec3; 3]) -> f64 {
        const MAX_STEPS: usize = 8;
        let heights = vertices.map(|vertex| self.height(vertex.as_dvec3()));
        let highest = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let mut distance = distance_to_triangle(self.point, vertices);
        for _ in 0..MAX_STEPS {
            let least = self.least_height(distance);
            if highest < least {
                return f64::INFINITY;
            }
            let clipped = distance_above(self.point, vertices, heights, least);
            if clipped <= distance * (1.0 + 1e-3) {
                break;
            }
            distance = clipped;
        }
        distance
    }

    /// By steps over the distance: the points of a sphere at one distance are a circle, whose highest one counts.
    fn sphere_distance(&self, sphere: &Sphere) -> f64 {
        const STEPS: u32 = 64;
        let to_center = sphere.center - self.point;
        let (length, radius) = (to_center.length(), sphere.radius);
        if self.height(sphere.center) + radius <= self.tolerance {
            return f64::INFINITY;
        }
        let elevation = libm::asin((to_center.dot(self.normal) / length).clamp(-1.0, 1.0));
        let (nearest, farthest) = ((length - radius).abs(), length + radius);
        let is_in_cone = |distance: f64| {
            let cos = (distance * distance + length * length - radius * radius)
                / (2.0 * distance * length);
            let angle = libm::acos(cos.clamp(-1.0, 1.0));
            // Over the zenith and down again.
            let highest = libm::sin(elevation + angle);
            distance * highest >= self.least_height(distance)
        };
        let step = (farthest - nearest) / f64::from(STEPS);
        let at = |index: u32| nearest + f64::from(index) * step;
        // What lies between two steps counts from the first.
        let found = (0..=STEPS).find(|&index| is_in_cone(at(index)));
        found.map_or(f64::INFINITY, |index| at(index.saturating_sub(1)))
    }
}

/// The distance from a point to the part of a triangle that lies at a height or above, where the highest of the heights of
/// its vertices is.
fn distance_above(point: DVec3, vertices: [Vec3; 3], heights: [f64; 3], least: f64) -> f64 {
    let mut polygon = Vec::with_capacity(4);
    for index in 0..3 {
        let next = (index + 1) % 3;
        let (from, to) = (heights[index], heights[next]);
        if from >= least {
            polygon.push(vertices[index]);
        }
        if (from >= least) != (to >= least) {
            let part = ((least - from) / (to - from)) as f32;
            polygon.push(vertices[index].lerp(vertices[next], part));
        }
    }
    let fan = polygon.windows(2).skip(1);
    let distances = fan.map(|pair| distance_to_triangle(point, [polygon[0], pair[0], pair[1]]));
    distances.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;
    use crate::simd::Kernel;

    const SINE: f64 = 0.15;

    fn cone(point: DVec3, normal: DVec3) -> ClearanceCone {
        ClearanceCone {
            point,
            normal,
            sine: SINE,
            tolerance: 1e-9,
        }
    }

    /// No sampled point of triangles and spheres in the cone is nearer than the clearance, and some are little farther.
    #[test]
    fn nothing_in_the_cone_is_nearer() {
        let mut random = Random::new(5);
        let triangles: Vec<[Vec3; 3]> = (0..40).map(|_| random.triangle(1.0, 0.3)).collect();
        let spheres: Vec<Sphere> = (0..8)
            .map(|_| Sphere::new(random.point(), 0.05 + 0.2 * f64::from(random.unit())))
            .collect();
        let mut surface = Vec::new();
        for [a, b, c] in &triangles {
            for _ in 0..2000 {
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = if u + v > 1.0 {
                    (1.0 - u, 1.0 - v)
                } else {
                    (u, v)
                };
                surface.push((*a + u * (*b - *a) + v * (*c - *a)).as_dvec3());
            }
        }
        for sphere in &spheres {
            for _ in 0..2000 {
                let direction = random.vector(1.0).normalize().as_dvec3();
                surface.push(sphere.center + sphere.radius * direction);
            }
        }
        let bvh = Bvh::new(&triangles, spheres, Kernel::default());
        let mut tight = 0;
        for _ in 0..300 {
            let apex = random.point();
            let normal = random.vector(1.0).normalize().as_dvec3();
            let found = bvh.clearance(&cone(apex, normal), f64::INFINITY);
            let inside = surface.iter().filter_map(|position| {
                let offset = *position - apex;
                (offset.dot(normal) > SINE * offset.length() + 1e-9).then(|| offset.length())
            });
            let sampled = inside.fold(f64::INFINITY, f64::min);
            let found = found.unwrap_or(f64::INFINITY);
            assert!(found <= sampled + 1e-5, "{found} {sampled}");
            tight += u32::from(found > 0.8 * sampled);
        }
        assert!(tight > 240, "{tight}");
    }

    /// A plate does not limit its own points; a ball at height 1 is as far as its nearest point; a plate seen at a lower
    /// elevation than counts is not there.
    #[test]
    fn clearances_by_hand() {
        let plate = |y: f32, x: f32| {
            [(-1.0, 1.0), (1.0, -1.0)].map(|(a, b)| {
                [
                    Vec3::new(x + a, y, b),
                    Vec3::new(x + b, y, a),
                    Vec3::new(x + a, y, a),
                ]
            })
        };
        let up = |triangles: &[[Vec3; 3]], spheres: &[Sphere]| {
            let bvh = Bvh::new(triangles, spheres.to_vec(), Kernel::default());
            bvh.clearance(&cone(DVec3::ZERO, DVec3::Y), 100.0)
        };
        assert_eq!(up(&plate(0.0, 0.0), &[]), None);
        assert_eq!(up(&plate(-0.1, 0.0), &[]), None);
        let above = up(&plate(0.3, 0.0), &[]).expect("a plate");
        assert!((above - 0.3).abs() < 1e-6, "{above}");
        assert_eq!(up(&plate(0.3, 9.0), &[]), None);
        let ball = up(&[], &[Sphere::new(DVec3::Y, 0.25)]).expect("a ball");
        assert!((ball - 0.75).abs() < 0.02, "{ball}");
        assert_eq!(up(&[], &[Sphere::new(-DVec3::Y, 1.0)]), None);
        // From within a sphere, points at distance D have the height D^2 / 2 R.
        let within = up(&[], &[Sphere::new(DVec3::Y, 1.0)]).expect("a ball");
        assert!((0.26..=0.3).contains(&within), "{within}");
    }
}
