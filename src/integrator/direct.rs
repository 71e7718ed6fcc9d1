use crate::accel::Traversal;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// The light of all point lights that the surface, without its mirror, sends to the viewer.
///
/// `viewer` is the unit direction to the viewer. A light behind the surface's shape or behind its
/// shading normal does not reach it.
pub(super) fn direct(
    scene: &Scene,
    surface: &Surface,
    viewer: Vec3,
    traversal: &mut Traversal,
) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for light in &scene.lights {
        let to_light = light.position - surface.position;
        if to_light.dot(surface.geometric_normal) <= 0.0 {
            continue;
        }
        let distance_squared = to_light.length_squared();
        let distance = distance_squared.sqrt();
        let direction = to_light / distance;
        let reflected =
            surface
                .reflectance
                .reflect_light(surface.shading_normal, direction, viewer);
        let contribution = reflected * light.color_at(distance_squared);
        if contribution == Vec3::ZERO {
            continue;
        }
        let shadow_ray = surface.towards(light.position, direction, distance);
        if !scene.occluded(&shadow_ray, traversal) {
            sum += contribution;
        }
    }
    sum
}
