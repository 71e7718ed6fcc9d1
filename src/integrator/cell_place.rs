//! Where the record of a cell stands, and what sees it.

use crate::accel::QueryState;
use crate::geometry::Hit;
use crate::irradiance_cache::{CellKey, IrradianceRecord};
use crate::material::FeatureMask;
use crate::math::Ray;
use crate::sampling::SobolSequence;
use crate::scene::{Scene, SurfacePoint};
use glam::{Vec3, Vec3Swizzles};

/// The sine of the elevation above which surfaces are others that may stand between a record and points around it: the own one
/// may be curved. Where lower ones stand records are so much smaller that larger ones do not count.
const OBSTRUCTION_SINE: f64 = 0.15;

/// What stands on the plane of a record is nearer at its foot than where it rises above that elevation.
const FREE: f64 = 0.98;

/// The height of a record's eye, in radii.
const EYE_HEIGHT: f32 = 0.15;

/// The record of a cell, valid up to a radius in metres, and the surface point where it stands; none if rays find none.
pub fn record_in_cell(
    scene: &Scene,
    cell: &CellKey,
    radius: f32,
    seed: u32,
    query_state: &mut QueryState,
) -> Option<(SurfacePoint, IrradianceRecord)> {
    let point = place_in_cell(scene, cell, seed, query_state)?;
    let within = f64::from(radius) / FREE;
    let clearance = scene.clearance(&point, OBSTRUCTION_SINE, within);
    let record = IrradianceRecord {
        position: point.position,
        normal: point.shading_normal,
        radius,
        eye: eye_above(scene, &point, EYE_HEIGHT * radius, query_state),
        free_radius: clearance.map_or(radius, |distance| (FREE * distance) as f32),
    };
    Some((point, record))
}

/// Whether a surface point within the radius of a record is on its surface and sees it.
pub fn sees_record(
    scene: &Scene,
    point: &SurfacePoint,
    record: &IrradianceRecord,
    query_state: &mut QueryState,
) -> bool {
    !record.is_doubtful(point.position, point.shading_normal)
        || sees_eye(scene, point, record.eye, query_state)
}

/// Whether a surface point sees the eye of a record.
pub fn sees_eye(
    scene: &Scene,
    point: &SurfacePoint,
    eye: Vec3,
    query_state: &mut QueryState,
) -> bool {
    sight_ray(point, eye).is_some_and(|ray| !scene.occluded(&ray, query_state))
}

/// The ray from a surface point to the eye of a record; none if that is below its horizon.
pub(super) fn sight_ray(point: &SurfacePoint, eye: Vec3) -> Option<Ray> {
    let origin = point.spawn_origin();
    let direction = eye - origin;
    (direction.dot(point.geometric_normal) > 0.0).then_some(Ray {
        origin,
        direction,
        t_max: 1.0,
        exclude: point.exclude,
    })
}

/// A surface point of a cell that faces its way, found by rays along its axis; none if they find none, as where a surface
/// only grazes the cell. It depends on scene, cell and seed alone.
pub(super) fn place_in_cell(
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
        let mut ray = Ray::new(top + u * axis.yzx().abs() + v * axis.zxy().abs(), -axis);
        let mut left = side;
        for _ in 0..LAYERS {
            let Some(hit) = closest_within(scene, &ray, left, query_state) else {
                break;
            };
            let point = scene.surface::<FeatureMask<0>>(&ray, &hit).point;
            if cell.faces(point.shading_normal) {
                return Some(point);
            }
            let below = point.position - point.geometric_normal * point.offset;
            left = side - (top - below).dot(axis);
            ray = Ray {
                origin: below,
                exclude: point.exclude,
                ..ray
            };
        }
    }
    None
}

/// A point above a surface point, at up to `height` metres, with nothing in between.
fn eye_above(
    scene: &Scene,
    point: &SurfacePoint,
    height: f32,
    query_state: &mut QueryState,
) -> Vec3 {
    let ray = point.spawn_ray(point.geometric_normal);
    let free = closest_within(scene, &ray, 2.0 * height, query_state)
        .map_or(2.0 * height, |hit| hit.t as f32);
    point.position + 0.5 * free * point.geometric_normal
}

/// The closest hit of a ray of unit direction that is no farther than `length` metres.
fn closest_within(
    scene: &Scene,
    ray: &Ray,
    length: f32,
    query_state: &mut QueryState,
) -> Option<Hit> {
    let hit = scene.closest(ray, query_state);
    hit.filter(|hit| hit.t <= f64::from(length))
}
