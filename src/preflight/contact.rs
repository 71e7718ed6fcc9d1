//! Contact of the camera with the scene: inside objects, through surfaces, too close to them.

use super::inside::{Probe, eye, frames_inside};
use super::steps::measure_steps;
use super::warning::Measured;
use super::{FrameRuns, PathWarning, WarningKind};
use crate::accel::QueryState;
use crate::camera::{Camera, FrameCameras};
use crate::math::Ray;
use crate::scene::Scene;
use rayon::prelude::*;

pub(super) fn find(scene: &Scene, frames: &FrameCameras, near: f64) -> Vec<PathWarning> {
    let cameras = frames.cameras.par_iter();
    let probes: Vec<Probe> = cameras.map(|camera| Probe::new(scene, camera)).collect();
    let crossings = measure_steps(frames, |from, to| crossing(scene, from, to));
    let crossings: Vec<Option<i32>> = crossings.into_iter().map(Option::flatten).collect();
    let crossed: Vec<usize> = (0..crossings.len())
        .filter(|&frame| crossings[frame].is_some())
        .collect();
    let distance =
        |frame: usize, within| scene.closest_point_distance(frames.cameras[frame].position, within);
    let depths: Vec<Measured> = frames_inside(frames, &probes, &crossings)
        .into_iter()
        .filter_map(|frame| Some((frame, distance(frame, f64::INFINITY)?)))
        .collect();
    let numbers = (0..frames.cameras.len()).into_par_iter();
    // Negative, as the greatest is the worst.
    let distances: Vec<Measured> = numbers
        .filter_map(|frame| Some((frame, -distance(frame, near)?)))
        .collect();
    let inside = PathWarning::of(&depths, |frame, depth| WarningKind::InsideSolid {
        frame,
        depth,
    });
    let crosses = (!crossed.is_empty()).then(|| PathWarning {
        frames: FrameRuns::of(crossed.iter().map(|&frame| frame as u32)),
        kind: WarningKind::CrossesSurface,
    });
    let near = PathWarning::of(&distances, |frame, distance| WarningKind::NearSurface {
        frame,
        distance: -distance,
        near,
    });
    [inside, crosses, near].into_iter().flatten().collect()
}

