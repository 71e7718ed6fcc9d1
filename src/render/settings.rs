//! The settings of frames, as plain data.

use crate::integrator::IntegratorSettings;
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
    /// Adaptive sampling: samples are added to a frame, where they reduce its error most, until the upper 95 %
    /// confidence bound of its estimated relMSE is below this; above 0. Frames without noise ignore it.
    pub target_error: Option<f64>,
}

/// Where in a pixel its camera samples lie. Their mean is the pixel (box filter).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PixelSampling {
    /// One, in the middle.
    Center,
    /// Four, in the corners, shared with the neighbours: about one for each pixel of the frame.
    Corners,
    /// This many, at least 1, stratified over the pixel's square.
    Spread(u32),
}

impl RenderSettings {
    /// One sample in the middle of each pixel, seed 0, display white 1, no target error.
    pub fn new(integrator: IntegratorSettings, width: u32, height: u32) -> RenderSettings {
        RenderSettings {
            width,
            height,
            integrator,
            sampling: PixelSampling::Center,
            seed: 0,
            lock_seed: false,
            display_white: 1.0,
            target_error: None,
        }
    }

    /// Whether frames have Monte Carlo noise, which is then estimated.
    pub fn has_noise(&self) -> bool {
        match self.integrator {
            IntegratorSettings::Whitted { .. } => false,
            IntegratorSettings::PathTraced { bounces, .. } => {
                bounces > 0 || matches!(self.sampling, PixelSampling::Spread(_))
            }
            // Only the positions of camera samples are random, and a single one makes no two half buffers.
            IntegratorSettings::Cached { .. } => {
                matches!(self.sampling, PixelSampling::Spread(count) if count > 1)
            }
        }
    }
}
