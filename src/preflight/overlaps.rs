//! Surfaces of different looks that overlap in one plane, where the camera sees them: z-fighting.

use super::SceneWarning;
use super::duplicates::repeated_triangles;
use crate::accel::QueryState;
use crate::camera::FrameCameras;
use crate::geometry::Hit;
use crate::math::Ray;
use crate::scene::{MeshMaterial, Scene, SceneNames};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashSet};

/// The most frames that are looked at, evenly spread.
const FRAMES: usize = 64;

/// Columns and rows of the grid of rays of each.
const GRID: [u32; 2] = [32, 18];

/// The least barycentric coordinate inside a triangle: on edges neighbours meet.
const INSIDE: f64 = 1e-4;

/// The largest sine of the angle between surfaces of one plane.
const PARALLEL: f64 = 1e-4;

/// The distance of vertices of one plane, relative to their coordinates: a few units of rounding.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// That of distances along rays, which are in double precision.
const RAY_ROUNDING: f64 = 1e-10;

/// Where two shapes overlap.
struct Overlap {
    shapes: [u32; 2],
    frame: usize,
    position: DVec3,
}

pub(super) fn find(scene: &Scene, names: &SceneNames, frames: &FrameCameras) -> Vec<SceneWarning> {
    let count = frames.cameras.len();
    let looks = count.min(FRAMES);
    let chosen: Vec<usize> = (0..looks)
        .map(|i| (2 * i + 1) * count / (2 * looks))
        .collect();
    let seen = chosen
        .par_iter()
        .map(|&frame| overlaps(scene, frames, frame));
    let seen: Vec<Vec<Overlap>> = seen.collect();
    let mut pairs = BTreeMap::new();
    for overlap in seen.into_iter().flatten() {
        pairs.entry(overlap.shapes).or_insert(overlap);
    }
    if pairs.is_empty() {
        return Vec::new();
    }
    // These have a warning of their own.
    let repeated: HashSet<usize> = repeated_triangles(scene).into_iter().flatten().collect();
    pairs.retain(|shapes, _| {
        !shapes
            .iter()
            .all(|shape| repeated.contains(&(*shape as usize)))
    });
    let name = |shape: u32| match (shape as usize).checked_sub(scene.triangle_count()) {
        None => names.mesh(scene.mesh_of(shape as usize)),
        Some(sphere) => names.sphere(sphere),
    };
    let warning = pairs.values().next().map(|first| SceneWarning::Overlaps {
        count: pairs.len(),
        objects: first.shapes.map(name),
        position: scene.origin + first.position,
        frame: first.frame as u32,
    });
    warning.into_iter().collect()
}

/// What overlaps at the points that a frame sees.
fn overlaps(scene: &Scene, frames: &FrameCameras, frame: usize) -> Vec<Overlap> {
    let [columns, rows] = GRID;
    let film = DVec2::new(columns.into(), rows.into());
    let camera_rays = frames.cameras[frame].rays(film, scene.origin);
    let points = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let ray = |(x, y): (u32, u32)| camera_rays.through(DVec2::new(x.into(), y.into()) + 0.5);
    let rays: Vec<Ray> = points.map(ray).collect();
    let hits = closest(scene, &rays);
    let seen = rays.iter().zip(hits);
    let (onward, hits): (Vec<Ray>, Vec<Hit>) = seen
        .filter_map(|(ray, hit)| {
            let exclude = hit?.primitive;
            Some((Ray { exclude, ..*ray }, hit?))
        })
        .unzip();
    let others = closest(scene, &onward);
    let pairs = onward.iter().zip(hits).zip(others);
    pairs
        .filter_map(|((ray, hit), other)| {
            let other = other?;
            coincide(scene, ray, &hit, &other).then(|| {
                let mut shapes = [hit.primitive, other.primitive];
                shapes.sort_unstable();
                Overlap {
                    shapes,
                    frame,
                    position: ray.at(hit.t),
                }
            })
        })
        .collect()
}

fn closest(scene: &Scene, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(rays, &mut hits, &mut QueryState::default());
    hits
}

