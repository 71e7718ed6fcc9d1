use super::gather::{GatherPoint, gather_for};
use super::ray_tracing::Step;
use super::{CameraSample, ambient};
use crate::accel::Traversal;
use crate::irradiance_cache::IrradianceCache;
use crate::material::Features;
use crate::scene::{Scene, Surface};
use glam::Vec3;

/// How many paths go on from points where nothing is known: few see one, and every camera sample has its own.
const UNKNOWN_PATHS: u32 = 16;

/// Indirect light that is looked up.
pub(super) struct Cached<'a> {
    pub(super) scene: &'a Scene,
    pub(super) illumination: &'a IrradianceCache,
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
        let gathers = |surface: &&Surface| surface.reflectance.gathers::<F>();
        let surface = |number: usize| step.surfaces[number].as_ref().filter(gathers);
        let count = step.surfaces.len();
        let (mut numbers, mut points) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for number in 0..count {
            if let Some(Surface { point, .. }) = surface(number) {
                numbers.push(number);
                points.push((point.position, point.shading_normal));
            }
        }
        let known = &self.illumination.visible[step.bounces_left as usize - 1];
        let mut lights = vec![Vec3::ZERO; count];
        let mut unknown = Vec::new();
        for (number, light) in numbers
            .into_iter()
            .zip(known.lights(&points, self.scene.kernel()))
        {
            match light {
                Some(light) => lights[number] = light,
                None => unknown.push(number),
            }
        }
        let point = |&number: &usize| {
            let sample = &self.samples[step.owners[number].0];
            Some(GatherPoint {
                point: surface(number)?.point,
                sequence: sample.sequence,
                index: sample.index,
            })
        };
        if unknown.is_empty() {
            return lights;
        }
        let points: Vec<GatherPoint> = unknown.iter().filter_map(point).collect();
        let gathered = gather_for::<F>(
            self.scene,
            &points,
            step.bounces_left,
            UNKNOWN_PATHS,
            Some(&self.illumination.secondary),
            traversal,
        );
        for (number, light) in unknown.into_iter().zip(gathered) {
            lights[number] = light;
        }
        lights
    }
}
