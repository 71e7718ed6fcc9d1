//! Queries about the nearest of all primitives, and the plainest of them: the distance from a point to the nearest surface.

use super::bvh::Bvh;
use super::node::{Child, ROOT};
use crate::geometry::{Sphere, distance_to_triangle};
use crate::math::Aabb;
use glam::{DVec3, Vec3};

/// What is asked about a point: lower bounds of a distance, infinite where it does not count.
pub(super) trait PointQuery {
    /// For all that is in a box. Called with infinite bounds where a node has no child.
    fn box_distance(&self, bounds: &Aabb) -> f64;
    /// For a triangle.
    fn triangle_distance(&self, vertices: [Vec3; 3]) -> f64;
    /// For a sphere.
    fn sphere_distance(&self, sphere: &Sphere) -> f64;
}

impl Bvh {
    /// The distance from a point to the closest point of any primitive's surface, from inside a sphere as well
    /// as from outside, or none if it is not below `within`. In double precision; it does not depend on the
    /// tree.
    pub fn closest_point_distance(&self, point: DVec3, within: f64) -> Option<f64> {
        self.nearest(&ClosestPoint(point), within)
    }

    /// The least distance of a query over all primitives, or none if it is not below `within`.
    pub(super) fn nearest(&self, query: &impl PointQuery, within: f64) -> Option<f64> {
        let mut nearest = within;
        if self.nodes.is_empty() {
            for block in 0..self.blocks.len() {
                nearest = nearest.min(self.block_distance(block, query));
            }
            for sphere in &self.spheres {
                nearest = nearest.min(query.sphere_distance(sphere));
            }
            return (nearest < within).then_some(nearest);
        }
        // Children still to be visited, with lower bounds of their distances.
        let mut stack = vec![(0.0, ROOT)];
        while let Some((bound, child)) = stack.pop() {
            if bound >= nearest {
                continue;
            }
            match Child::unpack(child) {
                Child::Node(index) => {
                    let node = &self.nodes[index as usize];
                    let first = stack.len();
                    for (lane, child) in node.children.into_iter().enumerate() {
                        let bound = query.box_distance(&node.bounds(lane));
                        if bound < nearest {
                            stack.push((bound, child));
                        }
                    }
                    // The nearest is visited first, so most of the others are culled.
                    stack[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
                }
                Child::Triangles(index) => {
                    nearest = nearest.min(self.block_distance(index as usize, query));
                }
                Child::Sphere(index) => {
                    nearest = nearest.min(query.sphere_distance(&self.spheres[index as usize]));
                }
            }
        }
        (nearest < within).then_some(nearest)
    }

    fn block_distance(&self, index: usize, query: &impl PointQuery) -> f64 {
        let block = &self.blocks[index];
        let distances =
            (0..block.count()).map(|lane| query.triangle_distance(block.triangle(lane)));
        distances.fold(f64::INFINITY, f64::min)
    }
}

/// The distance from a point to a box; infinite if that has no extent.
pub(super) fn distance_to_box(point: DVec3, bounds: &Aabb) -> f64 {
    let below = bounds.min.as_dvec3() - point;
    let above = point - bounds.max.as_dvec3();
    below.max(above).max(DVec3::ZERO).length()
}

/// The distance from a point.
struct ClosestPoint(DVec3);

impl PointQuery for ClosestPoint {
    fn box_distance(&self, bounds: &Aabb) -> f64 {
        distance_to_box(self.0, bounds)
    }

    fn triangle_distance(&self, vertices: [Vec3; 3]) -> f64 {
        distance_to_triangle(self.0, vertices)
    }

    fn sphere_distance(&self, sphere: &Sphere) -> f64 {
        sphere.distance(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;
    use crate::simd::Kernel;

    /// One after the other, in no order.
    fn brute_force(triangles: &[[Vec3; 3]], spheres: &[Sphere], point: DVec3) -> f64 {
        let of_triangles = triangles.iter().map(|t| distance_to_triangle(point, *t));
        let of_spheres = spheres.iter().map(|s| s.distance(point));
        of_triangles.chain(of_spheres).fold(f64::INFINITY, f64::min)
    }

    fn check(triangles: &[[Vec3; 3]], spheres: &[Sphere], points: &[DVec3]) {
        let bvh = Bvh::new(triangles, spheres.to_vec(), Kernel::default());
        for point in points {
            let expected = brute_force(triangles, spheres, *point);
            let found = bvh.closest_point_distance(*point, f64::INFINITY);
            assert_eq!(found.is_some(), expected.is_finite(), "{point}");
            let Some(found) = found else { continue };
            // The vertices of a triangle are in another order in the tree.
            let size = f64::from(bvh.magnitude).max(point.abs().max_element());
            let error = (found - expected).abs();
            assert!(error <= 8.0 * f64::EPSILON * size, "{found} {expected}");
            assert_eq!(bvh.closest_point_distance(*point, found), None);
            let within = 1.5 * found + 1e-9;
            assert_eq!(bvh.closest_point_distance(*point, within), Some(found));
        }
    }

    #[test]
    fn agrees_with_brute_force_with_and_without_a_tree() {
        let mut random = Random::new(3);
        for (triangle_count, sphere_count) in [(0, 0), (1, 0), (0, 1), (9, 2), (300, 40), (4000, 0)]
        {
            let triangles: Vec<[Vec3; 3]> = (0..triangle_count)
                .map(|_| random.triangle(10.0, 2.0))
                .collect();
            let spheres: Vec<Sphere> = (0..sphere_count)
                .map(|_| Sphere::new(10.0 * random.point(), 0.01 + f64::from(random.unit())))
                .collect();
            let points: Vec<DVec3> = (0..500)
                .map(|i| [1.0, 12.0, 1e6][i % 3] * random.point())
                .collect();
            check(&triangles, &spheres, &points);
        }
    }

    #[test]
    fn hostile_shapes_change_nothing() {
        let mut random = Random::new(4);
        for kind in 0..4 {
            let triangles: Vec<[Vec3; 3]> = (0..200)
                .map(|_| {
                    let [a, b, c] = random.triangle(1.0, 0.3);
                    match kind {
                        // Points, needles, coincident, far from the origin.
                        0 => [a, a, a],
                        1 => [a, b, a.lerp(b, 0.5)],
                        2 => [Vec3::ZERO, Vec3::X, Vec3::Y],
                        _ => [a, b, c].map(|p| 1e5 + p),
                    }
                })
                .collect();
            let mut points: Vec<DVec3> = (0..200).map(|_| 2.0 * random.point()).collect();
            points.extend(triangles.iter().map(|vertices| vertices[1].as_dvec3()));
            check(&triangles, &[], &points);
        }
    }

    #[test]
    fn a_sphere_is_as_near_from_inside() {
        let spheres = vec![Sphere::new(DVec3::X, 2.0)];
        let bvh = Bvh::new(&[], spheres, Kernel::default());
        for (x, distance) in [(0.5, 1.5), (1.0, 2.0), (3.5, 0.5), (3.0, 0.0)] {
            let point = DVec3::new(x, 0.0, 0.0);
            assert_eq!(bvh.closest_point_distance(point, 10.0), Some(distance));
        }
        assert_eq!(bvh.closest_point_distance(DVec3::ONE, 0.5), None);
    }
}
