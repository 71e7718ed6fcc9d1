use super::ErrorEstimate;
use crate::integrator::Integrator;
use crate::irradiance_cache::IrradianceCache;
use std::sync::Arc;

/// Everything beside scene and camera that decides a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Columns; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// How light is gathered along a camera ray.
    pub integrator: Integrator,
    /// Where in the pixel camera rays go.
    pub sampling: PixelSampling,
    /// Chooses the random numbers.
    pub seed: u32,
    /// Whether all frames have the same random numbers. Their noise then stands still where the camera does,
    /// and sticks to the film where it does not; otherwise it is new in each frame.
    pub lock_seed: bool,
    /// The light that is displayed as white, above 0: errors count in proportion to the light, and where
    /// that is less than a tenth of white, to the tenth.
    pub white: f32,
    /// Samples are added to a frame, where it needs them, until the upper end of its error's interval, by its
    /// own estimate, is below this; above 0. Frames without chance take no notice.
    pub target_error: Option<f64>,
    /// How far off the light is that is looked up, frame by frame of the path; of no frame if none is.
    pub cache_errors: Arc<[ErrorEstimate]>,
}

/// Where in a pixel its camera samples lie. Their mean is the pixel (box filter).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelSampling {
    /// One, in the middle.
    Center,
    /// Four, in the corners, shared with the neighbours: about one for each pixel of the frame.
    Corners,
    /// This many, at least 1, well spread over the pixel's square.
    Spread(u32),
}

impl RenderSettings {
    /// Whether frames have noise that may be measured and made less.
    pub fn has_noise(&self) -> bool {
        match self.integrator {
            Integrator::RayTracing { .. } => false,
            Integrator::Cached { .. } => self.has_noise_looking_up(),
            Integrator::MonteCarlo { bounces, .. } => {
                bounces > 0 || matches!(self.sampling, PixelSampling::Spread(_))
            }
        }
    }

    /// The same if light is looked up: edges alone are left to chance then, and one sample has no halves.
    pub fn has_noise_looking_up(&self) -> bool {
        matches!(self.sampling, PixelSampling::Spread(count) if count > 1)
    }

    /// One sample in the middle of each pixel, seed 0, white is 1, as many samples as are given.
    pub fn new(integrator: Integrator, width: u32, height: u32) -> RenderSettings {
        RenderSettings {
            width,
            height,
            integrator,
            sampling: PixelSampling::Center,
            seed: 0,
            lock_seed: false,
            white: 1.0,
            target_error: None,
            cache_errors: [].into(),
        }
    }

    /// These settings, but that indirect light is looked up.
    pub fn looking_up(&self, illumination: Arc<IrradianceCache>) -> RenderSettings {
        RenderSettings {
            integrator: Integrator::Cached { illumination },
            ..self.clone()
        }
    }
}
