//! Random and quasi-random numbers, and their warps to directions and to choices.
//!
//! Every number of a [`SobolSequence`] is a function of (seed, frame, pixel, sample, dimension), so a pixel is the same
//! whatever thread, order or machine renders it.

mod cone;
mod direction_histogram;
mod piecewise_constant;
mod random;
mod sobol;
mod spherical_triangle;
mod van_der_corput;
mod warp;

pub use cone::{uniform_cone, uniform_cone_pdf};
pub use direction_histogram::{DirectionCell, DirectionHistogram, cube_face};
pub use piecewise_constant::{PiecewiseConstant1D, PiecewiseConstant2D};
pub use random::Random;
pub use sobol::{MixtureChoice, SobolSequence};
pub use spherical_triangle::SphericalTriangle;
pub use van_der_corput::van_der_corput_order;
pub use warp::{cosine_hemisphere, uniform_sphere};
