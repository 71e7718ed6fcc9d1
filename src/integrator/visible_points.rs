//! The diffuse surfaces that the camera sees, directly and in mirrors: where an irradiance cache needs records.

use super::feature_sets::for_each_feature_set;
use super::hit_surfaces::{coherent_surfaces, spawn_reflected_ray};
use crate::accel::QueryState;
use crate::material::{FeatureSet, Features};
use crate::math::Ray;
use crate::scene::{Scene, SurfacePoint};
use glam::Vec3;

/// A point of a diffuse surface that the camera sees, directly or in mirrors.
#[derive(Clone, Copy, Debug)]
pub struct VisiblePoint {
    /// The point.
    pub point: SurfacePoint,
    /// The length of the path from the camera.
    pub distance: f32,
    /// How many bounces are left there, at least one.
    pub bounces_left: u32,
}

/// What coherent camera rays see, by paths of up to `bounces` bounces.
pub fn visible_points(
    scene: &Scene,
    rays: &[Ray],
    bounces: u32,
    query_state: &mut QueryState,
) -> Vec<VisiblePoint> {
    VISIBLE_POINTS[scene.features().index()](scene, rays, bounces, query_state)
}

type VisiblePointsFor = fn(&Scene, &[Ray], u32, &mut QueryState) -> Vec<VisiblePoint>;

/// [`visible_points`] for each set of features.
static VISIBLE_POINTS: [VisiblePointsFor; FeatureSet::COUNT] =
    for_each_feature_set!(visible_points_for);

fn visible_points_for<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    bounces: u32,
    query_state: &mut QueryState,
) -> Vec<VisiblePoint> {
    let mut visible = Vec::new();
    let mut rays = rays.to_vec();
    let mut lengths = vec![0.0; rays.len()];
    for bounces_left in (1..=bounces).rev() {
        let surfaces = coherent_surfaces::<F>(scene, &rays, &[], query_state).surfaces;
        let (mut reflected, mut distances) = (Vec::new(), Vec::new());
        for ((surface, ray), length) in surfaces.iter().zip(&rays).zip(&lengths) {
            let Some(surface) = surface else {
                continue;
            };
            let distance = length + (surface.point.position - ray.origin).length();
            if surface.bsdf.has_diffuse::<F>() {
                visible.push(VisiblePoint {
                    point: surface.point,
                    distance,
                    bounces_left,
                });
            }
            if surface.bsdf.mirror_weight::<F>() != Vec3::ZERO {
                reflected.push(spawn_reflected_ray(surface, ray));
                distances.push(distance);
            }
        }
        if reflected.is_empty() {
            break;
        }
        (rays, lengths) = (reflected, distances);
    }
    visible
}
