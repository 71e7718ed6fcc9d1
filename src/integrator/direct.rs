//! Direct light of all point lights at many surfaces at once.

use crate::accel::{PACKET, Points, Sight, Traversal};
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// A light that illuminates a surface without occlusion.
pub(super) struct LightContribution {
    /// The surface's index.
    pub(super) surface: usize,
    /// The light's index.
    pub(super) light: usize,
    /// The distance between the two.
    pub(super) distance: f32,
    /// The cosine between the direction to the light and the surface's geometric normal.
    pub(super) cosine: f32,
}

/// [`direct_lighting`] of surfaces side by side, whose shadow rays are coherent.
pub(super) fn direct_lighting_coherent<F: Features>(
    scene: &Scene,
    surfaces: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    let occluded = |sights: &[Sight]| {
        let of_sight = |sight| scene.occluded_of_sight(sight, traversal);
        sights.iter().map(of_sight).collect()
    };
    direct_lighting::<F>(scene, surfaces, rays, occluded, |_| {})
}

/// [`direct_lighting`] of surfaces all over the scene.
pub(super) fn direct_lighting_incoherent<F: Features>(
    scene: &Scene,
    surfaces: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
    on_contribution: impl FnMut(&LightContribution),
) -> Vec<Vec3> {
    let occluded = |sights: &[Sight]| scene.occluded_of_sights(sights, traversal);
    direct_lighting::<F>(scene, surfaces, rays, occluded, on_contribution)
}

/// The light of all point lights that the surfaces' base layers, without their mirrors, reflect against `rays`.
///
/// A light behind a surface's geometric or shading normal does not reach it. Shadow rays are traced only from
/// surfaces that reflect light, and all of one light together. `on_contribution` is called for every light
/// that reaches a surface.
fn direct_lighting<F: Features>(
    scene: &Scene,
    surfaces: &[Option<Surface>],
    rays: &[Ray],
    mut occluded: impl FnMut(&[Sight]) -> Vec<u32>,
    mut on_contribution: impl FnMut(&LightContribution),
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; surfaces.len()];
    let reflecting: Vec<(usize, &Surface)> = (0..)
        .zip(surfaces)
        .filter_map(|(index, surface)| Some((index, surface.as_ref()?)))
        .filter(|(_, surface)| surface.reflectance.reflects_light::<F>())
        .collect();
    let packets = reflecting.chunks(PACKET).map(|surfaces| {
        let mut points = Points::default();
        for (_, surface) in surfaces {
            points.push(&surface.point);
        }
        points
    });
    let packets: Vec<Points> = packets.collect();
    let mut sights = Vec::with_capacity(packets.len());
    for (light_index, light) in scene.lights.iter().enumerate() {
        sights.clear();
        sights.extend(packets.iter().map(|p| scene.look(p, light.position)));
        let is_occluded = occluded(&sights);
        let packets = reflecting.chunks(PACKET).zip(&sights).zip(&is_occluded);
        for ((surfaces, sight), occluded) in packets {
            for lane in sight.clear(*occluded) {
                let (index, surface) = surfaces[lane];
                let distance = sight.distance(lane);
                let reflected = surface.reflectance.reflect_light::<F>(
                    surface.point.shading_normal,
                    sight.direction(lane),
                    -rays[index].direction,
                );
                sums[index] += reflected * light.color_at(distance * distance);
                on_contribution(&LightContribution {
                    surface: index,
                    light: light_index,
                    distance,
                    cosine: sight.cosine(lane),
                });
            }
        }
    }
    sums
}
