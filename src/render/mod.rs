//! Frames and sequences of frames: which samples a pixel takes, who works on what, and what two
//! frames show of the same points.
//!
//! A frame is a pure function of (scene, camera, settings, frame number): the same bytes for any
//! number of threads. Knows nothing of file formats, folders or terminals.

mod frame;
mod reprojection;
mod sequence;
mod settings;

pub use frame::{RenderedFrame, render_frame, tile_count};
pub use reprojection::{Match, Reprojection};
pub use sequence::{FrameSink, Observer, Outcome, SinkError, render_sequence};
pub use settings::{PixelSampling, RenderSettings};
