use super::direct::direct;
use super::{ambient, reflect};
use crate::accel::Traversal;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// The light that `surface`, which `ray` sees, sends along the ray, given its direct light:
/// local (1 - reflective) + reflective * (what the mirror sees), where local is ambient light once
/// and the direct light.
pub(super) fn radiance<F: Features>(
    scene: &Scene,
    mut ray: Ray,
    mut surface: Surface,
    mut lit: Vec3,
    bounces: u32,
    traversal: &mut Traversal,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    let mut throughput = Vec3::ONE;
    let mut bounces_left = bounces;
    loop {
        let reflectance = &surface.reflectance;
        sum += throughput * reflectance.own::<F>() * (ambient(scene) * reflectance.diffuse + lit);
        throughput *= reflectance.mirror::<F>();
        if throughput == Vec3::ZERO {
            return sum;
        }
        if bounces_left == 0 {
            return sum + throughput * ambient(scene);
        }
        bounces_left -= 1;
        ray = reflect(&surface, &ray);
        let Some(hit) = scene.closest(&ray, traversal) else {
            return sum + throughput * scene.background;
        };
        surface = scene.surface::<F>(&ray, &hit);
        lit = direct::<F>(scene, &surface, -ray.direction, traversal);
    }
}
