//! Closed bodies: triangles that leave no gap, and whether a point is inside.

use crate::math::Aabb;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// A connected surface each edge of which belongs to two triangles, wherever they are from. It separates the points
/// inside from those outside.
pub(super) struct ClosedBody {
    /// The numbers of its triangles, rising.
    pub(super) triangles: Vec<u32>,
    bounds: Aabb,
}

/// The closed bodies of a scene, in the order of their first triangles.
pub(super) fn closed_bodies(scene: &Scene) -> Vec<ClosedBody> {
    let count = scene.triangle_count();
    let mut numbers: HashMap<[u32; 3], u64> = HashMap::with_capacity(count / 2);
    // Edges by the numbers of their ends, with their triangles.
    let mut edges: Vec<([u64; 2], usize)> = Vec::with_capacity(3 * count);
    for triangle in 0..count {
        let ends = scene.triangle_vertices(triangle).map(|vertex| {
            let next = numbers.len() as u64;
            // Without the sign of 0.
            let bits = (vertex + 0.0).to_array().map(f32::to_bits);
            *numbers.entry(bits).or_insert(next)
        });
        for i in 0..3 {
            let (a, b) = (ends[i], ends[(i + 1) % 3]);
            edges.push(([a.min(b), a.max(b)], triangle));
        }
    }
    edges.par_sort_unstable();
    let mut surfaces = DisjointSets((0..count).collect());
    let mut open = Vec::new();
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        edge.windows(2)
            .for_each(|pair| surfaces.join(pair[0].1, pair[1].1));
        if edge.len() != 2 {
            open.push(edge[0].1);
        }
    }
    let mut is_open = vec![false; count];
    for triangle in open {
        is_open[surfaces.root(triangle)] = true;
    }
    let mut bodies: Vec<ClosedBody> = Vec::new();
    let mut of_root = HashMap::new();
    for triangle in 0..count {
        let root = surfaces.root(triangle);
        if is_open[root] {
            continue;
        }
        let number = *of_root.entry(root).or_insert_with(|| {
            bodies.push(ClosedBody {
                triangles: Vec::new(),
                bounds: Aabb::EMPTY,
            });
            bodies.len() - 1
        });
        let body = &mut bodies[number];
        body.triangles.push(triangle as u32);
        for vertex in scene.triangle_vertices(triangle) {
            body.bounds.min = body.bounds.min.min(vertex);
            body.bounds.max = body.bounds.max.max(vertex);
        }
    }
    bodies
}

impl ClosedBody {
    /// Whether a point in scene space is inside: an odd number of triangles is in each of some directions. None if
    /// these disagree, as they may within rounding of the surface.
    pub(super) fn contains(&self, scene: &Scene, point: DVec3) -> Option<bool> {
        let [min, max] = [self.bounds.min, self.bounds.max].map(Vec3::as_dvec3);
        if point.cmplt(min).any() || point.cmpgt(max).any() {
            return Some(false);
        }
        /// None along an axis or a diagonal, where edges are.
        const DIRECTIONS: [DVec3; 3] = [
            DVec3::new(0.537, 0.612, 0.581),
            DVec3::new(-0.829, 0.313, 0.463),
            DVec3::new(0.271, -0.917, -0.293),
        ];
        let is_odd = DIRECTIONS.map(|direction| {
            let triangles = self.triangles.iter();
            let crossed = triangles.filter(|&&triangle| {
                crosses(point, direction, scene.triangle_vertices(triangle as usize))
            });
            crossed.count() % 2 == 1
        });
        (is_odd[0] == is_odd[1] && is_odd[1] == is_odd[2]).then_some(is_odd[0])
    }
}

/// Whether a ray crosses a triangle, by the signs of volumes (Segura and Feito 2001, "Algorithms to test ray-triangle
/// intersection").
fn crosses(origin: DVec3, direction: DVec3, vertices: [Vec3; 3]) -> bool {
    let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3() - origin);
    let side = |p: DVec3, q: DVec3| direction.dot(p.cross(q)) > 0.0;
    let front = side(a, b);
    let normal = (b - a).cross(c - a);
    side(b, c) == front
        && side(c, a) == front
        && (normal.dot(a) > 0.0) == (normal.dot(direction) > 0.0)
}

/// Disjoint sets of numbers (Tarjan 1975): each number leads to another of its set, the root to itself.
struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn root(&mut self, mut number: usize) -> usize {
        while self.0[number] != number {
            self.0[number] = self.0[self.0[number]];
            number = self.0[number];
        }
        number
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The lower number is the root, so it does not depend on the order.
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, inverted, scene};
    use super::*;
    use crate::sampling::Random;

    fn pillar() -> crate::scene::SourceMesh {
        cuboid(DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0))
    }

    #[test]
    fn boxes_are_closed_and_separate_their_inside() {
        let scene = scene(vec![hall(), inverted(pillar())], &[]);
        let bodies = closed_bodies(&scene);
        assert_eq!(
            bodies.iter().map(|b| b.triangles.len()).collect::<Vec<_>>(),
            [12, 12]
        );
        let mut random = Random::new(1);
        for _ in 0..2000 {
            let point = DVec3::new(0.0, 1.5, 0.0) + 6.0 * random.point();
            let is_in = |min: DVec3, max: DVec3| point.cmpgt(min).all() && point.cmplt(max).all();
            let inside = bodies
                .iter()
                .map(|body| body.contains(&scene, point - scene.origin));
            let expected = [
                is_in(DVec3::new(-5.0, 0.0, -5.0), DVec3::new(5.0, 4.0, 5.0)),
                is_in(DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0)),
            ];
            assert_eq!(inside.collect::<Vec<_>>(), expected.map(Some), "{point}");
        }
    }

    #[test]
    fn a_body_may_be_of_many_meshes_and_one_with_a_hole_is_none() {
        let faces = |count: usize| -> Vec<_> {
            let face = |vertices: [u32; 3]| crate::scene::SourceMesh {
                triangles: vec![vertices],
                ..pillar()
            };
            pillar()
                .triangles
                .into_iter()
                .take(count)
                .map(face)
                .collect()
        };
        assert_eq!(closed_bodies(&scene(faces(12), &[])).len(), 1);
        assert_eq!(closed_bodies(&scene(faces(11), &[])).len(), 0);
        // Two that share a face are not told apart, nor are doubled faces.
        let beside = cuboid(DVec3::new(1.0, 0.0, -1.0), DVec3::new(3.0, 2.0, 1.0));
        assert_eq!(closed_bodies(&scene(vec![pillar(), beside], &[])).len(), 0);
        assert_eq!(
            closed_bodies(&scene(vec![pillar(), pillar()], &[])).len(),
            0
        );
    }
}