/// Whether two shapes that a ray hits are the same surface there, but look different.
fn coincide(scene: &Scene, ray: &Ray, first: &Hit, other: &Hit) -> bool {
    let normal = scene.normal(ray, first).as_dvec3();
    let cos = normal.dot(ray.direction.as_dvec3()).abs();
    let gap = (other.t - first.t).abs() * cos;
    let near = |rounding: f64| gap <= rounding + RAY_ROUNDING * first.t;
    let triangles = scene.triangle_count();
    let shapes = [first.primitive, other.primitive].map(|shape| shape as usize);
    let same = match shapes.map(|shape| shape.checked_sub(triangles)) {
        [None, None] => {
            let vertices = shapes.map(|shape| scene.triangle_vertices(shape).map(Vec3::as_dvec3));
            let size = vertices
                .as_flattened()
                .iter()
                .fold(DVec3::ZERO, |size, p| size.max(p.abs()));
            let is_parallel = normal.cross(scene.normal(ray, other).as_dvec3()).length() < PARALLEL;
            let point = ray.at(first.t);
            // Rounding moves vertices along each axis by a part of that coordinate.
            near(ROUNDING * size.dot(normal.abs()))
                && is_parallel
                && vertices.iter().all(|vertices| is_inside(point, *vertices))
        }
        [Some(a), Some(b)] => {
            let [a, b] = [a, b].map(|sphere| scene.spheres()[sphere]);
            let rounding = ROUNDING * a.radius;
            near(rounding)
                && a.center.distance(b.center) <= rounding
                && (a.radius - b.radius).abs() <= rounding
                && (a.center, a.radius) != (b.center, b.radius)
        }
        _ => false,
    };
    let [a, b] = shapes.map(|shape| look(scene, shape));
    same && (a.is_none() || a != b)
}

/// Whether a point of a triangle's plane lies within it, away from its edges.
fn is_inside(point: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let weight = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal) / area;
    [weight(a, b), weight(b, c), weight(c, a)]
        .iter()
        .all(|weight| *weight > INSIDE)
}

