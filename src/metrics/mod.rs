//! The error of images against references of known noise.
//!
//! Images are [`Film`](crate::film::Film)s of linear radiance, multiplied by the exposure: all errors are in units of
//! display white. Relative errors are divided by sqrt(m^2 + 0.01), where m is the local mean of the radiance: see
//! [`normaliser`]. Estimates of squared errors multiply two independent half buffers, so that noise does not bias them.
//!
//! Knows nothing of files, threads or scenes.

mod bias;
mod flip;
mod heat;
mod image_error;
mod local_mean;
mod opponent_color;
mod pixel;
mod plane;
mod reference;
mod statistics;
#[cfg(test)]
pub(crate) mod synthetic;

pub use bias::{BiasCheck, HeldOutPixel};
pub use flip::flip;
pub use heat::heat_map;
pub use image_error::{ImageError, relative_errors};
pub use local_mean::{RADIANCE_FLOOR, local_mean, neighbours, normaliser};
pub(crate) use pixel::channel_mean;
pub use reference::Reference;
pub use statistics::{Estimate, mean, student_t};
