//! The error of a frame against the converged picture, as it is estimated.

use serde::{Deserialize, Serialize};

/// An estimated relMSE.
///
/// The error is the mean over pixels and channels of (x - r)^2 / (m^2 + (display white / 10)^2), of this very frame x,
/// where r is the converged picture, and m its mean around the pixel: see [`normaliser`](crate::metrics::normaliser).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorEstimate {
    /// An unbiased estimate of the relMSE, but at least 0.
    pub rel_mse: f64,
    /// The standard deviation of the difference between error and estimate.
    pub standard_error: f64,
}

impl ErrorEstimate {
    /// No error.
    pub(super) const NONE: ErrorEstimate = ErrorEstimate {
        rel_mse: 0.0,
        standard_error: 0.0,
    };

    /// The 95 % confidence interval of the error. It reaches further up than down, by what that of the logarithm does in
    /// second order: estimates that are too low have standard errors that are too low.
    pub fn interval(&self) -> [f64; 2] {
        let half_width = 1.96 * self.standard_error;
        let shift = 0.5 * half_width * (half_width / self.rel_mse).min(1.0);
        let (low, high) = (self.rel_mse - half_width, self.rel_mse + half_width);
        [low.max(0.0), high + shift]
    }

    /// Whether the error may be more than twice the estimate.
    pub(super) fn is_vague(&self) -> bool {
        let [_, upper] = self.interval();
        self.rel_mse < 0.5 * upper
    }

    /// The sum of two independent parts of an error.
    pub(super) fn plus(self, other: ErrorEstimate) -> ErrorEstimate {
        ErrorEstimate {
            rel_mse: self.rel_mse + other.rel_mse,
            standard_error: self.standard_error.hypot(other.standard_error),
        }
    }
}

/// The error of a frame: of its edges, textures, highlights, mirrors and noise, and of its irradiance cache.
///
/// Of light that no sample has found, and of light that the settings leave out, as bounces beyond the last, it knows
/// nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameErrorEstimate {
    /// The error of the whole frame.
    pub whole: ErrorEstimate,
    /// The relMSE of the worst block of 8 x 8 pixels: of the two that are expected to be the worst. The error of the
    /// irradiance cache counts with its mean.
    pub worst_block: f64,
    /// The relMSE after each block of 8 x 8 pixels is replaced by its mean: what blotches and bands leave, which are
    /// seen more than noise. The error of the irradiance cache counts as a whole.
    pub blurred: f64,
}

impl FrameErrorEstimate {
    /// No error.
    pub(super) const NONE: FrameErrorEstimate = FrameErrorEstimate {
        whole: ErrorEstimate::NONE,
        worst_block: 0.0,
        blurred: 0.0,
    };

    /// The error of a picture that no samples tell of.
    pub(super) const UNKNOWN: FrameErrorEstimate = FrameErrorEstimate {
        whole: ErrorEstimate {
            rel_mse: f64::INFINITY,
            standard_error: f64::INFINITY,
        },
        worst_block: f64::INFINITY,
        blurred: f64::INFINITY,
    };

    /// Whether it is an estimate, and not the infinite error of surfaces that nothing lights.
    pub fn is_known(&self) -> bool {
        self.whole.rel_mse.is_finite()
    }

    /// With the error of the irradiance cache.
    pub(super) fn plus_cache(self, cache: ErrorEstimate) -> FrameErrorEstimate {
        FrameErrorEstimate {
            whole: self.whole.plus(cache),
            worst_block: self.worst_block + cache.rel_mse,
            blurred: self.blurred + cache.rel_mse,
        }
    }
}

/// Estimates of the error of one picture: the part that its half buffers know, and independent estimates of the rest.
#[derive(Debug)]
pub(super) struct ErrorEstimates {
    of_half_buffers: FrameErrorEstimate,
    weights: f64,
    rel_mse: f64,
    variance: f64,
    worst_block: f64,
    blurred: f64,
}

impl ErrorEstimates {
    /// None.
    pub(super) const NONE: ErrorEstimates = ErrorEstimates {
        of_half_buffers: FrameErrorEstimate::NONE,
        weights: 0.0,
        rel_mse: 0.0,
        variance: 0.0,
        worst_block: 0.0,
        blurred: 0.0,
    };

    /// Adds an estimate of the rest, which may be below 0, with a weight that does not depend on its value; what the half
    /// buffers know is the same each time.
    pub(super) fn add(
        &mut self,
        of_half_buffers: FrameErrorEstimate,
        rest: FrameErrorEstimate,
        weight: f64,
    ) {
        self.of_half_buffers = of_half_buffers;
        let whole = rest.whole;
        self.weights += weight;
        self.rel_mse += weight * whole.rel_mse;
        self.variance += (weight * whole.standard_error).powi(2);
        self.worst_block += weight * rest.worst_block;
        self.blurred += weight * rest.blurred;
    }

    /// The weighted mean with what the half buffers know, but at least 0.
    pub(super) fn mean(&self) -> FrameErrorEstimate {
        let rest = ErrorEstimate {
            rel_mse: self.rel_mse / self.weights,
            standard_error: self.variance.sqrt() / self.weights,
        };
        let whole = self.of_half_buffers.whole.plus(rest);
        let blurred = self.of_half_buffers.blurred + self.blurred / self.weights;
        FrameErrorEstimate {
            whole: ErrorEstimate {
                rel_mse: whole.rel_mse.max(0.0),
                ..whole
            },
            worst_block: self.worst_block / self.weights,
            blurred: blurred.max(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(rel_mse: f64, standard_error: f64) -> FrameErrorEstimate {
        FrameErrorEstimate {
            whole: ErrorEstimate {
                rel_mse,
                standard_error,
            },
            worst_block: 4.0 * rel_mse.max(0.0),
            blurred: 0.5 * rel_mse,
        }
    }

    /// The weights that make the variance least are the inverse variances; what half buffers know counts once.
    #[test]
    fn estimates_of_one_picture_make_one() {
        let of_half_buffers = estimate(3.0, 0.3);
        let mut estimates = ErrorEstimates::NONE;
        estimates.add(of_half_buffers, estimate(-1.0, 2.0), 1.0);
        estimates.add(of_half_buffers, estimate(1.5, 1.0), 4.0);
        let FrameErrorEstimate {
            whole,
            worst_block,
            blurred,
        } = estimates.mean();
        assert!((whole.rel_mse - 4.0).abs() < 1e-12);
        let of_rest = 1.0 / (1.0_f64 + 1.0 / 4.0);
        assert!((whole.standard_error.powi(2) - 0.09 - of_rest).abs() < 1e-12);
        assert!((worst_block - 4.8).abs() < 1e-12);
        assert!((blurred - 2.0).abs() < 1e-12);
        // Noise alone is no error below 0.
        let mut estimates = ErrorEstimates::NONE;
        estimates.add(FrameErrorEstimate::NONE, estimate(-1.0, 2.0), 1.0);
        assert_eq!(estimates.mean().whole.rel_mse, 0.0);
        assert_eq!(estimates.mean().blurred, 0.0);
    }

    #[test]
    fn vague_estimates_may_be_half_of_the_error() {
        let is_vague = |rel_mse, standard_error| estimate(rel_mse, standard_error).whole.is_vague();
        assert!(!is_vague(0.0, 0.0));
        assert!(is_vague(0.0, 1e-9));
        assert!(is_vague(1.0, 0.5));
        assert!(!is_vague(1.0, 0.3));
    }
}
