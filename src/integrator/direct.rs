//! Direct light of all point lights at many surfaces at once.

use crate::accel::QueryState;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, ShadowPacket, SurfaceInteraction, SurfacePointPacket};
use crate::simd::{PACKET_WIDTH, Simd, WithSimd};
use glam::Vec3;
use std::marker::PhantomData;

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

/// Adds the light that rays carry to the surfaces that they hit, and that these reflect back: a white Lambert surface that
/// faces its ray the radiance of `headlight`.
pub(super) fn add_headlight<F: Features>(
    headlight: f32,
    surfaces: &[Option<SurfaceInteraction>],
    rays: &[Ray],
    sums: &mut [Vec3],
) {
    if headlight == 0.0 {
        return;
    }
    for ((surface, ray), sum) in surfaces.iter().zip(rays).zip(sums) {
        if let Some(SurfaceInteraction { point, bsdf }) = surface {
            let back = -ray.direction;
            *sum += headlight * bsdf.eval_cos::<F>(point.shading_normal, back, back);
        }
    }
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
    let mut packets = Vec::new();
    packets.resize_with(
        reflecting.len().div_ceil(PACKET_WIDTH),
        SurfacePointPacket::default,
    );
    for (points, surfaces) in packets.iter_mut().zip(reflecting.chunks(PACKET_WIDTH)) {
        for (_, surface) in surfaces {
            points.push(&surface.point);
        }
    }
    let mut shadow_packets = Vec::with_capacity(packets.len());
    let points = |light: &usize| scene.lights[*light].radius == 0.0;
    for light in (0..scene.lights.len()).filter(points) {
        let position = scene.lights[light].position;
        shadow_packets.clear();
        shadow_packets.extend(packets.iter().map(|p| scene.shadow_rays_to(p, position)));
        let occluded = occluded(&shadow_packets);
        scene.kernel().run(LightOf::<F, _> {
            scene,
            light,
            surfaces: &reflecting,
            rays,
            shadow_packets: &shadow_packets,
            occluded: &occluded,
            sums: &mut sums,
            on_contribution: &mut on_contribution,
            features: PhantomData,
        });
    }
    sums
}

/// Adds the light of one light that surfaces reflect, for every instruction set.
struct LightOf<'a, F, OnContribution> {
    scene: &'a Scene,
    light: usize,
    surfaces: &'a [(usize, &'a SurfaceInteraction)],
    rays: &'a [Ray],
    /// From the surfaces, and the masks of those that are occluded.
    shadow_packets: &'a [ShadowPacket],
    occluded: &'a [u32],
    sums: &'a mut [Vec3],
    on_contribution: &'a mut OnContribution,
    features: PhantomData<F>,
}

impl<F: Features, OnContribution: FnMut(&LightContribution)> WithSimd
    for LightOf<'_, F, OnContribution>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self) {
        let light = &self.scene.lights[self.light];
        let packets = self.surfaces.chunks(PACKET_WIDTH);
        let packets = packets.zip(self.shadow_packets).zip(self.occluded);
        for ((surfaces, shadow_packet), occluded) in packets {
            for lane in shadow_packet.unoccluded(*occluded) {
                let (index, surface) = surfaces[lane];
                let distance = shadow_packet.distance(lane);
                let to_light = shadow_packet.direction(lane);
                let reflected = surface.bsdf.eval_cos::<F>(
                    surface.point.shading_normal,
                    to_light,
                    -self.rays[index].direction,
                );
                self.sums[index] +=
                    reflected * light.irradiance_over_pi(distance * distance, -to_light);
                (self.on_contribution)(&LightContribution {
                    surface: index,
                    light: self.light,
                    distance,
                    cosine: shadow_packet.cosine(lane),
                });
            }
        }
    }
}
