use crate::accel::Traversal;
use crate::light::PointLight;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// [`direct_of`] surfaces side by side: their shadow rays run so, too.
pub(super) fn direct_of_neighbours<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    direct_of::<F>(scene, seen, rays, |rays, occluded| {
        scene.occluded_of_packet(rays, occluded, traversal);
    })
}

/// [`direct_of`] surfaces all over the scene.
pub(super) fn direct_of_wave<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    direct_of::<F>(scene, seen, rays, |rays, occluded| {
        scene.occluded_of_wave(rays, occluded, traversal);
    })
}

/// The light of all point lights that the surfaces, without their mirrors, send back along `rays`.
///
/// A light behind a surface's shape or behind its shading normal does not reach it, and a perfect mirror
/// sends none of it. All shadow rays of a light are asked for at once.
fn direct_of<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    mut occluded: impl FnMut(&[Ray], &mut [bool]),
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; seen.len()];
    let mut shadow_rays = Vec::with_capacity(seen.len());
    let mut contributions = Vec::with_capacity(seen.len());
    let mut is_occluded = vec![false; seen.len()];
    for light in &scene.lights {
        shadow_rays.clear();
        contributions.clear();
        for (number, (surface, ray)) in seen.iter().zip(rays).enumerate() {
            if let Some(surface) = surface
                && let Some((light, shadow_ray)) = unoccluded::<F>(light, surface, -ray.direction)
            {
                shadow_rays.push(shadow_ray);
                contributions.push((number, light));
            }
        }
        let is_occluded = &mut is_occluded[..shadow_rays.len()];
        occluded(&shadow_rays, is_occluded);
        for ((number, light), is_occluded) in contributions.iter().zip(is_occluded) {
            if !*is_occluded {
                sums[*number] += light;
            }
        }
    }
    sums
}

/// What a light would add if nothing were in the way, and the ray that finds out; none if it adds
/// nothing.
fn unoccluded<F: Features>(
    light: &PointLight,
    surface: &Surface,
    viewer: Vec3,
) -> Option<(Vec3, Ray)> {
    if surface.reflectance.own::<F>() == Vec3::ZERO {
        return None;
    }
    let to_light = light.position - surface.position;
    if to_light.dot(surface.geometric_normal) <= 0.0 {
        return None;
    }
    let distance_squared = to_light.length_squared();
    let distance = distance_squared.sqrt();
    let direction = to_light / distance;
    let reflected =
        surface
            .reflectance
            .reflect_light::<F>(surface.shading_normal, direction, viewer);
    let contribution = reflected * light.color_at(distance_squared);
    if contribution == Vec3::ZERO {
        return None;
    }
    let shadow_ray = surface.towards(light.position, direction, distance);
    Some((contribution, shadow_ray))
}
