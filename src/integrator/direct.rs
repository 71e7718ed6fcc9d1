//! Direct light of all point lights at many surfaces at once.

use crate::accel::QueryState;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, ShadowPacket, SurfaceInteraction, SurfacePointPacket};
use crate::simd::PACKET_WIDTH;
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
    surfaces: &[Option<SurfaceInteraction>],
    rays: &[Ray],
    query_state: &mut QueryState,
) -> Vec<Vec3> {
    let occluded = |shadow_packets: &[ShadowPacket]| {
        let of_packet = |shadow_packet| scene.occluded_coherent(shadow_packet, query_state);
        shadow_packets.iter().map(of_packet).collect()
    };
    direct_lighting::<F>(scene, surfaces, rays, occluded, |_| {})
}

/// [`direct_lighting`] of surfaces all over the scene.
pub(super) fn direct_lighting_incoherent<F: Features>(
    scene: &Scene,
    surfaces: &[Option<SurfaceInteraction>],
    rays: &[Ray],
    query_state: &mut QueryState,
    on_contribution: impl FnMut(&LightContribution),
) -> Vec<Vec3> {
    let occluded =
        |shadow_packets: &[ShadowPacket]| scene.occluded_incoherent(shadow_packets, query_state);
    direct_lighting::<F>(scene, surfaces, rays, occluded, on_contribution)
}

/// The light of all point lights that the surfaces' base layers, without their mirrors, reflect against `rays`.
///
/// A light behind a surface's geometric or shading normal does not reach it. Shadow rays are traced only from
/// surfaces that reflect light, and all of one light together. `on_contribution` is called for every light
/// that reaches a surface.
fn direct_lighting<F: Features>(
    scene: &Scene,
    surfaces: &[Option<SurfaceInteraction>],
    rays: &[Ray],
    mut occluded: impl FnMut(&[ShadowPacket]) -> Vec<u32>,
    mut on_contribution: impl FnMut(&LightContribution),
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; surfaces.len()];
    let reflecting: Vec<(usize, &SurfaceInteraction)> = (0..)
        .zip(surfaces)
        .filter_map(|(index, surface)| Some((index, surface.as_ref()?)))
        .filter(|(_, surface)| surface.bsdf.has_direct::<F>())
        .collect();
    let packets = reflecting.chunks(PACKET_WIDTH).map(|surfaces| {
        let mut points = SurfacePointPacket::default();
        for (_, surface) in surfaces {
            points.push(&surface.point);
        }
        points
    });
    let packets: Vec<SurfacePointPacket> = packets.collect();
    let mut shadow_packets = Vec::with_capacity(packets.len());
    for (light_index, light) in scene.lights.iter().enumerate() {
        shadow_packets.clear();
        shadow_packets.extend(
            packets
                .iter()
                .map(|p| scene.shadow_rays_to(p, light.position)),
        );
        let is_occluded = occluded(&shadow_packets);
        let packets = reflecting
            .chunks(PACKET_WIDTH)
            .zip(&shadow_packets)
            .zip(&is_occluded);
        for ((surfaces, shadow_packet), occluded) in packets {
            for lane in shadow_packet.unoccluded(*occluded) {
                let (index, surface) = surfaces[lane];
                let distance = shadow_packet.distance(lane);
                let reflected = surface.bsdf.eval_cos::<F>(
                    surface.point.shading_normal,
                    shadow_packet.direction(lane),
                    -rays[index].direction,
                );
                sums[index] += reflected * light.irradiance_over_pi(distance * distance);
                on_contribution(&LightContribution {
                    surface: index,
                    light: light_index,
                    distance,
                    cosine: shadow_packet.cosine(lane),
                });
            }
        }
    }
    sums
}
