use crate::integrator::Integrator;

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
    /// Chooses the random numbers; every frame gets its own from it.
    pub seed: u32,
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
