use super::direct::direct;
use super::{ambient, reflect};
use crate::accel::Traversal;
use crate::math::Ray;
use crate::scene::Scene;
use glam::Vec3;

/// local (1 - reflective) + reflective * (what the mirror sees), where local is ambient light once
/// and the direct light.
pub(super) fn radiance(
    scene: &Scene,
    mut ray: Ray,
    bounces: u32,
    traversal: &mut Traversal,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    let mut throughput = Vec3::ONE;
    for _ in 0..=bounces {
        let Some(hit) = scene.closest(&ray, traversal) else {
            return sum + throughput * scene.background;
        };
        let surface = scene.surface(&ray, &hit);
        let reflective = surface.reflectance.reflective;
        let own = throughput * (Vec3::ONE - reflective);
        if own != Vec3::ZERO {
            let lit = direct(scene, &surface, -ray.direction, traversal);
            sum += own * (ambient(scene) * surface.reflectance.diffuse + lit);
        }
        throughput *= reflective;
        if throughput == Vec3::ZERO {
            return sum;
        }
        ray = reflect(&surface, &ray);
    }
    sum + throughput * ambient(scene)
}
