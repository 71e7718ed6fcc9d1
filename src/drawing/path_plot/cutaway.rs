//! The scene behind a cutting plane as a grey drawing, from six axis-aligned rays at each pixel.

use super::view::View;
use crate::accel::QueryState;
use crate::math::Ray;
use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// A rectangle of a view, and the size of its picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// The coordinates of the upper left corner on the view's axes.
    pub(super) from: DVec2,
    /// Those of the lower right corner.
    pub(super) to: DVec2,
    /// Columns and rows.
    pub(super) size: (u32, u32),
}

/// The directions of the rays from a point: along each axis and back.
const DIRECTIONS: [Vec3; 6] = [
    Vec3::X,
    Vec3::NEG_X,
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::Z,
    Vec3::NEG_Z,
];

/// The greys of the picture, from white paper to the dark lines of cut surfaces.
const PAPER: u8 = 255;
pub(super) const SECTION: u8 = 40;
pub(super) const SOLID: u8 = 110;
const OUTLINE: u8 = 130;
const CREASE: u8 = 180;

/// What a ray hits.
#[derive(Clone, Copy)]
struct SurfaceHit {
    /// In metres.
    distance: f64,
    /// The unit normal of the surface, whichever side is seen.
    normal: Vec3,
    /// Whether the back of the surface is hit.
    is_back: bool,
}

/// What the rays from a pixel's point on the cutting plane hit.
#[derive(Clone, Copy)]
struct PixelSample {
    /// The hit behind the plane.
    seen: Option<SurfaceHit>,
    /// Whether the point is inside a solid.
    is_solid: bool,
    /// Whether a surface crosses the plane between this pixel and a neighbour.
    is_cut: bool,
}

/// An orthographic drawing in greys, row by row from the top left, of the scene behind a plane that is `cut` metres
/// along the view direction from the world's origin.
///
/// Surfaces are paler where they are farther away or face the reader, with lines where depth or normal are
/// discontinuous. Surfaces that the plane cuts are dark lines, solids that it cuts dark areas. `is_air` are points
/// outside solids: if most of them seem to be inside, the orientation of the triangles does not tell where solids are,
/// and no areas are drawn.
pub(super) fn cutaway(
    scene: &Scene,
    view: &View,
    cut: f64,
    window: &Window,
    is_air: &[DVec3],
) -> Vec<u8> {
    let relative = |point: DVec3| (point - scene.origin).as_vec3();
    let air: Vec<Vec3> = is_air.iter().map(|point| relative(*point)).collect();
    let filled = in_solids(&cast_rays(scene, &air))
        .iter()
        .filter(|is| **is)
        .count();
    let shows_solids = 2 * filled <= air.len();

    let (columns, rows) = (window.size.0 as usize, window.size.1 as usize);
    let pixel = (window.to - window.from) / DVec2::new(columns as f64, rows as f64);
    let samples: Vec<PixelSample> = (0..rows)
        .into_par_iter()
        .flat_map_iter(|row| {
            let points: Vec<Vec3> = (0..columns)
                .map(|column| {
                    let middle = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                    relative(view.at(window.from + middle * pixel, cut))
                })
                .collect();
            sample_row(scene, view, &points, pixel, shows_solids)
        })
        .collect();
    let step = pixel.abs().max_element();
    let forward = view.forward.as_vec3();
    let shade = |number: usize| {
        let here = &samples[number];
        let right = (number % columns + 1 < columns).then(|| &samples[number + 1]);
        let below = samples.get(number + columns);
        let neighbours = right.into_iter().chain(below);
        let line = neighbours.map(|next| line(here, next, forward, step)).min();
        let plain = plain(here, forward, step * columns.max(rows) as f64);
        line.map_or(plain, |line| line.min(plain))
    };
    (0..samples.len()).map(shade).collect()
}

fn sample_row(
    scene: &Scene,
    view: &View,
    points: &[Vec3],
    pixel: DVec2,
    shows_solids: bool,
) -> Vec<PixelSample> {
    let met = cast_rays(scene, points);
    let solids = in_solids(&met);
    let forward = &met[number_of(view.forward.as_vec3())];
    let is_cut = |axis: usize, step: f64, column: usize| {
        let both = &met[2 * axis..2 * axis + 2];
        both.iter()
            .filter_map(|met| met[column])
            .any(|met| met.distance < step.abs())
    };
    let sample = |column: usize| PixelSample {
        seen: forward[column],
        is_solid: shows_solids && solids[column],
        is_cut: is_cut(view.across, pixel.x, column) || is_cut(view.along, pixel.y, column),
    };
    (0..points.len()).map(sample).collect()
}

fn number_of(direction: Vec3) -> usize {
    let found = DIRECTIONS.iter().position(|other| *other == direction);
    found.expect("a direction of an axis")
}

/// The hits of rays from some points, in each of the directions.
fn cast_rays(scene: &Scene, points: &[Vec3]) -> [Vec<Option<SurfaceHit>>; 6] {
    let mut query_state = QueryState::default();
    DIRECTIONS.map(|direction| {
        let rays: Vec<Ray> = points
            .iter()
            .map(|&point| Ray::new(point, direction))
            .collect();
        let mut hits = vec![None; rays.len()];
        scene.closest_coherent(&rays, &mut hits, &mut query_state);
        let met = rays.iter().zip(hits).map(|(ray, hit)| {
            let hit = hit?;
            let normal = scene.normal(ray, &hit);
            Some(SurfaceHit {
                distance: hit.t,
                normal,
                is_back: normal.dot(direction) > 0.0,
            })
        });
        met.collect()
    })
}

