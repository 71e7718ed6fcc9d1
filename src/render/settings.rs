//! The settings of frames, as plain data.

use super::ErrorEstimate;
use crate::integrator::IntegratorSettings;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// Everything beside scene and camera that decides a frame's pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RenderSettings {
    /// Columns; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// How the radiance along a camera ray is computed.
    pub integrator: IntegratorSettings,
    /// How many shadow rays leave each surface that a camera sample sees, at least one: for all emitters and lights with a
    /// radius together, for each sun that is not a point, and for the sky where shadow rays find it.
    pub shadow_rays: u32,
    /// The radiance of a white Lambert surface that faces the camera, in the light that the camera carries; 0 without.
    pub headlight: f32,
    /// Where in a pixel its camera samples lie.
    pub sampling: PixelSampling,
    /// Seeds the random numbers.
    pub seed: u32,
    /// Whether all frames use the same random numbers: noise then stands still where the camera does, and moves with
    /// the camera elsewhere. Otherwise each frame has its own.
    pub lock_seed: bool,
    /// The radiance that is displayed as white, above 0. Errors are relative to the radiance or, where that is less,
    /// to a tenth of display white.
    pub display_white: f32,
    /// Samples are added to a frame, where they reduce its error most, until the upper 95 % confidence bound of its
    /// estimated relMSE is below this; above 0. `Center` and `Corners` have no more samples, and ignore it.
    pub target_error: Option<f64>,
}

/// Where in a pixel its camera samples lie. Their mean is the pixel (box filter).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PixelSampling {
    /// One, in the middle.
    Center,
    /// Four, in the corners, shared with the neighbours: about one for each pixel of the frame.
    Corners,
    /// This many, at least 1, stratified over the pixel's square.
    Spread(u32),
    /// Stratified over the pixel's square, at least one, and as many more where they reduce the error of the frame most
    /// as it takes for a relMSE below this, of noisy frames at least [`RenderSettings::NOISE`]; the error of the irradiance
    /// cache comes to it.
    Adaptive(f64),
}

impl RenderSettings {
    /// The relMSE of hardly visible noise.
    pub const NOISE: f64 = 1e-3;

    /// The default number of shadow rays.
    pub const SHADOW_RAYS: u32 = 4;

    /// One sample in the middle of each pixel, the default number of shadow rays, seed 0, display white 1, no target error.
    pub fn new(integrator: IntegratorSettings, width: u32, height: u32) -> RenderSettings {
        RenderSettings {
            width,
            height,
            integrator,
            shadow_rays: RenderSettings::SHADOW_RAYS,
            headlight: 0.0,
            sampling: PixelSampling::Center,
            seed: 0,
            lock_seed: false,
            display_white: 1.0,
            target_error: None,
        }
    }

    /// Whether samples of the same film position differ in a scene: Monte Carlo noise. Such frames are rendered in two
    /// independent half buffers. Others have more evenly distributed samples without.
    pub fn is_noisy(&self, scene: &Scene) -> bool {
        let traces_paths = matches!(
            self.integrator,
            IntegratorSettings::PathTraced { bounces: 1.., .. }
        );
        // Of cached light that of the sky alone is sampled at each surface.
        let samples_sky = matches!(self.integrator, IntegratorSettings::Cached { bounces: 1.. })
            && !scene.sky.is_black();
        traces_paths || samples_sky || scene.has_soft_shadows()
    }

    /// Whether pixels get as many samples as an error asks for.
    pub fn is_adaptive(&self) -> bool {
        match self.sampling {
            PixelSampling::Center | PixelSampling::Corners => false,
            PixelSampling::Spread(_) => self.target_error.is_some(),
            PixelSampling::Adaptive(_) => true,
        }
    }

    /// Whether the error of an irradiance cache in a frame leaves too little of the target error: its upper 95 % bound is
    /// above half of it.
    pub fn cache_misses(&self, error: &ErrorEstimate) -> bool {
        self.target_error
            .is_some_and(|target| error.interval()[1] > 0.5 * target)
    }

    /// The error that the samples of an adaptive frame may leave, given that of the irradiance cache: of a target error
    /// at least half, as more samples cannot make up for a cache that takes more than half. Nobody waits for noise to fall
    /// below [`RenderSettings::NOISE`] without asking for it.
    pub(super) fn target_of_samples(
        &self,
        scene: &Scene,
        cache_error: Option<ErrorEstimate>,
    ) -> Option<f64> {
        let of_cache = cache_error.map_or(0.0, |cache| cache.interval()[1]);
        match (self.target_error, self.sampling) {
            (_, PixelSampling::Center | PixelSampling::Corners) => None,
            (Some(target), _) => Some((target - of_cache).max(0.5 * target)),
            (None, PixelSampling::Adaptive(target)) if self.is_noisy(scene) => {
                Some(target.max(RenderSettings::NOISE))
            }
            (None, PixelSampling::Adaptive(target)) => Some(target),
            (None, PixelSampling::Spread(_)) => None,
        }
    }
}
