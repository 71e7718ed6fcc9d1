//! What frames are rendered from: scene, settings, integrator and the errors of the irradiance cache.

use super::{ErrorEstimate, PixelSampling, RenderSettings};
use crate::integrator::{Integrator, IntegratorError, IntegratorSettings, Lighting};
use crate::irradiance_cache::IrradianceCache;
use crate::scene::Scene;

/// Renders frames, single pixels and sequences of a scene.
///
/// Building one builds the integrator: build it once for a sequence.
#[derive(Clone, Debug)]
pub struct Renderer<'a> {
    pub(super) settings: RenderSettings,
    pub(super) integrator: Integrator<'a>,
    /// Indexed by frame; empty unless light is cached.
    pub(super) cache_errors: &'a [ErrorEstimate],
}

impl<'a> Renderer<'a> {
    /// A renderer of a scene. `cache` is the scene's irradiance cache; only settings with cached light need it, others
    /// ignore it.
    pub fn new(
        scene: &'a Scene,
        settings: RenderSettings,
        cache: Option<&'a IrradianceCache>,
    ) -> Result<Renderer<'a>, IntegratorError> {
        Ok(Renderer {
            integrator: Integrator::new(scene, &settings.integrator, cache)?
                .with_shadow_rays(settings.shadow_rays)
                .with_headlight(settings.headlight),
            settings,
            cache_errors: &[],
        })
    }

    /// The same renderer, which adds the error of the irradiance cache in each frame of a path to that of the frame.
    /// Ignored unless light is cached.
    pub fn with_cache_errors(mut self, cache_errors: &'a [ErrorEstimate]) -> Renderer<'a> {
        if let IntegratorSettings::Cached { .. } = self.settings.integrator {
            self.cache_errors = cache_errors;
        }
        self
    }

    /// The same renderer with other random numbers.
    pub fn with_seed(&self, seed: u32) -> Renderer<'a> {
        self.with(|settings| settings.seed = seed)
    }

    /// The same renderer of frames with other columns and rows.
    pub fn with_size(&self, width: u32, height: u32) -> Renderer<'a> {
        self.with(|settings| (settings.width, settings.height) = (width, height))
    }

    /// The same renderer with other camera samples.
    pub fn with_sampling(&self, sampling: PixelSampling) -> Renderer<'a> {
        self.with(|settings| settings.sampling = sampling)
    }

    /// Whether its frames have Monte Carlo noise: see [`RenderSettings::is_noisy`].
    pub(super) fn is_noisy(&self) -> bool {
        self.settings.is_noisy(self.scene())
    }

    /// Whether anything lights the surfaces: the error of frames is unknown if not.
    pub(super) fn is_lit(&self) -> bool {
        self.settings.headlight > 0.0
            || Lighting::of(self.scene(), &self.settings.integrator) != Lighting::Nothing
    }

    /// The change leaves the integrator as it is.
    fn with(&self, change: impl FnOnce(&mut RenderSettings)) -> Renderer<'a> {
        let mut renderer = self.clone();
        change(&mut renderer.settings);
        renderer
    }

    /// The settings of its frames.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The scene.
    pub fn scene(&self) -> &'a Scene {
        self.integrator.scene()
    }
}
