//! Sample numbers and the shapes they are warped to.
//!
//! Every number is a function of (seed, frame, pixel, sample, dimension), so a pixel is the
//! same whatever thread, order or machine renders it.

mod random;
mod sequence;
mod warp;

pub use random::Random;
pub use sequence::{MixtureChoice, Sequence};
pub use warp::{cosine_hemisphere, uniform_sphere};
