//! What frames are rendered from: scene, settings, integrator and the errors of the irradiance cache.

use super::{ErrorEstimate, PixelSampling, RenderSettings};
use crate::integrator::{Integrator, IntegratorError, IntegratorSettings, Lighting};
use crate::irradiance_cache::IrradianceCache;
use crate::scene::Scene;
use std::sync::Arc;

/// Renders frames, single pixels and sequences of a scene.
///
/// Building one builds the integrator: build it once for a sequence.
#[derive(Clone, Debug)]
pub struct Renderer<'a> {
    pub(super) settings: RenderSettings,
    pub(super) integrator: Integrator<'a>,
    /// Indexed by frame; empty unless light is cached.
    pub(super) cache_errors: &'a [ErrorEstimate],
    /// Renders the frames in which the irradiance cache misses its part of the target error.
    path_traced: Option<Arc<Renderer<'a>>>,
    /// One sample in the middle of each pixel, by each half of the paths of the irradiance cache; none if their map is not
    /// asked for.
    pub(super) cache_halves: Option<Arc<[Renderer<'a>; 2]>>,
}

/// Paths from the first diffuse bounce of a camera sample in frames that are path traced since the cache is not good enough.
const SPLITS: u32 = 32;

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
            path_traced: None,
            cache_halves: None,
        })
    }

    /// The same renderer, which adds the error of the irradiance cache in each frame of a path to that of the frame; adaptive
    /// frames [in which the cache misses](RenderSettings::cache_misses) the target error are path traced. Ignored unless
    /// light is cached.
    pub fn with_cache_errors(mut self, cache_errors: &'a [ErrorEstimate]) -> Renderer<'a> {
        let IntegratorSettings::Cached { bounces } = self.settings.integrator else {
            return self;
        };
        self.cache_errors = cache_errors;
        let is_missed = cache_errors.iter().any(|e| self.settings.cache_misses(e));
        if is_missed && self.settings.is_adaptive() {
            let settings = RenderSettings {
                integrator: IntegratorSettings::PathTraced {
                    bounces,
                    splits: vec![SPLITS],
                },
                ..self.settings.clone()
            };
            let path_traced = Renderer::new(self.scene(), settings, None);
            self.path_traced = Some(Arc::new(path_traced.expect("it needs no cache")));
        }
        self
    }

    /// The same renderer, whose frames have a map of their cache errors, from the [halves](IrradianceCache::halves) of the
    /// irradiance cache. Ignored unless light is cached.
    pub fn with_cache_halves(mut self, halves: &'a [IrradianceCache; 2]) -> Renderer<'a> {
        if let IntegratorSettings::Cached { .. } = self.settings.integrator {
            let half = |half| {
                let settings = RenderSettings {
                    sampling: PixelSampling::Center,
                    ..self.settings.clone()
                };
                Renderer::new(self.scene(), settings, Some(half)).expect("of the same bounces")
            };
            self.cache_halves = Some(Arc::new(halves.each_ref().map(half)));
        }
        self
    }

    /// What renders a frame in place of this; none if it does.
    pub(super) fn instead(&self, frame: u32) -> Option<&Renderer<'a>> {
        let error = self.cache_errors.get(frame as usize)?;
        let misses = self.settings.cache_misses(error);
        self.path_traced.as_deref().filter(|_| misses)
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
    fn with(&self, change: impl Fn(&mut RenderSettings) + Copy) -> Renderer<'a> {
        let mut renderer = self.clone();
        change(&mut renderer.settings);
        renderer.path_traced = self
            .path_traced
            .as_ref()
            .map(|renderer| Arc::new(renderer.with(change)));
        // Maps are of the frames that they were asked for.
        renderer.cache_halves = None;
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
