use crate::accel::Traversal;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// A light that reaches a surface.
pub(super) struct Lit {
    /// The number of the surface.
    pub(super) number: usize,
    /// The number of the light.
    pub(super) light: usize,
    /// The unit direction to it.
    direction: Vec3,
    /// The cosine of its angle to the surface's geometric normal.
    pub(super) cosine: f32,
    /// How far away it is.
    pub(super) distance: f32,
}

/// [`direct_of`] surfaces side by side: their shadow rays run so, too.
pub(super) fn direct_of_neighbours<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    let occluded = |rays: &[Ray], occluded: &mut [bool]| {
        scene.occluded_of_packet(rays, occluded, traversal);
    };
    direct_of::<F>(scene, seen, rays, occluded, |_| {})
}

/// [`direct_of`] surfaces all over the scene.
pub(super) fn direct_of_wave<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
    reached: impl FnMut(&Lit),
) -> Vec<Vec3> {
    let occluded = |rays: &[Ray], occluded: &mut [bool]| {
        scene.occluded_of_wave(rays, occluded, traversal);
    };
    direct_of::<F>(scene, seen, rays, occluded, reached)
}

/// The light of all point lights that the surfaces, without their mirrors, send back along `rays`.
///
/// A light behind a surface's shape or behind its shading normal does not reach it, and a surface that
/// sends none of it back asks for none. All shadow rays of a light are asked for at once; `reached` is
/// told of every light that reaches a surface.
fn direct_of<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    mut occluded: impl FnMut(&[Ray], &mut [bool]),
    mut reached: impl FnMut(&Lit),
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; seen.len()];
    let mut is_occluded = vec![false; seen.len()];
    let mut shadow_rays = Vec::with_capacity(seen.len());
    let mut facing = Vec::with_capacity(seen.len());
    let surfaces: Vec<(usize, &Surface)> = (0..)
        .zip(seen)
        .filter_map(|(number, surface)| Some((number, surface.as_ref()?)))
        .filter(|(_, surface)| surface.reflectance.reflects_light::<F>())
        .collect();
    for (light_number, light) in scene.lights.iter().enumerate() {
        shadow_rays.clear();
        facing.clear();
        for &(number, surface) in &surfaces {
            let to_light = light.position - surface.position;
            let distance = to_light.length();
            let height = to_light.dot(surface.geometric_normal);
            if height > 0.0 && to_light.dot(surface.shading_normal) > 0.0 && distance > 0.0 {
                let direction = to_light / distance;
                shadow_rays.push(surface.towards(light.position, direction, distance));
                facing.push((
                    Lit {
                        number,
                        light: light_number,
                        direction,
                        cosine: height / distance,
                        distance,
                    },
                    surface,
                ));
            }
        }
        let is_occluded = &mut is_occluded[..shadow_rays.len()];
        occluded(&shadow_rays, is_occluded);
        for ((lit, surface), is_occluded) in facing.iter().zip(is_occluded) {
            if !*is_occluded {
                let reflected = surface.reflectance.reflect_light::<F>(
                    surface.shading_normal,
                    lit.direction,
                    -rays[lit.number].direction,
                );
                sums[lit.number] += reflected * light.color_at(lit.distance * lit.distance);
                reached(lit);
            }
        }
    }
    sums
}
