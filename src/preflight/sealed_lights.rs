//! Lights in closed bodies that the camera never enters: what they light is not seen.

use super::SceneWarning;
use super::closed_bodies::{ClosedBody, closed_bodies};
use super::inside::eye;
use crate::accel::QueryState;
use crate::camera::FrameCameras;
use crate::geometry::Sphere;
use crate::math::Ray;
use crate::sampling::uniform_sphere;
use crate::scene::{Scene, SceneNames};
use glam::Vec3;
use std::cell::OnceCell;

/// The square root of the number of directions in which something must be, around a light in a closed body.
const DIRECTIONS: usize = 8;

/// A tolerance for "inside a sphere", relative to its radius.
const ROUNDING: f64 = 1e-6;

pub(super) fn find(scene: &Scene, names: &SceneNames, frames: &FrameCameras) -> Vec<SceneWarning> {
    let bodies = OnceCell::new();
    let eyes: Vec<Vec3> = frames
        .cameras
        .iter()
        .map(|camera| eye(scene, camera))
        .collect();
    let sealed = |light: usize| {
        let source = &scene.lights[light];
        if source.intensity == Vec3::ZERO {
            return None;
        }
        let position = source.position;
        let in_sphere = scene
            .spheres()
            .iter()
            .position(|sphere| seals_sphere(sphere, position, &eyes));
        let body = match in_sphere {
            Some(sphere) => names.sphere(sphere),
            None => {
                if !is_surrounded(scene, position) || sees_any(scene, position, &eyes) {
                    return None;
                }
                let bodies: &Vec<ClosedBody> = bodies.get_or_init(|| closed_bodies(scene));
                let mut bodies = bodies.iter();
                let body = bodies.find(|body| seals(scene, body, position, &eyes))?;
                names.mesh(scene.mesh_of(body.triangles[0] as usize))
            }
        };
        Some(SceneWarning::SealedLight {
            light: names.light(light),
            position: scene.origin + position.as_dvec3(),
            body,
        })
    };
    (0..scene.lights.len()).filter_map(sealed).collect()
}

/// Whether a sphere contains the light and no camera.
fn seals_sphere(sphere: &Sphere, light: Vec3, eyes: &[Vec3]) -> bool {
    let depth = |point: Vec3| 1.0 - point.as_dvec3().distance(sphere.center) / sphere.radius;
    depth(light) > ROUNDING && eyes.iter().all(|eye| depth(*eye) < -ROUNDING)
}

/// Whether a closed body contains the light and no camera.
fn seals(scene: &Scene, body: &ClosedBody, light: Vec3, eyes: &[Vec3]) -> bool {
    let contains = |point: Vec3| body.contains(scene, point.as_dvec3());
    // Points that see each other are on the same side.
    let mut query_state = QueryState::default();
    let mut last = None;
    let mut is_new = |eye: &&Vec3| {
        let is_seen = last.is_some_and(|last| sees(scene, last, **eye, &mut query_state));
        last = Some(**eye);
        !is_seen
    };
    contains(light) == Some(true)
        && eyes
            .iter()
            .filter(&mut is_new)
            .all(|eye| contains(*eye) == Some(false))
}

/// Whether rays hit something in all directions.
fn is_surrounded(scene: &Scene, point: Vec3) -> bool {
    let at = |i: usize| (i as f32 + 0.5) / DIRECTIONS as f32;
    let directions = (0..DIRECTIONS * DIRECTIONS)
        .map(|i| uniform_sphere(at(i % DIRECTIONS), at(i / DIRECTIONS)));
    let rays: Vec<Ray> = directions
        .map(|direction| Ray::new(point, direction))
        .collect();
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(&rays, &mut hits, &mut QueryState::default());
    hits.iter().all(Option::is_some)
}

/// Whether nothing is between a light and one of the cameras: then no body separates them.
fn sees_any(scene: &Scene, light: Vec3, eyes: &[Vec3]) -> bool {
    let mut query_state = QueryState::default();
    let eyes = eyes.iter().filter(|&&eye| eye != light);
    eyes.copied()
        .any(|eye| sees(scene, light, eye, &mut query_state))
}

