//! Frames that see nothing of the scene.

use super::{FrameRuns, PathWarning, WarningKind};
use crate::accel::QueryState;
use crate::camera::{Camera, FrameCameras};
use crate::math::Ray;
use crate::scene::Scene;
use glam::{BVec3, DVec2, DVec3};
use rayon::prelude::*;

/// Columns and rows of the grid of rays of every frame.
const COARSE: [usize; 2] = [16, 9];

/// Of a frame in which none of these meets a surface.
/// What is thinner than 4 of 1280 pixels may be missed.
const FINE: [usize; 2] = [320, 180];

pub(super) fn find(scene: &Scene, frames: &FrameCameras, size: DVec2) -> Vec<PathWarning> {
    let sees_nothing = |camera: &Camera| {
        let whole = [DVec2::ZERO, size];
        misses(scene, camera, size, whole, COARSE)
            && within(scene, camera, size)
                .is_none_or(|part| misses(scene, camera, size, part, FINE))
    };
    let cameras = frames.cameras.par_iter();
    let blind: Vec<bool> = cameras.map(sees_nothing).collect();
    let blind = (0..blind.len()).filter(|&frame| blind[frame]);
    let blind: Vec<u32> = blind.map(|frame| frame as u32).collect();
    let warning = (!blind.is_empty()).then(|| PathWarning {
        frames: FrameRuns::of(blind),
        kind: match scene.triangle_count() + scene.sphere_count() {
            0 => WarningKind::EmptyScene,
            _ => WarningKind::SeesNothing {
                scene: scene.origin,
            },
        },
    });
    warning.into_iter().collect()
}

/// Whether all rays miss through a grid over a part of the film.
fn misses(
    scene: &Scene,
    camera: &Camera,
    size: DVec2,
    [min, max]: [DVec2; 2],
    [columns, rows]: [usize; 2],
) -> bool {
    let camera_rays = camera.rays(size, scene.origin);
    let mut query_state = QueryState::default();
    // Row by row, as the first hit decides.
    (0..rows).all(|row| {
        let at = |column: usize| DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
        let grid = DVec2::new(columns as f64, rows as f64);
        let rays: Vec<Ray> = (0..columns)
            .map(|column| camera_rays.through(min + at(column) / grid * (max - min)))
            .collect();
        let mut hits = vec![None; rays.len()];
        scene.closest_incoherent(&rays, &mut hits, &mut query_state);
        hits.iter().all(Option::is_none)
    })
}

