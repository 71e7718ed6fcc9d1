//! The error of pictures against references whose own noise is known.
//!
//! Pictures are [`Film`](crate::film::Film)s of linear light. An exposure in stops makes of it what is
//! displayed, and all errors are in those units: 1 is display white. Relative errors are divided by
//! sqrt(m^2 + 0.01), m being the light around the pixel, so that a tenth of white is as dark as it gets: see
//! [`normaliser`].
//!
//! Knows nothing of files, threads or scenes.

mod bias;
mod difference;
mod flip;
mod heat;
mod pixel;
mod reference;
mod statistics;
mod surroundings;
#[cfg(test)]
pub(crate) mod synthetic;

pub use bias::{BiasCheck, HeldOutPixel};
pub use difference::{Difference, relative_errors};
pub use flip::flip;
pub use heat::heat_map;
pub use reference::Reference;
pub use statistics::{Estimate, falls_to, mean, student};
pub use surroundings::{DARK, mean_around, normaliser};
