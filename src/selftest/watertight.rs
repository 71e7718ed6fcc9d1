//! Watertight intersection: no ray passes between triangles that share an edge or a vertex (Woop, Benthin and Wald
//! 2013).

use super::fixtures::{first_hits, sine, white_scene, worse};
use super::shapes::Polyhedron;
use crate::accel::{Bvh, DISTANCE_TOLERANCE, QueryState};
use crate::geometry::Transform;
use crate::material::FeatureMask;
use crate::math::Ray;
use crate::sampling::Random;
use crate::simd::Kernel;
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Rays through a vertex that 2 to 64 triangles share, through the edges between them, and through the poles of a
/// globe. Each hits a triangle at the distance of the vertex or edge, and at the same distance with the triangles in
/// reverse order.
pub(super) fn vertices_and_edges(kernel: Kernel) -> f64 {
    let mut random = Random::new(1);
    let mut wrong = 0;
    let mut query_state = QueryState::default();
    let mut check = |bvh: &Bvh, reversed: &Bvh, ray: &Ray, expected: f64| {
        let [one, other] = [bvh, reversed].map(|bvh| bvh.closest(ray, &mut query_state));
        let is_right = match (one, other) {
            (Some(one), Some(other)) => {
                let differs = (one.t - other.t).abs() > DISTANCE_TOLERANCE * expected;
                (one.t - expected).abs() <= 1e-6 * expected && !differs
            }
            _ => false,
        };
        wrong += usize::from(!is_right);
    };
    let both_orders = |triangles: &[[Vec3; 3]]| {
        let reversed: Vec<_> = triangles.iter().rev().copied().collect();
        (
            Bvh::new(triangles, vec![], kernel),
            Bvh::new(&reversed, vec![], kernel),
        )
    };

    let apex = Vec3::new(3.0, 5.0, -7.0);
    for valence in 2..=64_usize {
        let rim_count = valence.max(3);
        let rim_vertex = |i: usize| {
            let (sin, cos) = (TAU * (i % rim_count) as f64 / rim_count as f64).sin_cos();
            apex + DVec3::new(cos, sin, -0.25).as_vec3()
        };
        let fan: Vec<_> = (0..valence)
            .map(|i| [apex, rim_vertex(i), rim_vertex(i + 1)])
            .collect();
        let (bvh, reversed) = both_orders(&fan);
        // These rays are exact in single precision: they pass through the vertex itself, even where it is
        // on the boundary.
        for i in 0..49 {
            let (x, y) = ((i % 7) as f32 - 3.0, (i / 7) as f32 - 3.0);
            let direction = Vec3::new(x / 8.0, y / 8.0, -1.0);
            let ray = Ray::new(apex - 4.0 * direction, direction);
            check(&bvh, &reversed, &ray, 4.0);
        }
        if valence == rim_count {
            for i in 0..100 {
                let origin = apex + random.vector(1.0) + 3.0 * Vec3::Z;
                let target = apex.lerp(rim_vertex(i), [0.0, random.unit()][i % 2]);
                check(&bvh, &reversed, &Ray::new(origin, target - origin), 1.0);
            }
        }
    }

    let globe = Polyhedron::globe(64, 16).triangles();
    let (bvh, reversed) = both_orders(&globe);
    for i in 0..1000 {
        let origin = random.vector(0.5);
        let pole = [Vec3::Y, Vec3::NEG_Y][i % 2];
        check(&bvh, &reversed, &Ray::new(origin, pole - origin), 1.0);
    }
    wrong as f64
}

/// Rays from inside an icosphere to its vertices and to points of its edges: none escapes. The vertices are scaled,
/// shifted and rounded to single precision.
pub(super) fn closed_mesh(kernel: Kernel) -> f64 {
    let mesh = Polyhedron::icosphere(2);
    let mut escapes = 0;
    for (scale, shift) in [
        (1e-6, 0.0),
        (1e-3, 0.0),
        (1.0, 0.0),
        (1e3, 0.0),
        (1e6, 0.0),
        (1.0, 1e4),
        (1.0, 1e6),
        (1e3, 1e6),
        (1e6, 1e6),
    ] {
        let place = |p: DVec3| p * scale + DVec3::splat(shift);
        let triangles = mesh.moved(place).triangles();
        let bvh = Bvh::new(&triangles, vec![], kernel);
        let mut query_state = QueryState::default();
        let rays = rays_to_edges(&triangles, |p| place(p).as_vec3());
        escapes += rays
            .filter(|ray| bvh.closest(ray, &mut query_state).is_none())
            .count();
    }
    escapes as f64
}