/// The part of the film onto which the box around the scene is projected; none where the box is outside the film.
fn within(scene: &Scene, camera: &Camera, size: DVec2) -> Option<[DVec2; 2]> {
    let bounds = scene.bounds();
    if bounds.min.x > bounds.max.x {
        return None;
    }
    let [min, max] = [bounds.min, bounds.max].map(|corner| scene.origin + corner.as_dvec3());
    let is_max = |i: u8| BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0);
    let corners: [DVec3; 8] = std::array::from_fn(|i| DVec3::select(is_max(i as u8), max, min));
    // Beyond one side of the pyramid of the camera's rays.
    let half = DVec2::new(size.x / size.y, 1.0) * camera.half_height;
    let is_beyond = |side: DVec3| {
        let to_camera = camera.rotation.transpose();
        let depth = |corner: &DVec3| (to_camera * (corner - camera.position)).dot(side);
        corners.iter().all(|corner| depth(corner) > 0.0)
    };
    let [x, y] = half.to_array();
    let sides = [
        DVec3::Z,
        DVec3::new(1.0, 0.0, x),
        DVec3::new(-1.0, 0.0, x),
        DVec3::new(0.0, 1.0, y),
        DVec3::new(0.0, -1.0, y),
    ];
    if sides.into_iter().any(is_beyond) {
        return None;
    }
    // A box that is partly behind the camera may be anywhere.
    let projected = corners.map(|corner| camera.project(size, corner));
    let projected: Option<Vec<DVec2>> = projected.into_iter().collect();
    let Some(projected) = projected else {
        return Some([DVec2::ZERO, size]);
    };
    let first = projected.iter().copied().reduce(DVec2::min)?;
    let last = projected.iter().copied().reduce(DVec2::max)?;
    Some([first.max(DVec2::ZERO), last.min(size)])
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, open_shot, scene, still};
    use super::*;
    use crate::sampling::Random;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    /// The frames that see nothing of cameras that look in directions.
    fn blind(scene: &Scene, position: DVec3, directions: &[DVec3]) -> Vec<[u32; 2]> {
        let cameras = directions
            .iter()
            .map(|direction| still(position, *direction));
        let found = find(scene, &open_shot(cameras.collect()), SIZE);
        found
            .iter()
            .flat_map(|warning| warning.frames.runs().to_vec())
            .collect()
    }

    #[test]
    fn cameras_that_look_away_see_nothing() {
        let ball = scene(vec![], &[(DVec3::new(1e4, 0.0, 0.0), 1.0)]);
        let at = DVec3::new(1e4, 0.0, 9.0);
        let directions = [DVec3::NEG_Z, DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::X];
        assert_eq!(blind(&ball, at, &directions), [[1, 2], [4, 4]]);
        let room = scene(vec![hall()], &[]);
        assert_eq!(blind(&room, DVec3::Y, &directions), Vec::<[u32; 2]>::new());
        let nothing = scene(vec![], &[]);
        assert_eq!(blind(&nothing, DVec3::Y, &directions), [[0, 4]]);
    }

    /// The part of the film is no smaller than the scene, by the projections of random points in its box.
    #[test]
    fn the_box_of_the_scene_is_within_its_part_of_the_film() {
        let mut random = Random::new(2);
        let (mut none, mut some) = (0, 0);
        for _ in 0..500 {
            let [a, b] = [random.point(), random.point()].map(|p| 5.0 * p);
            let (min, max) = (a.min(b), a.max(b) + 1e-3);
            let scene = scene(vec![cuboid(min, max)], &[]);
            let camera = still(9.0 * random.point(), random.point());
            let part = within(&scene, &camera, SIZE);
            *(if part.is_some() { &mut some } else { &mut none }) += 1;
            for _ in 0..50 {
                let at = DVec3::from_array([(); 3].map(|()| random.unit().into()));
                let film = camera.project(SIZE, min + at * (max - min));
                let on_film =
                    |film: &DVec2| film.cmpge(DVec2::ZERO).all() && film.cmple(SIZE).all();
                let Some(film) = film.filter(on_film) else {
                    continue;
                };
                let [first, last] = part.expect("part of the film");
                let is_in = film.cmpge(first - 1e-2).all() && film.cmple(last + 1e-2).all();
                assert!(is_in, "{film} {first} {last}");
            }
        }
        assert!(none > 50 && some > 50, "{none} {some}");
    }

    #[test]
    fn small_and_thin_things_are_seen() {
        let none = Vec::<[u32; 2]>::new();
        // A tenth of a pixel, off the centre.
        let speck = scene(vec![], &[(DVec3::new(0.37, 0.11, 0.0), 1e-3)]);
        assert_eq!(blind(&speck, DVec3::Z * 13.0, &[DVec3::NEG_Z]), none);
        // A mast of 4 pixels, between the rays of the coarse grid, and a ground behind the camera.
        let mast = cuboid(DVec3::new(0.2, -9.0, 0.0), DVec3::new(0.25, 9.0, 0.05));
        let ground = cuboid(DVec3::new(-9.0, -1.0, 20.0), DVec3::new(9.0, 0.0, 30.0));
        let both = scene(vec![mast, ground], &[]);
        assert_eq!(
            blind(&both, DVec3::new(0.0, 1.7, 10.0), &[DVec3::NEG_Z]),
            none
        );
    }
}
