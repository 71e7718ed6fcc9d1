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

    /// The mean of two independent estimates.
    fn mean_with(self, other: ErrorEstimate) -> ErrorEstimate {
        let sum = self.plus(other);
        ErrorEstimate {
            rel_mse: 0.5 * sum.rel_mse,
            standard_error: 0.5 * sum.standard_error,
        }
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
    /// The relMSE of the worst block of 8 x 8 pixels: of the four that are expected to be the worst. The error of the
    /// irradiance cache counts with its mean.
    pub worst_block: f64,
    /// The relMSE after each block of 8 x 8 pixels is replaced by its mean: what blotches and bands leave, which are
    /// seen more than noise. The error of the irradiance cache counts as a whole.
    pub blurred: f64,
}

impl FrameErrorEstimate {
    /// The mean of two independent estimates.
    pub(super) fn mean_with(self, other: FrameErrorEstimate) -> FrameErrorEstimate {
        FrameErrorEstimate {
            whole: self.whole.mean_with(other.whole),
            worst_block: 0.5 * (self.worst_block + other.worst_block),
            blurred: 0.5 * (self.blurred + other.blurred),
        }
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
