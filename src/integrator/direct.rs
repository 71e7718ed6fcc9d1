use crate::accel::{PACKET, Traversal};
use crate::light::PointLight;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// The light of all point lights that the surface, without its mirror, sends to the viewer.
///
/// `viewer` is the unit direction to the viewer. A light behind the surface's shape or behind its
/// shading normal does not reach it, and a perfect mirror sends none of it.
pub(super) fn direct<F: Features>(
    scene: &Scene,
    surface: &Surface,
    viewer: Vec3,
    traversal: &mut Traversal,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for light in &scene.lights {
        if let Some((light, shadow_ray)) = unoccluded::<F>(light, surface, viewer)
            && !scene.occluded(&shadow_ray, traversal)
        {
            sum += light;
        }
    }
    sum
}

/// As [`direct`], for the surfaces that camera rays see: their shadow rays run side by side.
pub(super) fn direct_of_packet<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    camera_rays: &[Ray],
    traversal: &mut Traversal,
) -> [Vec3; PACKET] {
    let mut sums = [Vec3::ZERO; PACKET];
    for light in &scene.lights {
        let mut rays = [camera_rays[0]; PACKET];
        let mut owners = [(0, Vec3::ZERO); PACKET];
        let mut count = 0;
        for (number, (surface, ray)) in seen.iter().zip(camera_rays).enumerate() {
            if let Some(surface) = surface
                && let Some((light, shadow_ray)) = unoccluded::<F>(light, surface, -ray.direction)
            {
                rays[count] = shadow_ray;
                owners[count] = (number, light);
                count += 1;
            }
        }
        let mut occluded = [false; PACKET];
        scene.occluded_of_packet(&rays[..count], &mut occluded[..count], traversal);
        for ((owner, light), occluded) in owners[..count].iter().zip(occluded) {
            if !occluded {
                sums[*owner] += light;
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