/// Whether nothing is between two points.
fn sees(scene: &Scene, from: Vec3, to: Vec3, query_state: &mut QueryState) -> bool {
    if from == to {
        return true;
    }
    let hit = scene.closest(&Ray::new(from, to - from), query_state);
    hit.is_none_or(|hit| hit.t > 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{cuboid, hall, inverted, lamp, lit_scene, walk};
    use super::*;
    use crate::scene::SourceMesh;
    use glam::DVec3;

    /// The lights that are found along a walk through the hall, or outside it.
    fn sealed(
        meshes: Vec<SourceMesh>,
        spheres: &[(DVec3, f64)],
        lights: &[DVec3],
        outside: bool,
    ) -> Vec<String> {
        let lights = lights.iter().map(|position| lamp(*position, 1.0)).collect();
        let scene = lit_scene(meshes, spheres, lights);
        let x = if outside { 7.0 } else { 3.0 };
        let path = walk(DVec3::new(x, 1.7, 3.0), DVec3::new(x, 1.7, -3.0));
        let found = find(&scene, &SceneNames::default(), &FrameCameras::of(&path));
        let light = |warning: SceneWarning| match warning {
            SceneWarning::SealedLight { light, .. } => light,
            other => panic!("{other:?}"),
        };
        found.into_iter().map(light).collect()
    }

    const BULB: DVec3 = DVec3::new(0.0, 3.0, 0.0);

    /// A box around the bulb, of 20 cm.
    fn shade() -> SourceMesh {
        cuboid(BULB - 0.1, BULB + 0.1)
    }

    #[test]
    fn a_lamp_in_a_ball_or_a_box_is_found() {
        let beside = DVec3::new(1.0, 3.0, 0.0);
        assert_eq!(
            sealed(vec![hall()], &[(BULB, 0.1)], &[beside, BULB], false),
            ["light 1"]
        );
        for shade in [shade(), inverted(shade())] {
            assert_eq!(
                sealed(vec![hall(), shade.clone()], &[], &[BULB, beside], false),
                ["light 0"]
            );
            assert_eq!(
                sealed(vec![shade], &[], &[beside, BULB], false),
                ["light 1"]
            );
        }
        // Whatever else is inside.
        let filament = (BULB, 0.01);
        let near = BULB + 0.05;
        assert_eq!(
            sealed(vec![hall(), shade()], &[filament], &[near], false),
            ["light 0"]
        );
    }

    #[test]
    fn a_lamp_in_a_room_is_not() {
        assert_eq!(
            sealed(vec![hall()], &[], &[BULB], false),
            Vec::<String>::new()
        );
        assert_eq!(
            sealed(
                vec![inverted(hall())],
                &[(DVec3::ZERO, 99.0)],
                &[BULB],
                false
            ),
            Vec::<String>::new()
        );
        // Behind a pillar, never seen.
        let pillar = cuboid(DVec3::new(-1.0, 0.0, -4.9), DVec3::new(2.9, 4.0, 4.9));
        let behind = DVec3::new(-3.0, 2.0, 0.0);
        assert_eq!(
            sealed(vec![hall(), pillar], &[], &[behind], false),
            Vec::<String>::new()
        );
        // But of a room that the camera never enters.
        assert_eq!(sealed(vec![hall()], &[], &[BULB], true), ["light 0"]);
    }

    #[test]
    fn an_open_shade_lets_light_out() {
        let mut open = shade();
        open.triangles.truncate(10);
        assert_eq!(
            sealed(vec![hall(), open], &[], &[BULB], false),
            Vec::<String>::new()
        );
        // Nor does a ball beside the lamp hold it, or a lamp on its surface.
        let beside = [(BULB + 0.2, 0.1), (BULB - DVec3::X, 1.0)];
        assert_eq!(
            sealed(vec![hall()], &beside, &[BULB], false),
            Vec::<String>::new()
        );
    }
}
