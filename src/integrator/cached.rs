use super::gather::{GatherPoint, gather_for};
use super::ray_tracing::Step;
use super::{CameraSample, ambient};
use crate::accel::Traversal;
use crate::illumination::Illumination;
use crate::material::Features;
use crate::scene::Scene;
use glam::Vec3;

/// Indirect light that is looked up.
pub(super) struct Cached<'a> {
    pub(super) scene: &'a Scene,
    pub(super) illumination: &'a Illumination,
    /// How many paths go on from points where nothing is known.
    pub(super) paths: u32,
    pub(super) samples: &'a [CameraSample],
}

impl Cached<'_> {
    /// The mean light that arrives from the hemisphere at each surface of a step that makes something of it.
    pub(super) fn indirect<F: Features>(
        &self,
        step: &Step,
        traversal: &mut Traversal,
    ) -> Vec<Vec3> {
        if step.bounces_left == 0 {
            return vec![ambient(self.scene); step.surfaces.len()];
        }
        let surfaces = step.surfaces.iter().enumerate();
        let (numbers, points): (Vec<usize>, Vec<GatherPoint>) = surfaces
            .filter_map(|(number, surface)| Some((number, surface.as_ref()?)))
            .filter(|(_, surface)| surface.reflectance.gathers::<F>())
            .map(|(number, surface)| {
                let sample = &self.samples[step.owners[number].0];
                let point = GatherPoint {
                    point: surface.point,
                    sequence: sample.sequence,
                    index: sample.index,
                };
                (number, point)
            })
            .unzip();
        let known = &self.illumination.visible[step.bounces_left as usize - 1];
        let where_to_look = points
            .iter()
            .map(|p| (p.point.position, p.point.shading_normal));
        let found = known.lights(&where_to_look.collect::<Vec<_>>());
        let mut lights = vec![Vec3::ZERO; step.surfaces.len()];
        let mut unknown = Vec::new();
        for ((number, point), light) in numbers.into_iter().zip(points).zip(found) {
            match light {
                Some(light) => lights[number] = light,
                None => unknown.push((number, point)),
            }
        }
        let points: Vec<GatherPoint> = unknown.iter().map(|(_, point)| *point).collect();
        let gathered = gather_for::<F>(
            self.scene,
            &points,
            step.bounces_left,
            self.paths,
            Some(&self.illumination.secondary),
            traversal,
        );
        for ((number, _), light) in unknown.iter().zip(gathered) {
            lights[*number] = light;
        }
        lights
    }
}
