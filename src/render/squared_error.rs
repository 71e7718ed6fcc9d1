//! The squared error of a pixel from pairs of independent estimates of its error.

use crate::metrics::channel_mean;
use glam::DVec3;

/// A squared error, relative to the radiance.
#[derive(Clone, Copy, Debug)]
pub(super) struct SquaredError {
    /// Unbiased, so that it may be below 0.
    pub(super) value: f64,
    /// The variance of the value, by the noise of the estimates: unbiased, too, but 0 if there is one pair.
    pub(super) noise: f64,
    /// The standard deviation of the value, by what is not known of the radiance that it is relative to.
    pub(super) deviation: f64,
}

impl SquaredError {
    /// From pairs of estimates, not squared, and from the inverse of what their product is relative to, with its standard
    /// deviation.
    ///
    /// The value is the product of the means of both estimates of the pairs; its noise is what the jackknife finds between
    /// the pairs (Quenouille 1956, "Notes on Bias in Estimation").
    pub(super) fn of(pairs: &[[DVec3; 2]], inverse: [DVec3; 2]) -> SquaredError {
        let count = pairs.len() as f64;
        let sums = pairs.iter().fold([DVec3::ZERO; 2], |sums, pair| {
            [sums[0] + pair[0], sums[1] + pair[1]]
        });
        let means = sums.map(|sum| sum / count);
        let [value, deviation] = inverse.map(|inverse| product(means, inverse));
        let noise = match pairs {
            [_] => 0.0,
            _ => {
                // The noise of one times that of the other counts once, but twice or more in the jackknife's squares.
                let square = |pair: &[DVec3; 2]| {
                    let off = [0, 1].map(|i| (pair[i] - means[i]) / (count - 1.0));
                    let without = product([0, 1].map(|i| means[i] - off[i]), inverse[0]);
                    let of_both = product(off, inverse[0]);
                    (without - value).powi(2) - count * of_both.powi(2)
                };
                let squares = pairs.iter().map(square).sum::<f64>();
                squares * (count - 1.0) / count
            }
        };
        SquaredError {
            value,
            noise,
            deviation,
        }
    }
}

/// The product of two estimates of an error, relative to the radiance.
fn product([a, b]: [DVec3; 2], inverse: DVec3) -> f64 {
    channel_mean(a * b * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::synthetic::Noise;

    /// Grey estimates of an error of 0.3 with normal noise, relative to a radiance of 0.5, known to a tenth.
    #[test]
    fn value_and_noise_of_normal_estimates() {
        let mut noise = Noise::new(1);
        const RUNS: usize = 20_000;
        for (pairs, sigma) in [(2, 0.1), (2, 1.0), (4, 1.0)] {
            let mut estimate = || DVec3::splat(0.3 + sigma * noise.normal());
            let mut error = || {
                let pairs: Vec<_> = (0..pairs).map(|_| [estimate(), estimate()]).collect();
                SquaredError::of(&pairs, [DVec3::splat(4.0), DVec3::splat(0.4)])
            };
            let errors: Vec<SquaredError> = (0..RUNS).map(|_| error()).collect();
            let mean = |of: &dyn Fn(&SquaredError) -> f64| {
                errors.iter().map(of).sum::<f64>() / RUNS as f64
            };
            let value = mean(&|error| error.value);
            let deviation = mean(&|error| error.deviation);
            let variance = mean(&|error| (error.value - 0.36).powi(2));
            let found = mean(&|error| error.noise);
            let sigma_of_mean = (variance / RUNS as f64).sqrt();
            assert!((value - 0.36).abs() < 4.0 * sigma_of_mean, "{value}");
            assert!((deviation - 0.036).abs() < 0.4 * sigma_of_mean);
            assert!((found / variance - 1.0).abs() < 0.1, "{found} {variance}");
        }
    }

    #[test]
    fn one_pair_knows_no_noise() {
        let pair = [DVec3::new(0.1, 0.2, 0.3), DVec3::ONE];
        let error = SquaredError::of(&[pair], [DVec3::ONE, DVec3::ZERO]);
        assert!((error.value - 0.2).abs() < 1e-12);
        assert_eq!([error.noise, error.deviation], [0.0; 2]);
    }
}