/// Whether each point is inside a solid: it sees backs in at least five directions, as solids on a floor are often open
/// below.
fn in_solids(met: &[Vec<Option<SurfaceHit>>; 6]) -> Vec<bool> {
    let backs = |number: usize| {
        let met = met.iter().filter_map(|met| met[number]);
        met.filter(|met| met.is_back).count()
    };
    (0..met[0].len())
        .map(|number| backs(number) + 1 >= DIRECTIONS.len())
        .collect()
}

/// The shade of a pixel without lines: paler where the surface faces the reader, and far away, relative to `far`, the
/// width of the picture in metres.
fn plain(sample: &PixelSample, forward: Vec3, far: f64) -> u8 {
    if sample.is_cut {
        return SECTION;
    }
    if sample.is_solid {
        return SOLID;
    }
    let Some(seen) = sample.seen else {
        return PAPER;
    };
    let facing = f64::from(seen.normal.dot(forward).abs());
    let light = 0.70 + 0.20 * facing;
    let distance = seen.distance / (seen.distance + far);
    let light = light + (0.97 - light) * distance;
    (light * 255.0) as u8
}

/// The shade of a line between a pixel and the next, white for none: where depth or normal are discontinuous.
fn line(here: &PixelSample, next: &PixelSample, forward: Vec3, step: f64) -> u8 {
    let (Some(a), Some(b)) = (here.seen, next.seen) else {
        return if here.seen.is_some() == next.seen.is_some() {
            PAPER
        } else {
            OUTLINE
        };
    };
    // The slope of the depth of a plane.
    let slope = |met: SurfaceHit| {
        let facing = f64::from(met.normal.dot(forward).abs()).max(0.05);
        (1.0 - facing * facing).max(0.0).sqrt() / facing
    };
    let jump = (a.distance - b.distance).abs();
    if jump > step * (2.0 + 1.5 * slope(a).max(slope(b))) {
        OUTLINE
    } else if a.normal.dot(b.normal).abs() < 0.8 {
        CREASE
    } else {
        PAPER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Sphere, cuboid};
    use crate::material::Material;
    use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};

    /// A room 4 m wide and deep and 3 m high, its floor at y = 0 and its middle at x = z = 0, and spheres in it.
    fn room(is_inside_out: bool, spheres: &[(DVec3, f64)]) -> Scene {
        let (positions, mut triangles) =
            cuboid(DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 3.0, 2.0));
        if !is_inside_out {
            triangles
                .iter_mut()
                .for_each(|vertices| vertices.swap(1, 2));
        }
        let mesh = SourceMesh {
            positions,
            normals: vec![],
            uvs: vec![],
            triangles,
            material: MeshMaterial::Uniform(0),
        };
        let sphere = |&(center, radius): &(DVec3, f64)| (Sphere::new(center, radius), 0);
        let builder = SceneBuilder {
            materials: vec![Material::lambert(Vec3::ONE)],
            meshes: vec![mesh],
            spheres: spheres.iter().map(sphere).collect(),
            ..SceneBuilder::default()
        };
        builder.build().0
    }

    /// What the plan of 6 m by 6 m shows, cut at y = 1.5, in pixels of 5 cm, at points x, z.
    fn plan(scene: &Scene, points: &[(f64, f64)]) -> Vec<u8> {
        let window = Window {
            from: DVec2::splat(-3.0),
            to: DVec2::splat(3.0),
            size: (120, 120),
        };
        let camera = DVec3::new(1.0, 1.4, 1.0);
        let greys = cutaway(scene, &View::PLAN, -1.5, &window, &[camera]);
        assert_eq!(greys.len(), 120 * 120);
        let place = |c: f64| ((c + 3.0) * 20.0) as usize;
        points
            .iter()
            .map(|(x, z)| greys[place(*z) * 120 + place(*x)])
            .collect()
    }

    #[test]
    fn a_room_shows_its_walls_and_its_floor_and_not_its_ceiling() {
        // The first is cut, the second hangs above the plane, the third lies below it.
        let spheres = [
            (DVec3::new(1.0, 1.5, 0.0), 0.4),
            (DVec3::new(0.0, 2.5, 1.0), 0.4),
            (DVec3::new(-1.0, 0.5, -1.0), 0.3),
        ];
        for is_inside_out in [false, true] {
            let scene = room(is_inside_out, &spheres);
            let solids = if is_inside_out { None } else { Some(SOLID) };
            let walls = plan(
                &scene,
                &[(-1.99, 0.3), (1.99, 0.3), (0.3, -1.99), (0.3, 1.99)],
            );
            assert_eq!(walls, [SECTION; 4]);
            let outside = plan(&scene, &[(2.5, 0.0), (0.0, -2.5)]);
            assert_eq!(outside, [PAPER; 2]);
            let inside = plan(&scene, &[(-0.5, 0.5), (0.0, 1.0), (-1.0, -1.0), (1.0, 0.0)]);
            let [floor, below_hanging, top, cut] = inside[..] else {
                panic!("four pixels")
            };
            // Flat floor, 1.5 m down.
            let light = 0.9 + 0.07 * 1.5 / (1.5 + 6.0);
            assert_eq!(floor, (255.0 * light) as u8);
            assert_eq!(below_hanging, floor);
            // Nearer, so darker.
            assert!(top < floor && top > OUTLINE);
            if let Some(body) = solids {
                assert_eq!(cut, body);
            }
            assert_eq!(plan(&scene, &[(1.4, 0.02), (0.98, 0.41)]), [SECTION; 2]);
            let edge = plan(
                &scene,
                &[-0.8, -0.75, -0.7, -0.65, -0.6].map(|x| (x, -1.02)),
            );
            assert!(edge.contains(&OUTLINE), "{edge:?}");
        }
    }
}
