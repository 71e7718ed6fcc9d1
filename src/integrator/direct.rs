use crate::accel::{PACKET, Points, Sight, Traversal};
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
    let occluded = |sights: &[Sight]| {
        let of_sight = |sight| scene.occluded_of_sight(sight, traversal);
        sights.iter().map(of_sight).collect()
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
    let occluded = |sights: &[Sight]| scene.occluded_of_sights(sights, traversal);
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
    mut occluded: impl FnMut(&[Sight]) -> Vec<u32>,
    mut reached: impl FnMut(&Lit),
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; seen.len()];
    let surfaces: Vec<(usize, &Surface)> = (0..)
        .zip(seen)
        .filter_map(|(number, surface)| Some((number, surface.as_ref()?)))
        .filter(|(_, surface)| surface.reflectance.reflects_light::<F>())
        .collect();
    let packets = surfaces.chunks(PACKET).map(|surfaces| {
        let mut points = Points::default();
        for (_, surface) in surfaces {
            points.push(&surface.point);
        }
        points
    });
    let packets: Vec<Points> = packets.collect();
    let mut sights = Vec::with_capacity(packets.len());
    for (light_number, light) in scene.lights.iter().enumerate() {
        sights.clear();
        sights.extend(packets.iter().map(|p| scene.look(p, light.position)));
        let is_occluded = occluded(&sights);
        for ((surfaces, sight), occluded) in surfaces.chunks(PACKET).zip(&sights).zip(&is_occluded)
        {
            for lane in sight.clear(*occluded) {
                let (number, surface) = surfaces[lane];
                let distance = sight.distance(lane);
                let reflected = surface.reflectance.reflect_light::<F>(
                    surface.point.shading_normal,
                    sight.direction(lane),
                    -rays[number].direction,
                );
                sums[number] += reflected * light.color_at(distance * distance);
                reached(&Lit {
                    number,
                    light: light_number,
                    distance,
                    cosine: sight.cosine(lane),
                });
            }
        }
    }
    sums
}
