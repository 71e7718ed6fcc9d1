use crate::accel::Traversal;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, ShadowPacket, Surface, SurfacePointPacket};
use crate::simd::PACKET_WIDTH;
use glam::Vec3;

/// A light that reaches a surface.
pub(super) struct Lit {
    /// The number of the surface.
    pub(super) number: usize,
    /// The number of the light.
    pub(super) light: usize,
    /// How far away it is.
    pub(super) distance: f32,
    /// The cosine of its angle to the surface's geometric normal.
    pub(super) cosine: f32,
}

/// [`direct_of`] surfaces side by side: their shadow rays run so, too.
pub(super) fn direct_of_neighbours<F: Features>(
    scene: &Scene,
    seen: &[Option<Surface>],
    rays: &[Ray],
    traversal: &mut Traversal,
) -> Vec<Vec3> {
    let occluded = |shadow_packets: &[ShadowPacket]| {
        let of_packet = |shadow_packet| scene.occluded_coherent(shadow_packet, traversal);
        shadow_packets.iter().map(of_packet).collect()
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
    let occluded =
        |shadow_packets: &[ShadowPacket]| scene.occluded_incoherent(shadow_packets, traversal);
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
    mut occluded: impl FnMut(&[ShadowPacket]) -> Vec<u32>,
    mut reached: impl FnMut(&Lit),
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; seen.len()];
    let surfaces: Vec<(usize, &Surface)> = (0..)
        .zip(seen)
        .filter_map(|(number, surface)| Some((number, surface.as_ref()?)))
        .filter(|(_, surface)| surface.reflectance.reflects_light::<F>())
        .collect();
    let packets = surfaces.chunks(PACKET_WIDTH).map(|surfaces| {
        let mut points = SurfacePointPacket::default();
        for (_, surface) in surfaces {
            points.push(&surface.point);
        }
        points
    });
    let packets: Vec<SurfacePointPacket> = packets.collect();
    let mut shadow_packets = Vec::with_capacity(packets.len());
    for (light_number, light) in scene.lights.iter().enumerate() {
        shadow_packets.clear();
        shadow_packets.extend(
            packets
                .iter()
                .map(|p| scene.shadow_rays_to(p, light.position)),
        );
        let is_occluded = occluded(&shadow_packets);
        for ((surfaces, shadow_packet), occluded) in surfaces
            .chunks(PACKET_WIDTH)
            .zip(&shadow_packets)
            .zip(&is_occluded)
        {
            for lane in shadow_packet.unoccluded(*occluded) {
                let (number, surface) = surfaces[lane];
                let distance = shadow_packet.distance(lane);
                let reflected = surface.reflectance.reflect_light::<F>(
                    surface.point.shading_normal,
                    shadow_packet.direction(lane),
                    -rays[number].direction,
                );
                sums[number] += reflected * light.color_at(distance * distance);
                reached(&Lit {
                    number,
                    light: light_number,
                    distance,
                    cosine: shadow_packet.cosine(lane),
                });
            }
        }
    }
    sums
}
