//! The errors of one pixel, of R, G and B apart, in units of display white.

use glam::DVec3;

/// What relative squared errors are divided by: r^2 + 0.01.
///
/// Without the 0.01 a few pixels that are nearly black would outweigh all others.
pub(super) fn normaliser(reference: DVec3) -> DVec3 {
    reference * reference + 0.01
}

/// |x - r| / sqrt(r^2 + 0.01): the noise of the reference counts as the picture's.
pub(super) fn relative(x: DVec3, r: DVec3) -> DVec3 {
    (x - r).abs() / normaliser(r).map(f64::sqrt)
}

/// (x - A)(x - B), by chance below 0.
///
/// If x, A and B are independent, and A and B have the true image I as their mean, the noise of each factor
/// knows nothing of the other, and the mean of the product is that of (x - I)^2.
pub(super) fn square(x: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    (x - a) * (x - b)
}

/// (x - A)(x - B) / (r^2 + 0.01) with r = (A + B) / 2.
///
/// The divisor has some of the halves' noise. If rho is the reference's own error of this kind, the mean is
/// off by up to 3 rho times itself, 6 rho^2, and 4 rho times the relative bias of x (the divisor to its second
/// order, for normal noise).
pub(super) fn relative_square(x: DVec3, halves: [DVec3; 2]) -> DVec3 {
    square(x, halves) / normaliser(middle(halves))
}

/// What lies half way.
pub(super) fn middle([a, b]: [DVec3; 2]) -> DVec3 {
    0.5 * (a + b)
}

/// The mean of R, G and B.
pub(super) fn channel_mean(channels: DVec3) -> f64 {
    channels.element_sum() / 3.0
}