/// The change over a step of the number of solids that contain the camera, -1..=1, if faces point outward; none if no
/// surface is crossed.
fn crossing(scene: &Scene, from: &Camera, to: &Camera) -> Option<i32> {
    let (from, to) = (eye(scene, from), eye(scene, to));
    if from == to {
        return None;
    }
    let rays = [Ray::new(from, to - from), Ray::new(to, from - to)];
    let mut hits = [None; 2];
    scene.closest_incoherent(&rays, &mut hits, &mut QueryState::default());
    // Whether the camera is in front of the nearest surface on its way.
    let in_front = |i: usize| {
        let hit = hits[i].filter(|hit| hit.t <= 1.0)?;
        Some(scene.is_front(&rays[i], &hit))
    };
    let change = |before: bool, after: bool| i32::from(before) - i32::from(after);
    match (in_front(0), in_front(1)) {
        (None, None) => None,
        (Some(before), Some(after)) => Some(change(before, after)),
        // One camera lies on the surface and counts as beyond it.
        (Some(before), None) => Some(change(before, !before)),
        (None, Some(after)) => Some(change(!after, after)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, inverted, open_shot, scene, still, walk};
    use super::*;
    use crate::scene::SourceMesh;
    use glam::DVec3;

    const NEAR: f64 = 0.1;

    /// Warnings of a path at eye level, from left to right.
    fn findings(scene: &Scene) -> Vec<PathWarning> {
        let at = |x| DVec3::new(x, 1.7, 0.3);
        find(scene, &FrameCameras::of(&walk(at(-2.41), at(2.39))), NEAR)
    }

    fn pillar() -> SourceMesh {
        cuboid(DVec3::new(-0.3, 0.0, -0.7), DVec3::new(0.9, 4.0, 1.3))
    }

    /// The frames of that path between two coordinates: they start at -2.41 m, 0.2 m apart.
    fn frames_between(from: f64, to: f64) -> Vec<u32> {
        let is_between = |frame: &u32| (from..to).contains(&(0.2 * f64::from(*frame) - 2.41));
        (0..=24).filter(is_between).collect()
    }

    #[test]
    fn a_walk_through_a_pillar_is_found_in_any_room() {
        let outside = DVec3::new(5.0, 4.0, 5.0);
        let rooms = [
            vec![],
            vec![hall()],
            // Its faces point the wrong way.
            vec![cuboid(-outside, outside)],
        ];
        // The pillar's faces look outward, or inward.
        let pillars = [pillar(), inverted(pillar())];
        for (room, pillar) in rooms
            .iter()
            .flat_map(|room| pillars.iter().map(move |p| (room, p)))
        {
            let meshes = [&room[..], std::slice::from_ref(pillar)].concat();
            let found = findings(&scene(meshes, &[]));
            assert_eq!(found.len(), 3, "{found:?}");
            assert_eq!(found[0].frames, FrameRuns::of(frames_between(-0.3, 0.9)));
            // The middle of 1.2 m is between frames.
            let WarningKind::InsideSolid { frame: 14, depth } = found[0].kind else {
                panic!("{:?}", found[0].kind)
            };
            assert!((depth - 0.51).abs() < 1e-5, "{depth}");
            assert_eq!(found[1].kind, WarningKind::CrossesSurface);
            assert_eq!(found[1].frames, FrameRuns::of([10, 16]));
            let WarningKind::NearSurface { distance, .. } = found[2].kind else {
                panic!("{:?}", found[2].kind)
            };
            assert!((distance - 0.09).abs() < 1e-5, "{distance}");
        }
    }

    #[test]
    fn a_sphere_may_be_a_solid_or_a_room() {
        let ball = (DVec3::new(0.1, 1.5, 0.0), 0.62);
        let sky = (DVec3::ZERO, 100.0);
        for spheres in [&[ball][..], &[sky, ball]] {
            let found = findings(&scene(vec![], spheres));
            let half = (0.62_f64.powi(2) - 0.2_f64.powi(2) - 0.3_f64.powi(2)).sqrt();
            let inside = frames_between(0.1 - half, 0.1 + half);
            assert_eq!(found[0].frames, FrameRuns::of(inside.iter().copied()));
            assert!(matches!(found[0].kind, WarningKind::InsideSolid { .. }));
            let crossed = [inside[0] - 1, inside[inside.len() - 1]];
            assert_eq!(found[1].frames, FrameRuns::of(crossed));
        }
        assert_eq!(findings(&scene(vec![], &[sky])), []);
        // Past a solid inside it, whose front is seen, too.
        let beside = (DVec3::new(0.0, 1.7, -0.4), 0.55);
        assert_eq!(findings(&scene(vec![], &[sky, beside])), []);
        assert_eq!(findings(&scene(vec![hall()], &[beside])), []);
        assert_eq!(findings(&scene(vec![], &[])), []);
    }

    #[test]
    fn a_wall_may_be_thinner_than_a_step() {
        for thickness in [0.0, 0.01] {
            let min = DVec3::new(0.1, 0.0, -5.0);
            let wall = cuboid(min, DVec3::new(0.1 + thickness, 4.0, 5.0));
            let found = findings(&scene(vec![hall(), wall], &[]));
            assert_eq!(found[0].kind, WarningKind::CrossesSurface, "{thickness}");
            assert_eq!(found[0].frames, FrameRuns::of([12]));
        }
    }

    #[test]
    fn the_room_behind_a_one_sided_wall_is_no_solid() {
        let vertices = [(-5.0, 0.0), (5.0, 0.0), (5.0, 4.0), (-5.0, 4.0)];
        let sheet = SourceMesh {
            positions: vertices.map(|(z, y)| DVec3::new(0.1, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..hall()
        };
        for sheet in [sheet.clone(), inverted(sheet)] {
            let found = findings(&scene(vec![hall(), sheet], &[]));
            assert_eq!(found[0].kind, WarningKind::CrossesSurface);
            assert_eq!(found[0].frames, FrameRuns::of([12]));
        }
    }

    #[test]
    fn a_hall_that_the_camera_leaves_is_no_solid() {
        let path = walk(DVec3::new(0.1, 1.7, 0.0), DVec3::new(6.0, 1.7, 0.0));
        let found = find(&scene(vec![hall()], &[]), &FrameCameras::of(&path), 0.01);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].kind, WarningKind::CrossesSurface);
    }

    #[test]
    fn cameras_on_a_surface_may_cross_it_or_not() {
        let wall = cuboid(DVec3::new(0.0, 0.0, -5.0), DVec3::new(0.5, 4.0, 5.0));
        let scene = scene(vec![hall(), wall], &[]);
        let found = |positions: &[f64]| {
            let camera = |x: &f64| still(DVec3::new(*x, 1.0, 0.0), DVec3::NEG_Z);
            let found = find(
                &scene,
                &open_shot(positions.iter().map(camera).collect()),
                1e-9,
            );
            found
                .into_iter()
                .find(|f| matches!(f.kind, WarningKind::InsideSolid { .. }))
        };
        let in_wall = found(&[-0.5, 0.0, 0.25, 0.4]).expect("inside");
        assert_eq!(in_wall.frames, FrameRuns::of([2, 3]));
        assert_eq!(found(&[-0.5, 0.0, -0.25, -0.4]), None);
    }

    #[test]
    fn cuts_into_a_solid_are_found() {
        let scene = scene(vec![hall(), pillar()], &[]);
        let camera = |x: f64| still(DVec3::new(x, 1.0, 0.0), DVec3::NEG_Z);
        let mut frames = open_shot([-1.0, -1.1, 0.2, 0.3, 2.0].map(camera).to_vec());
        frames.cuts.push(1);
        frames.cuts.push(3);
        let found = find(&scene, &frames, NEAR);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].frames, FrameRuns::of([2, 3]));
        assert!(matches!(
            found[0].kind,
            WarningKind::InsideSolid { frame: 3, .. }
        ));
    }

    #[test]
    fn a_path_that_stays_in_a_solid_is_told_from_one_in_a_room() {
        let ball = (DVec3::new(0.0, 1.5, 0.0), 0.9);
        let at = |x: f64| DVec3::new(x, 1.5, 0.0);
        let is_inside = |scene: &Scene| {
            let found = find(scene, &FrameCameras::of(&walk(at(-0.3), at(0.4))), 0.1);
            found
                .iter()
                .any(|f| matches!(f.kind, WarningKind::InsideSolid { .. }))
        };
        assert!(is_inside(&scene(vec![hall()], &[ball])));
        // Rooms are a ball without anything else, one within a sky, and a house on the ground.
        assert!(!is_inside(&scene(vec![], &[ball])));
        let sky = (DVec3::ZERO, 100.0);
        assert!(!is_inside(&scene(vec![], &[sky, ball])));
        let ground = cuboid(DVec3::new(-50.0, -1.0, -50.0), DVec3::new(50.0, -0.1, 50.0));
        let house = inverted(hall());
        assert!(!is_inside(&scene(vec![ground.clone(), house.clone()], &[])));
        let sky = inverted(cuboid(DVec3::splat(-99.0), DVec3::splat(99.0)));
        assert!(!is_inside(&scene(vec![ground, house, sky], &[])));
    }

    #[test]
    fn nearness_is_exact() {
        // 0.2 m above the edge of a thin plate, which rays in a few directions would miss.
        let plate = cuboid(DVec3::new(-9.0, 0.0, 0.0), DVec3::new(9.0, 1.5, 1e-4));
        let found = |within| {
            let scene = scene(vec![plate.clone()], &[]);
            let at = |x| DVec3::new(x, 1.7, 0.0);
            find(&scene, &FrameCameras::of(&walk(at(-1.0), at(1.0))), within)
        };
        assert_eq!(found(0.1999), []);
        let all = &found(0.2001)[0];
        assert_eq!(all.frames, FrameRuns::of(0..=24));
        let WarningKind::NearSurface { distance, .. } = all.kind else {
            panic!("{all:?}")
        };
        assert!((distance - 0.2).abs() < 1e-6);
    }
}
