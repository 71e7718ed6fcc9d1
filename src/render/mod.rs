//! Frames and sequences of frames: which samples a pixel takes, who works on what, and how noise moves
//! from frame to frame.
//!
//! A frame is a pure function of (scene, camera, settings, frame number): the same bytes for any
//! number of threads. Knows nothing of file formats, folders or terminals.

mod allocation;
mod cache_errors;
mod flicker;
mod frame;
mod grid;
mod noise;
mod pixels;
mod reprojection;
mod samples;
mod sequence;
mod settings;
mod watch;

pub use cache_errors::cache_errors;
pub use flicker::Flicker;
pub use frame::{RenderedFrame, frame_memory, render_frame, tile_count};
pub use noise::ErrorEstimate;
pub use pixels::render_pixels;
pub use reprojection::{Match, Reprojection, TILE};
pub use sequence::{Claim, EncodedFrame, FrameSink, Observer, Outcome, SinkError, render_sequence};
pub use settings::{PixelSampling, RenderSettings};
pub use watch::{Unwatched, Watch};
