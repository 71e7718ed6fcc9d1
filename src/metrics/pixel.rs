//! Errors of one pixel, for R, G and B, in units of display white.

use glam::DVec3;

/// (x - A)(x - B), an estimate of the squared error that noise may make negative.
///
/// If x, A and B are independent, and the expectation of A and B is the true image I, then that of the product is the
/// expectation of (x - I)^2.
pub(super) fn squared_error(x: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    (x - a) * (x - b)
}

/// The mean of two half buffers' values.
pub(super) fn mean_of_two([a, b]: [DVec3; 2]) -> DVec3 {
    0.5 * (a + b)
}

/// The mean of R, G and B.
pub(crate) fn channel_mean(channels: DVec3) -> f64 {
    channels.element_sum() / 3.0
}
