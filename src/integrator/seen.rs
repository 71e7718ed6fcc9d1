use super::{for_each_feature_set, reflect, surfaces_of_neighbours};
use crate::accel::Traversal;
use crate::material::{FeatureSet, Features};
use crate::math::Ray;
use crate::scene::{Scene, SurfacePoint};
use glam::Vec3;

/// A surface that gathers light and that the camera sees, itself or in mirrors.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Where.
    pub point: SurfacePoint,
    /// How far light goes from there to the camera.
    pub distance: f32,
    /// How many bounces are left there, at least one.
    pub left: u32,
}

/// What camera rays that run side by side see, where `bounces` bounces are counted.
pub fn seen(scene: &Scene, rays: &[Ray], bounces: u32, traversal: &mut Traversal) -> Vec<Seen> {
    SEEN[scene.features().number()](scene, rays, bounces, traversal)
}

fn seen_for<F: Features>(
    scene: &Scene,
    rays: &[Ray],
    bounces: u32,
    traversal: &mut Traversal,
) -> Vec<Seen> {
    let mut seen = Vec::new();
    let mut rays = rays.to_vec();
    let mut before = vec![0.0; rays.len()];
    for left in (1..=bounces).rev() {
        let surfaces = surfaces_of_neighbours::<F>(scene, &rays, traversal);
        let (mut reflected, mut distances) = (Vec::new(), Vec::new());
        for ((surface, ray), before) in surfaces.iter().zip(&rays).zip(&before) {
            let Some(surface) = surface else {
                continue;
            };
            let distance = before + (surface.point.position - ray.origin).length();
            if surface.reflectance.gathers::<F>() {
                seen.push(Seen {
                    point: surface.point,
                    distance,
                    left,
                });
            }
            if surface.reflectance.mirror::<F>() != Vec3::ZERO {
                reflected.push(reflect(surface, ray));
                distances.push(distance);
            }
        }
        if reflected.is_empty() {
            break;
        }
        (rays, before) = (reflected, distances);
    }
    seen
}

type SeenFor = fn(&Scene, &[Ray], u32, &mut Traversal) -> Vec<Seen>;

static SEEN: [SeenFor; FeatureSet::COUNT] = for_each_feature_set!(seen_for);
