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
        kind: WarningKind::SeesNothing {
            scene: scene.origin,
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

/// The part of the film onto which the box around the scene is projected; none outside the film.
fn within(scene: &Scene, camera: &Camera, size: DVec2) -> Option<[DVec2; 2]> {
    let bounds = scene.bounds();
    if bounds.min.x > bounds.max.x {
        return None;
    }
    let [min, max] = [bounds.min, bounds.max].map(|corner| scene.origin + corner.as_dvec3());
    let corner = |i: u8| DVec3::select(BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), max, min);
    let corners: Option<Vec<DVec2>> = (0..8).map(|i| camera.project(size, corner(i))).collect();
    // A box that is partly behind the camera may be anywhere.
    let Some(corners) = corners else {
        return Some([DVec2::ZERO, size]);
    };
    let first = corners.iter().copied().reduce(DVec2::min)?.max(DVec2::ZERO);
    let last = corners.iter().copied().reduce(DVec2::max)?.min(size);
    first.cmple(last).all().then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, open_shot, scene, still};
    use super::*;

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
