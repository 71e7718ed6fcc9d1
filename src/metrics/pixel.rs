//! The errors of one pixel, of R, G and B apart, in units of display white.

use glam::DVec3;

/// (x - A)(x - B), by chance below 0.
///
/// If x, A and B are independent, and A and B have the true image I as their mean, the noise of each factor
/// knows nothing of the other, and the mean of the product is that of (x - I)^2.
pub(super) fn square(x: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    (x - a) * (x - b)
}

/// What lies half way.
pub(super) fn middle([a, b]: [DVec3; 2]) -> DVec3 {
    0.5 * (a + b)
}

/// The mean of R, G and B.
pub(super) fn channel_mean(channels: DVec3) -> f64 {
    channels.element_sum() / 3.0
}
