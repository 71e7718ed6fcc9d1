//! The error of pictures against references whose own noise is known.
//!
//! Pictures are [`Film`](crate::film::Film)s of linear light. An exposure in stops makes of it what is
//! displayed, and all errors are in those units: 1 is display white. Relative errors are divided by
//! sqrt(r^2 + 0.01), r being the reference, so that a tenth of white is as dark as it gets.
//!
//! Knows nothing of files, threads or scenes.

mod bias;
mod blocks;
mod difference;
mod flip;
mod heat;
mod pixel;
mod reference;
mod statistics;
#[cfg(test)]
mod synthetic;

pub use bias::{BiasCheck, HeldOutPixel};
pub use difference::{Difference, relative_errors};
pub use flip::Flip;
pub use heat::{HEAT_RANGE, heat_map};
pub use reference::Reference;
pub use statistics::{Estimate, mean, percentile, standard_deviation, student};
