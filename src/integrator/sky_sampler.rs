//! Shadow rays to the sky: towards where it is seen, where it is bright, and anywhere.

use super::sky_guide::{SkyGuide, SkyView};
use crate::light::Sky;
use crate::math::to_world;
use crate::sampling::cosine_hemisphere;
use crate::scene::{Scene, SurfacePoint};
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// A part of the scene that gets more than this part of a uniform sky needs no guide: directions by the cosine are as good.
const OPEN: f32 = 0.4;

/// How often the edge of a part is doubled in whose view what the part's own view misses is looked for.
const WIDER: u32 = 2;

/// Camera samples whose surfaces get less than this part of the sky, in the mean, are in a room.
const ROOM: f32 = 0.15;

/// Chooses directions to the sky from surfaces. None for a black sky.
#[derive(Clone, Debug)]
pub(super) struct SkySampler {
    guide: Arc<SkyGuide>,
    /// Whether paths have shadow rays to the sky beside those that find it.
    pub(super) guides_paths: bool,
}

/// The directions in which shadow rays to the sky leave a surface: a mixture of techniques.
#[derive(Clone, Copy)]
pub(super) struct SkyTechniques<'a> {
    scene: &'a Scene,
    shading_normal: Vec3,
    /// From the part, and from a wider one.
    views: [Option<&'a SkyView>; 2],
    /// The probabilities of the views, of the cosine and of the sky's own brightness.
    by_views: [f32; 2],
    by_cosine: f32,
    by_brightness: f32,
}

impl SkySampler {
    /// Of a scene; none if its sky is black.
    pub(super) fn new(scene: &Scene) -> Option<SkySampler> {
        (!scene.sky.is_black()).then(|| SkySampler {
            guide: Arc::new(SkyGuide::new(scene)),
            guides_paths: matches!(scene.sky, Sky::Map(_)),
        })
    }

    /// The same sampler for paths that start at these surfaces: guides those in rooms. A uniform sky in the open is best
    /// found by the paths themselves.
    pub(super) fn for_surfaces<'s>(
        mut self,
        scene: &Scene,
        points: impl Iterator<Item = &'s SurfacePoint>,
    ) -> SkySampler {
        let openness = points.map(|point| {
            let view = self
                .guide
                .view(scene, point.position, point.shading_normal, 0);
            view.map_or(0.0, |view| view.openness)
        });
        let openness: Vec<f32> = openness.collect();
        // Where next to no sky is seen there is nothing to find.
        let mean = openness.iter().sum::<f32>() / openness.len() as f32;
        self.guides_paths |= mean > 0.0 && mean < ROOM;
        self
    }

    /// The techniques at a surface.
    pub(super) fn techniques<'a>(
        &'a self,
        scene: &'a Scene,
        position: Vec3,
        shading_normal: Vec3,
    ) -> SkyTechniques<'a> {
        let is_map = matches!(scene.sky, Sky::Map(_));
        let view = |wider| self.guide.view(scene, position, shading_normal, wider);
        let is_guide = |view: &&SkyView| is_map || view.openness < OPEN;
        let own = view(0);
        // What a part's own view misses is mostly known around it; an open part needs neither.
        let views = if own.as_ref().is_none_or(is_guide) {
            [own, view(WIDER).filter(is_guide)]
        } else {
            [None; 2]
        };
        let shares = match views.map(|view| view.is_some()) {
            [true, true] => [0.6, 0.2],
            [true, false] => [0.75, 0.0],
            [false, true] => [0.0, 0.75],
            [false, false] => [0.0, 0.0],
        };
        let by_cosine = 1.0 - shares[0] - shares[1];
        let by_brightness = match is_map {
            true if by_cosine < 1.0 => 0.3,
            true => 0.5,
            false => 0.0,
        };
        SkyTechniques {
            scene,
            shading_normal,
            views,
            by_views: shares.map(|share| share * (1.0 - by_brightness)),
            by_cosine: by_cosine * (1.0 - by_brightness),
            by_brightness,
        }
    }
}

impl SkyTechniques<'_> {
    /// A direction and its pdf, over solid angle, by numbers in [0, 1).
    pub(super) fn sample(&self, choice: f32, numbers: [f32; 2]) -> (Vec3, f32) {
        let [own, wide] = self.by_views;
        let direction = match self.views {
            [Some(view), _] if choice < own => view.directions.sample(numbers),
            [_, Some(view)] if choice < own + wide => view.directions.sample(numbers),
            _ if choice >= 1.0 - self.by_brightness => self.scene.sky.sample(numbers).0,
            _ => {
                let [u, v] = numbers;
                to_world(self.shading_normal, cosine_hemisphere(u, v))
            }
        };
        (direction, self.pdf(direction))
    }

    /// The pdf of a unit direction, over solid angle.
    pub(super) fn pdf(&self, direction: Vec3) -> f32 {
        let mut pdf = self.by_cosine * direction.dot(self.shading_normal).max(0.0) / PI;
        for (view, share) in self.views.iter().zip(self.by_views) {
            if let Some(view) = view {
                pdf += share * view.directions.pdf(direction);
            }
        }
        if self.by_brightness > 0.0 {
            pdf += self.by_brightness * self.scene.sky.pdf(direction);
        }
        pdf
    }
}
