//! Degenerate triangles: edge on, slivers, coincident, without area.

use super::fixtures::{first_hits, ray_in, sine, worse};
use super::shapes::Polyhedron;
use crate::accel::{Bvh, QueryState};
use crate::geometry::{Mesh, Transform};
use crate::material::{FeatureMask, Material};
use crate::math::Ray;
use crate::sampling::Random;
use crate::scene::SceneBuilder;
use crate::simd::Kernel;
use glam::{DVec3, Vec3};

/// Rays in a triangle's plane, some along its edges, all with integer coordinates and so exact; and rays to triangles
/// whose vertices coincide or are collinear: none of them hits anything.
pub(super) fn edge_on(kernel: Kernel) -> f64 {
    let mut random = Random::new(2);
    let mut query_state = QueryState::default();
    let mut hits = 0;
    for _ in 0..2000 {
        let mut integers = || DVec3::from_array([0; 3].map(|_| random.whole(9) as f64));
        let (vertex, u, v) = (integers(), integers(), integers());
        let triangle = Bvh::new(
            &[[vertex, vertex + u, vertex + v].map(|p| p.as_vec3())],
            vec![],
            kernel,
        );
        let collinear = Bvh::new(
            &[[vertex, vertex + u, vertex + 3.0 * u].map(|p| p.as_vec3())],
            vec![],
            kernel,
        );
        for (i, j) in [(1, 0), (0, 1), (-1, 1), (1, 1), (2, -5), (-3, 2)] {
            let direction = f64::from(i) * u + f64::from(j) * v;
            if direction == DVec3::ZERO {
                continue;
            }
            for bvh in [&triangle, &collinear] {
                for start in [
                    vertex,
                    vertex - 2.0 * direction,
                    vertex + u - 3.0 * direction,
                ] {
                    let ray = Ray::new(start.as_vec3(), direction.as_vec3());
                    hits += usize::from(bvh.closest(&ray, &mut query_state).is_some());
                }
            }
        }
        for _ in 0..10 {
            let start = vertex + 20.0 * random.point();
            let target = vertex + f64::from(3.0 * random.unit()) * u;
            let ray = Ray::new(start.as_vec3(), (target - start).as_vec3());
            hits += usize::from(collinear.closest(&ray, &mut query_state).is_some());
        }
    }
    hits as f64
}

/// A square crossed by a sliver of 1 to 1e-7, at several scales, axis-aligned or rotated: rays to the sliver and just
/// beside it hit something.
pub(super) fn slivers(kernel: Kernel) -> f64 {
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let strip = Polyhedron {
        vertices: vec![
            at(0.0, 0.0),
            at(1.0, 0.0),
            at(1.0, 1e-7),
            at(1.0, 0.5),
            at(0.0, 0.5),
            at(0.0, -0.5),
            at(1.0, -0.5),
        ],
        faces: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [5, 6, 1], [5, 1, 0]],
    };
    let mut random = Random::new(3);
    let mut query_state = QueryState::default();
    let mut misses = 0;
    for scale in [1e-6, 1.0, 1e6] {
        for angle in [0.0, 0.7] {
            let transform = Transform::new(DVec3::splat(scale), DVec3::splat(angle), DVec3::ZERO);
            let bvh = Bvh::new(
                &strip.moved(|p| transform.point(p)).triangles(),
                vec![],
                kernel,
            );
            for i in 0..5000 {
                let width = [1e-8, 1e-7, 1e-6, 0.4][i % 4];
                let target = at(
                    0.01 + 0.98 * f64::from(random.unit()),
                    width * random.point().y,
                );
                let start = target + random.point() + 1.5 * DVec3::Z;
                let [start, target] = [start, target].map(|p| transform.point(p).as_vec3());
                let ray = Ray::new(start, target - start);
                misses += usize::from(bvh.closest(&ray, &mut query_state).is_none());
            }
        }
    }
    misses as f64
}