/// As [`closed_mesh`], with scenes. They keep coordinates relative to their own middle, so a mesh of 1e-6 m may be
/// 1e6 m away. With a copy on the other side of the world's origin that does not help, and only meshes of at least
/// 1e-6 of that distance are tested.
pub(super) fn closed_mesh_anywhere(kernel: Kernel) -> f64 {
    let mesh = Polyhedron::icosphere(2);
    let mut escapes = 0;
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for shift in [0.0, 1e4, 1e6] {
            for has_copy in [false, true] {
                if has_copy && scale < 1e-6 * shift {
                    continue;
                }
                let placed = mesh.moved(|p| p * scale + DVec3::splat(shift));
                let copy = placed.moved(|p| -p);
                let meshes = if has_copy {
                    vec![&placed, &copy]
                } else {
                    vec![&placed]
                };
                let scene = white_scene(&meshes, kernel);
                let relative = |p: DVec3| (p - scene.origin).as_vec3();
                let triangles = placed.moved(|p| p - scene.origin).triangles();
                let place = |p: DVec3| relative(p * scale + DVec3::splat(shift));
                let rays: Vec<Ray> = rays_to_edges(&triangles, place).collect();
                let hits = first_hits(&scene, &rays);
                escapes += hits
                    .iter()
                    .filter(|hit| hit.is_none_or(|hit| hit.t > 2.0))
                    .count();
            }
        }
    }
    escapes as f64
}

/// 20,000 rays from near the middle of a mesh to vertices and edges of its triangles, which are at t = 1.
fn rays_to_edges(
    triangles: &[[Vec3; 3]],
    place: impl Fn(DVec3) -> Vec3,
) -> impl Iterator<Item = Ray> {
    let mut random = Random::new(5);
    (0..20_000).map(move |i| {
        let face = triangles[i % triangles.len()];
        let along = [0.0, random.unit()][i % 2];
        let target = face[i % 3].lerp(face[(i + 1) % 3], along);
        let origin = place(0.3 * random.point());
        Ray::new(origin, target - origin)
    })
}

/// An icosphere scaled by very different factors, mirrored or not, stays closed. The exact normal of a vertex v is
/// v / scale; that of a triangle follows from its exact vertices.
pub(super) fn scaled_unevenly(kernel: Kernel) -> f64 {
    let mesh = Polyhedron::icosphere(2);
    let mut worst: f64 = 0.0;
    for scale in [
        DVec3::new(1.0, 1e-3, 1e3),
        DVec3::new(-1.0, 1e-3, 1e3),
        DVec3::new(1.0, -1e3, -1e-3),
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::new(-1e-3, -1e-3, -1e3),
    ] {
        let quarter = DVec3::splat(FRAC_PI_2);
        for (rotation, translation) in [(DVec3::ZERO, DVec3::ZERO), (quarter, DVec3::splat(1e6))] {
            let transform = Transform::new(scale, rotation, translation);
            let placed = mesh.moved(|p| transform.point(p));
            let scene = white_scene(&[&placed], kernel);
            for &vertex in &mesh.vertices {
                let exact = transform.rotation() * (vertex / scale);
                worst = worse(worst, sine(transform.normal(vertex).as_vec3(), exact));
            }
            let relative = placed.moved(|p| p - scene.origin);
            let rays: Vec<Ray> = rays_to_edges(&relative.triangles(), |p| {
                (transform.point(p) - scene.origin).as_vec3()
            })
            .collect();
            for (ray, hit) in rays.iter().zip(first_hits(&scene, &rays)) {
                let Some(hit) = hit else { return 1.0 };
                let vertices = mesh.faces[hit.primitive as usize];
                let [a, b, c] = vertices.map(|vertex| relative.vertices[vertex as usize]);
                let normal = scene
                    .surface::<FeatureMask<0>>(ray, &hit)
                    .point
                    .geometric_normal;
                worst = worse(worst, sine(normal, (b - a).cross(c - a)));
                let is_on_the_viewers_side = normal.dot(ray.direction) < 0.0;
                worst = worse(worst, f64::from(u8::from(!is_on_the_viewers_side)));
            }
        }
    }
    worst
}
