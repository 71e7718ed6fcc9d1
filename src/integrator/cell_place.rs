//! Where the record of a cell stands.

use crate::accel::QueryState;
use crate::irradiance_cache::CellKey;
use crate::material::FeatureMask;
use crate::math::{NO_PRIMITIVE, Ray};
use crate::sampling::SobolSequence;
use crate::scene::{Scene, SurfacePoint};
use glam::{Vec3, Vec3Swizzles};

/// The sine of the elevation above which surfaces are others that may stand between a record and points around it: the own one
/// may be curved. Where lower ones stand records are so much smaller that larger ones do not count.
const OBSTRUCTION_SINE: f64 = 0.15;

/// A surface point of a cell that faces its way, found by rays along its axis; none if they find none, as where a surface
/// only grazes the cell. It depends on scene, cell and seed alone.
pub fn place_in_cell(
    scene: &Scene,
    cell: &CellKey,
    seed: u32,
    query_state: &mut QueryState,
) -> Option<SurfacePoint> {
    /// The first rays go through the middle half of the cell, so that the point is near all others of the cell.
    const MIDDLE: u32 = 4;
    const ALL: u32 = 12;
    /// Surfaces that one ray passes.
    const LAYERS: u32 = 4;
    let (bounds, axis, side) = (cell.bounds(), cell.axis(), cell.side());
    let [level_and_facing, x, y, z] = cell.words();
    let sequence = SobolSequence::new(seed ^ level_and_facing, x, y, z);
    let top = bounds.center() + 0.5 * side * axis;
    for index in 0..ALL {
        let width = if index < MIDDLE { 0.5 * side } else { side };
        let [u, v] = sequence.sample_2d(index, 0).map(|u| (u - 0.5) * width);
        let mut ray = Ray {
            origin: top + u * axis.yzx().abs() + v * axis.zxy().abs(),
            direction: -axis,
            t_max: side,
            exclude: NO_PRIMITIVE,
        };
        for _ in 0..LAYERS {
            let Some(hit) = scene.closest(&ray, query_state) else {
                break;
            };
            let point = scene.surface::<FeatureMask<0>>(&ray, &hit).point;
            if cell.faces(point.shading_normal) {
                return Some(point);
            }
            let below = point.position - point.geometric_normal * point.offset;
            ray = Ray {
                t_max: side - (top - below).dot(axis),
                origin: below,
                exclude: point.exclude,
                ..ray
            };
        }
    }
    None
}

/// A point above a surface point, at up to `height` metres, with nothing in between.
pub fn eye_above(
    scene: &Scene,
    point: &SurfacePoint,
    height: f32,
    query_state: &mut QueryState,
) -> Vec3 {
    let ray = Ray {
        t_max: 2.0 * height,
        ..point.spawn_ray(point.geometric_normal)
    };
    let free = scene
        .closest(&ray, query_state)
        .map_or(2.0 * height, |hit| hit.t as f32);
    point.position + 0.5 * free * point.geometric_normal
}

/// Whether other surfaces near a surface point may stand between it and points up to `radius` metres away.
pub fn is_obstructed(scene: &Scene, point: &SurfacePoint, radius: f32) -> bool {
    scene
        .clearance(point, OBSTRUCTION_SINE, radius.into())
        .is_some()
}

/// Whether a surface point sees a position above it.
pub fn sees(
    scene: &Scene,
    point: &SurfacePoint,
    position: Vec3,
    query_state: &mut QueryState,
) -> bool {
    let origin = point.spawn_origin();
    let ray = Ray {
        origin,
        direction: position - origin,
        t_max: 1.0,
        exclude: point.exclude,
    };
    ray.direction.dot(point.geometric_normal) > 0.0 && !scene.occluded(&ray, query_state)
}
