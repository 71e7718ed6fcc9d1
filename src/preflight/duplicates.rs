//! Shapes that are in the scene twice: triangles of the same vertices, spheres of the same centre and radius.

use super::SceneWarning;
use crate::geometry::Sphere;
use crate::scene::{Scene, SceneNames};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Triangles that a model has twice, of the same material, are left out: many have such, and they change no picture.
pub(super) fn find(scene: &Scene, names: &SceneNames) -> Vec<SceneWarning> {
    let mut triangles = repeated_triangles(scene);
    triangles.retain(|pair| {
        let [a, b] = pair.map(|triangle| scene.mesh_of(triangle));
        names.object(a) != names.object(b) || scene.mesh_material(a) != scene.mesh_material(b)
    });
    let spheres = repeated_spheres(scene);
    let count = triangles.len() + spheres.len();
    let warning = match (triangles.first(), spheres.first()) {
        (Some(&[first, again]), _) => {
            let [a, b, c] = scene.triangle_vertices(again).map(Vec3::as_dvec3);
            SceneWarning::Duplicates {
                count,
                shape: "a triangle",
                objects: [again, first].map(|triangle| names.mesh(scene.mesh_of(triangle))),
                position: scene.origin + (a + b + c) / 3.0,
            }
        }
        (None, Some(&[first, again])) => SceneWarning::Duplicates {
            count,
            shape: "a sphere",
            objects: [again, first].map(|sphere| names.sphere(sphere)),
            position: scene.origin + scene.spheres()[again].center,
        },
        (None, None) => return Vec::new(),
    };
    vec![warning]
}

/// The vertices of a triangle in an order that does not depend on its winding.
fn sorted_vertices(scene: &Scene, triangle: usize) -> [[u32; 3]; 3] {
    // Without the sign of 0.
    let bits = |vertex: Vec3| (vertex + 0.0).to_array().map(f32::to_bits);
    let mut vertices = scene.triangle_vertices(triangle).map(bits);
    vertices.sort_unstable();
    vertices
}

/// Triangles that repeat an earlier one, each after the first of its kind; rising.
pub(super) fn repeated_triangles(scene: &Scene) -> Vec<[usize; 2]> {
    let hash = |triangle: usize| {
        let mut hasher = DefaultHasher::new();
        sorted_vertices(scene, triangle).hash(&mut hasher);
        (hasher.finish(), triangle)
    };
    let triangles = (0..scene.triangle_count()).into_par_iter();
    let mut hashes: Vec<(u64, usize)> = triangles.map(hash).collect();
    hashes.par_sort_unstable();
    let mut repeated = Vec::new();
    for equal in hashes
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|equal| equal.len() > 1)
    {
        let mut first = HashMap::new();
        for &(_, triangle) in equal {
            let first = *first
                .entry(sorted_vertices(scene, triangle))
                .or_insert(triangle);
            if first != triangle {
                repeated.push([first, triangle]);
            }
        }
    }
    repeated.sort_unstable_by_key(|pair| pair[1]);
    repeated
}

/// The same of spheres.
fn repeated_spheres(scene: &Scene) -> Vec<[usize; 2]> {
    let mut first = HashMap::new();
    let spheres = scene.spheres().iter().enumerate();
    let mut repeated_of = |(number, sphere): (usize, &Sphere)| {
        let DVec3 { x, y, z } = sphere.center + 0.0;
        let bits = [x, y, z, sphere.radius].map(f64::to_bits);
        let first = *first.entry(bits).or_insert(number);
        (first != number).then_some([first, number])
    };
    spheres.filter_map(&mut repeated_of).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, inverted, scene};
    use super::*;

    fn found(scene: &Scene) -> Option<(usize, [String; 2])> {
        let warning = find(scene, &SceneNames::default()).pop()?;
        let SceneWarning::Duplicates { count, objects, .. } = warning else {
            panic!("{warning:?}")
        };
        Some((count, objects))
    }

    #[test]
    fn every_repeated_shape_is_counted_once() {
        let pillar = || cuboid(DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, 1.0));
        let names = |kind: &str, numbers: [usize; 2]| numbers.map(|n| format!("{kind} {n}"));
        // The same faces, whichever way they look, and whichever vertex comes first.
        let mut turned = inverted(pillar());
        turned.triangles.iter_mut().for_each(|t| t.rotate_left(1));
        for again in [pillar(), turned] {
            let meshes = vec![hall(), pillar(), again.clone(), again];
            assert_eq!(
                found(&scene(meshes, &[])),
                Some((24, names("mesh", [2, 1])))
            );
        }
        let ball = (DVec3::new(0.0, 1.0, 0.0), 0.5);
        let balls = [ball, (ball.0, 0.6), ball];
        assert_eq!(
            found(&scene(vec![], &balls)),
            Some((1, names("sphere", [2, 0])))
        );
        // A tetrahedron shares edges, and a box of the same size elsewhere nothing.
        let beside = cuboid(DVec3::new(1.0, 0.0, -1.0), DVec3::new(3.0, 2.0, 1.0));
        assert_eq!(
            found(&scene(vec![hall(), pillar(), beside], &balls[..2])),
            Some((2, names("mesh", [2, 1])))
        );
        assert_eq!(found(&scene(vec![hall(), pillar()], &balls[..2])), None);
    }
}