/// Long triangles with integer vertices, whose exact normals are integers, too. Single precision keeps a unit vector
/// to 6e-8 in each coordinate.
pub(super) fn sliver_normals(_: Kernel) -> f64 {
    let mut random = Random::new(4);
    let mut worst: f64 = 0.0;
    for _ in 0..20_000 {
        let mut integers = |size: i64| [0; 3].map(|_| random.whole(size));
        let (a, long, short) = (integers(1 << 20), integers(1 << 22), integers(2));
        let b: [i64; 3] = std::array::from_fn(|i| a[i] + long[i]);
        let c: [i64; 3] = std::array::from_fn(|i| a[i] + long[i] / 2 + short[i]);
        let [u, v] = [b, c].map(|p| -> [i128; 3] { std::array::from_fn(|i| (p[i] - a[i]).into()) });
        let exact =
            DVec3::from_array([0, 1, 2].map(|i| {
                (u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]) as f64
            }));
        let mesh = Mesh {
            positions: [a, b, c]
                .map(|p| Vec3::from_array(p.map(|x| x as f32)))
                .to_vec(),
            ..Mesh::default()
        };
        worst = worse(
            worst,
            match mesh.geometric_normal([0, 1, 2]) {
                Some(normal) => sine(normal, exact),
                None => f64::from(u8::from(exact != DVec3::ZERO)),
            },
        );
    }
    worst
}

/// Of a hundred thousand equal triangles, their vertices in any order, the first is hit. So is the first of two
/// triangles of 1 to 1000 m, from 2 m away.
pub(super) fn coincident(kernel: Kernel) -> f64 {
    let vertices = [
        Vec3::new(-1.1, -0.9, -2.3),
        Vec3::new(1.2, -1.0, -1.9),
        Vec3::new(0.1, 1.0, -2.0),
    ];
    let mut random = Random::new(6);
    let mut query_state = QueryState::default();
    let mut others = 0;
    for (count, size, rays) in [
        (100_000, 1.0, 10),
        (2, 1.0, 20_000),
        (2, 30.0, 20_000),
        (2, 1000.0, 20_000),
    ] {
        let [a, b, c] = vertices.map(|vertex| vertex * size);
        let orders = [[a, b, c], [b, c, a], [c, b, a], [a, c, b]];
        let triangles: Vec<_> = (0..count).map(|i| orders[i % 4]).collect();
        let bvh = Bvh::new(&triangles, vec![], kernel);
        for _ in 0..rays {
            let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
            let target = a + u * (b - a) + v * (c - a);
            let origin = target + 2.0 * (random.vector(0.5) + Vec3::Z).normalize();
            let mut ray = Ray::new(origin, target - origin);
            for expected in [0, 1] {
                let first = bvh.closest(&ray, &mut query_state).map(|hit| hit.primitive);
                others += usize::from(first != Some(expected));
                ray.exclude = 0;
            }
        }
    }
    others as f64
}

/// Triangles without area are dropped and counted; others are kept, however small. A vertex without a normal gets the
/// triangle's.
pub(super) fn without_area(kernel: Kernel) -> f64 {
    let mesh = Polyhedron {
        vertices: vec![
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            0.5 * DVec3::X,
            1e-25 * DVec3::X,
            1e-25 * DVec3::Y,
        ],
        faces: vec![
            [0, 1, 2],
            [0, 0, 2],
            [0, 1, 3],
            [2, 2, 2],
            [0, 4, 5],
            [1, 2, 1],
        ],
    };
    let mut source = mesh.mesh(0);
    source.normals = vec![Vec3::ZERO; source.positions.len()];
    let builder = SceneBuilder {
        materials: vec![Material::lambert(Vec3::ONE)],
        meshes: vec![source],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, dropped) = builder.build();
    let mut wrong = dropped.abs_diff(4) + scene.triangle_count().abs_diff(2);
    let ray = ray_in(&scene, DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z);
    match first_hits(&scene, &[ray])[0] {
        Some(hit) => {
            let normal = scene
                .surface::<FeatureMask<0>>(&ray, &hit)
                .point
                .shading_normal;
            wrong += usize::from(normal != Vec3::Z);
        }
        None => wrong += 1,
    }
    wrong as f64
}
