use super::direct::direct_of_neighbours;
use super::{ambient, reflect, surfaces_of_neighbours};
use crate::accel::Traversal;
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// Rays after so many reflections that `bounces_left` more are counted; all lists are of one length.
pub(super) struct Step {
    pub(super) rays: Vec<Ray>,
    /// The camera sample that each ray belongs to, and its share in that one's light.
    pub(super) owners: Vec<(usize, Vec3)>,
    /// What each ray sees.
    pub(super) surfaces: Vec<Option<Surface>>,
    /// The direct light there.
    pub(super) lit: Vec<Vec3>,
    pub(super) bounces_left: u32,
}

impl Step {
    /// Of camera rays.
    pub(super) fn first(
        rays: Vec<Ray>,
        surfaces: Vec<Option<Surface>>,
        lit: Vec<Vec3>,
        bounces_left: u32,
    ) -> Step {
        Step {
            owners: (0..rays.len()).map(|n| (n, Vec3::ONE)).collect(),
            rays,
            surfaces,
            lit,
            bounces_left,
        }
    }
}

/// The light along camera rays: local (1 - reflective) + reflective * (what the mirror sees), where local is
/// the direct light and what the surface makes of the indirect light, which `indirect` gives for each
/// ray of a step.
///
/// All rays are reflected together: neighbours mostly see the same mirror.
pub(super) fn radiance<F: Features>(
    scene: &Scene,
    mut step: Step,
    indirect: impl Fn(&Step, &mut Traversal) -> Vec<Vec3>,
    traversal: &mut Traversal,
    radiance: &mut [Vec3],
) {
    radiance.fill(Vec3::ZERO);
    loop {
        let indirect = indirect(&step, traversal);
        let mut reflected = Vec::new();
        let mut mirrored = Vec::new();
        for (i, (number, share)) in step.owners.iter().enumerate() {
            let sum = &mut radiance[*number];
            let Some(surface) = &step.surfaces[i] else {
                *sum += share * scene.background;
                continue;
            };
            let reflectance = &surface.reflectance;
            let local = indirect[i] * reflectance.diffuse + step.lit[i];
            *sum += share * reflectance.own::<F>() * local;
            let share = share * reflectance.mirror::<F>();
            if share == Vec3::ZERO {
                continue;
            }
            if step.bounces_left == 0 {
                *sum += share * ambient(scene);
            } else {
                reflected.push(reflect(surface, &step.rays[i]));
                mirrored.push((*number, share));
            }
        }
        if reflected.is_empty() {
            return;
        }
        let surfaces = surfaces_of_neighbours::<F>(scene, &reflected, traversal);
        step = Step {
            lit: direct_of_neighbours::<F>(scene, &surfaces, &reflected, traversal),
            rays: reflected,
            owners: mirrored,
            surfaces,
            bounces_left: step.bounces_left - 1,
        };
    }
}
