//! Frames and sequences of frames: which samples a pixel takes, how frames are scheduled, how noise is estimated and
//! how it moves from frame to frame.
//!
//! Each pixel takes its samples in two independent half buffers A and B. The square of half their difference is an
//! unbiased estimate of the variance of their mean. They take no measurable time, but two independent sets of Sobol
//! points are less evenly distributed than one: relMSE 0.0051 rather than 0.0045 for 32 paths. Adaptive samples are
//! added by the noise around a pixel, never its own, so that no value decides how many samples it has.
//!
//! A frame is a pure function of (scene, camera, settings, irradiance cache, frame number): the same bits for any
//! number of threads. Knows nothing of file formats, folders or terminals.

mod accumulator;
mod adaptive;
mod block;
mod error_estimate;
mod flicker;
mod frame;
mod grid;
mod half_buffer_error;
mod held_out;
mod observer;
mod picture;
mod pixels;
mod renderer;
mod reprojection;
mod sampler;
mod sequence;
mod settings;
mod sink;
mod sink_error;

pub use error_estimate::{ErrorEstimate, FrameErrorEstimate};
pub use flicker::Flicker;
pub use frame::{RenderedFrame, frame_memory, tile_count};
pub use observer::{NoObserver, RenderObserver};
pub use renderer::Renderer;
pub use reprojection::{Match, Reprojection, TILE};
pub use sequence::{FRAMES_IN_FLIGHT, Outcome};
pub use settings::{PixelSampling, RenderSettings};
pub use sink::{Claim, EncodedFrame, FrameSink};
pub use sink_error::SinkError;
