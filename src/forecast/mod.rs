//! What a sequence will take, estimated before it is rendered: seconds, bytes on disk and in memory, from a few frames.
//!
//! Knows nothing of the command line or of integrators: it renders as [`Renderer::render_sequence`] does, and measures.
//!
//! [`Renderer::render_sequence`]: crate::render::Renderer::render_sequence

mod budget;
mod estimate;
mod pilot;

pub use budget::samples_within;
pub use estimate::{Estimate, Forecast};
pub use pilot::{Pilot, PilotFrame, Workload};
