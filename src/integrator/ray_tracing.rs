use super::direct::direct_of_neighbours;
use super::{ambient, reflect, surfaces_of_neighbours};
use crate::accel::Traversal;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// The light along camera rays, given the surfaces that they see and the direct light there:
/// local (1 - reflective) + reflective * (what the mirror sees), where local is ambient light once
/// and the direct light.
///
/// All rays are reflected together: neighbours mostly see the same mirror.
pub(super) fn radiance<F: Features>(
    scene: &Scene,
    mut rays: Vec<Ray>,
    mut surfaces: Vec<Option<Surface>>,
    mut lit: Vec<Vec3>,
    bounces: u32,
    traversal: &mut Traversal,
    radiance: &mut [Vec3],
) {
    // The number of each ray, and its share in that one's light.
    let mut owners: Vec<(usize, Vec3)> = (0..rays.len()).map(|n| (n, Vec3::ONE)).collect();
    radiance.fill(Vec3::ZERO);
    for bounces_left in (0..=bounces).rev() {
        let mut reflected = Vec::new();
        let mut mirrored = Vec::new();
        for (((number, share), ray), (surface, lit)) in
            owners.iter().zip(&rays).zip(surfaces.iter().zip(&lit))
        {
            let sum = &mut radiance[*number];
            let Some(surface) = surface else {
                *sum += share * scene.background;
                continue;
            };
            let reflectance = &surface.reflectance;
            let local = ambient(scene) * reflectance.diffuse + lit;
            *sum += share * reflectance.own::<F>() * local;
            let share = share * reflectance.mirror::<F>();
            if share == Vec3::ZERO {
                continue;
            }
            if bounces_left == 0 {
                *sum += share * ambient(scene);
            } else {
                reflected.push(reflect(surface, ray));
                mirrored.push((*number, share));
            }
        }
        if reflected.is_empty() {
            return;
        }
        (rays, owners) = (reflected, mirrored);
        surfaces = surfaces_of_neighbours::<F>(scene, &rays, traversal);
        lit = direct_of_neighbours::<F>(scene, &surfaces, &rays, traversal);
    }
}
