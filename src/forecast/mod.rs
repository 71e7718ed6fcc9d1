//! What a sequence will take, before it is paid for: seconds, bytes on disk and in memory, from a few frames of it.
//!
//! Knows nothing of the command line or of how light is gathered: it renders as [`Renderer::render_sequence`] does, and
//! looks at the clock.
//!
//! [`Renderer::render_sequence`]: crate::render::Renderer::render_sequence

mod budget;
mod pilot;
mod quote;

pub use budget::samples_within;
pub use pilot::{Pilot, PilotFrame, Stage};
pub use quote::{Forecast, Quote};