/// The material of a shape that looks the same everywhere; none of one with a texture or several materials.
fn look(scene: &Scene, shape: usize) -> Option<usize> {
    let material = match shape.checked_sub(scene.triangle_count()) {
        Some(sphere) => scene.sphere_material(sphere),
        None => match scene.mesh_material(scene.mesh_of(shape)) {
            MeshMaterial::Uniform(id) => *id,
            MeshMaterial::PerVertex(_) => return None,
        },
    };
    let is_plain = scene.materials()[material].texture.is_none();
    is_plain.then_some(material)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, open_shot, scene, still};
    use super::*;
    use crate::geometry::{Sphere, Transform};
    use crate::material::Material;
    use crate::scene::{SceneBuilder, SourceMesh};

    fn red(mesh: SourceMesh) -> SourceMesh {
        SourceMesh {
            material: MeshMaterial::Uniform(1),
            ..mesh
        }
    }

    /// A plate of 4 x 3 m, `above` metres above the wall behind the hall, which is split into triangles elsewhere.
    fn plate(above: f64) -> SourceMesh {
        let corners = [(-2.0, 0.5), (2.0, 0.5), (2.0, 3.5), (-2.0, 3.5)];
        SourceMesh {
            positions: corners.map(|(x, y)| DVec3::new(x, y, above - 5.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..hall()
        }
    }

    /// The number of overlaps that a camera sees which looks at the plate.
    fn count(meshes: Vec<SourceMesh>, move_by: &Transform) -> usize {
        let meshes = meshes.into_iter().map(|mesh| SourceMesh {
            positions: mesh.positions.iter().map(|p| move_by.point(*p)).collect(),
            ..mesh
        });
        let eye = DVec3::new(0.1, 1.7, 3.0);
        let target = DVec3::new(0.0, 1.8, -5.0);
        let [eye, target] = [eye, target].map(|p| move_by.point(p));
        let frames = open_shot(vec![still(eye, target - eye); 3]);
        match &find(
            &scene(meshes.collect(), &[]),
            &SceneNames::default(),
            &frames,
        )[..]
        {
            [] => 0,
            [SceneWarning::Overlaps { count, .. }] => *count,
            other => panic!("{other:?}"),
        }
    }

    fn placements() -> [Transform; 4] {
        let place =
            |size: f64, angles: DVec3, to: DVec3| Transform::new(DVec3::splat(size), angles, to);
        let turned = DVec3::new(0.4, 1.1, -0.7);
        [
            place(1.0, DVec3::ZERO, DVec3::ZERO),
            place(1.0, turned, DVec3::new(7.0, -3.0, 2.0)),
            place(1e-3, turned, DVec3::ZERO),
            place(1e4, turned, DVec3::splat(1e6)),
        ]
    }

    #[test]
    fn a_plate_in_the_plane_of_a_wall_is_found() {
        for place in placements() {
            // Each half of the plate is on both of the wall, whose diagonal crosses it.
            let found = count(vec![hall(), red(plate(0.0))], &place);
            assert!((2..=4).contains(&found), "{found}");
        }
    }

    #[test]
    fn a_plate_before_a_wall_is_none() {
        for place in placements() {
            assert_eq!(count(vec![hall(), red(plate(1e-4))], &place), 0);
            assert_eq!(count(vec![hall(), red(plate(-1e-4))], &place), 0);
        }
    }

    #[test]
    fn a_mark_on_a_huge_ground_is_none() {
        let ground = SourceMesh {
            positions: [(-1e6, 1e6), (1e6, 1e6), (0.0, -1e6)]
                .map(|(x, z)| DVec3::new(x, 0.0, z))
                .to_vec(),
            triangles: vec![[0, 1, 2]],
            ..hall()
        };
        let mark = cuboid(DVec3::new(-2.0, 1e-3, -2.0), DVec3::new(2.0, 2e-3, 2.0));
        let camera = still(DVec3::new(0.0, 3.0, 3.0), DVec3::new(0.0, -1.0, -1.0));
        let scene = scene(vec![ground, red(mark)], &[]);
        assert_eq!(
            find(&scene, &SceneNames::default(), &open_shot(vec![camera])),
            []
        );
    }

    #[test]
    fn what_looks_the_same_does_not_fight() {
        let place = Transform::new(DVec3::ONE, DVec3::ZERO, DVec3::ZERO);
        assert_eq!(count(vec![hall(), plate(0.0)], &place), 0);
    }

    #[test]
    fn neighbours_in_a_plane_only_meet() {
        let place = Transform::new(DVec3::ONE, DVec3::new(0.3, 0.2, 0.1), DVec3::ZERO);
        // Stripes of the wall, each as wide as the grid's rays are apart, or less.
        let stripe = |i: u32| {
            let at = |j: u32| f64::from(i + j) * 0.1 - 2.0;
            let corners = [(at(0), 0.0), (at(1), 0.0), (at(1), 4.0), (at(0), 4.0)];
            let stripe = SourceMesh {
                positions: corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                ..hall()
            };
            if i.is_multiple_of(2) {
                stripe
            } else {
                red(stripe)
            }
        };
        assert_eq!(count((0..40).map(stripe).collect(), &place), 0);
    }

    #[test]
    fn spheres_equal_up_to_rounding_are_found() {
        let found = |far: f64| {
            let balls = [
                Sphere::new(DVec3::ZERO, 0.3),
                Sphere::new(DVec3::splat(far), 0.1 + 0.2),
            ];
            let builder = SceneBuilder {
                materials: vec![Material::lambert(Vec3::X), Material::lambert(Vec3::Y)],
                spheres: vec![(balls[0], 0), (balls[1], 1)],
                ..SceneBuilder::default()
            };
            let scene = builder.build().0;
            let frames = open_shot(vec![still(DVec3::Z, DVec3::NEG_Z)]);
            find(&scene, &SceneNames::default(), &frames).len()
        };
        assert_eq!([found(0.0), found(1e-4)], [1, 0]);
    }
}
