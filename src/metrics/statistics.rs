//! Means with standard errors, percentiles, and Student's t distribution.

use serde::Serialize;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, SQRT_2};
use std::ops::Div;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimate.
    pub mean: f64,
    /// The standard error of [`Estimate::mean`], at least 0; infinite if unknown.
    pub error: f64,
}

impl Estimate {
    /// A known value, of standard error 0.
    pub fn exact(mean: f64) -> Estimate {
        Estimate { mean, error: 0.0 }
    }

    /// The mean of independent values. The standard error of one value alone is infinite.
    pub fn of(values: &[f64]) -> Estimate {
        let error = match values.len() {
            0 | 1 => f64::INFINITY,
            count => standard_deviation(values) / (count as f64).sqrt(),
        };
        Estimate {
            mean: mean(values),
            error,
        }
    }

    /// The 95 % confidence interval, where the standard error is estimated with `degrees` degrees of freedom: n - 1 for
    /// the mean of n values. With none, from -infinity to infinity.
    pub fn interval(self, degrees: u32) -> [f64; 2] {
        let half = match degrees {
            0 => f64::INFINITY,
            _ => student_t(degrees, 0.05) * self.error,
        };
        [self.mean - half, self.mean + half]
    }
}

impl Div<f64> for Estimate {
    type Output = Estimate;

    /// The estimate in other units; the divisor is exact.
    fn div(self, divisor: f64) -> Estimate {
        Estimate {
            mean: self.mean / divisor,
            error: self.error / divisor.abs(),
        }
    }
}

/// The mean of values; NaN of none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The sample standard deviation (with n - 1); NaN of fewer than two values.
fn standard_deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

/// The percentile by nearest rank: the smallest value that at least `fraction` of the values, 0 to 1, do not exceed;
/// NaN of none. NaN counts as the largest value. Reorders the values.
pub(super) fn percentile(values: &mut [f64], fraction: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let rank = (fraction * values.len() as f64).ceil() as usize;
    let index = rank.clamp(1, values.len()) - 1;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

/// With more degrees of freedom the expansion is as accurate as the sum, which has half as many terms as there are
/// degrees.
const SUMMED: u32 = 2000;

/// The two-sided quantile of Student's t distribution: |t| exceeds it with probability `p`, above 0 and below 1;
/// `degrees` of freedom are 1 or more.
///
/// Abramowitz and Stegun, "Handbook of Mathematical Functions": the sums 26.7.3 for odd and 26.7.4 for even
/// degrees, and for many the expansion 26.7.5, within 1e-6 of t where p is above 1e-7.
pub fn student_t(degrees: u32, p: f64) -> f64 {
    if degrees <= SUMMED {
        by_sums(degrees, p)
    } else {
        by_expansion(degrees, p)
    }
}

fn by_sums(degrees: u32, p: f64) -> f64 {
    let angle = invert_decreasing(p, FRAC_PI_2, DOUBLE, |angle| exceeds(degrees, angle));
    libm::tan(angle) * f64::from(degrees).sqrt()
}

fn by_expansion(degrees: u32, p: f64) -> f64 {
    // No double is as unlikely as 40 standard deviations.
    let x = invert_decreasing(p, 40.0, DOUBLE, |x| libm::erfc(x / SQRT_2));
    let first = (x.powi(3) + x) / 4.0;
    let second = (5.0 * x.powi(5) + 16.0 * x.powi(3) + 3.0 * x) / 96.0;
    let nu = f64::from(degrees);
    x + (first + second / nu) / nu
}

/// The probability that |t| exceeds sqrt(degrees) tan(`angle`).
fn exceeds(degrees: u32, angle: f64) -> f64 {
    let (sin, cos) = libm::sincos(angle);
    let odd = degrees % 2 == 1;
    let (mut term, first) = if odd { (cos, 3) } else { (1.0, 2) };
    let mut sum = 0.0;
    for k in (first..=degrees).step_by(2) {
        sum += term;
        term *= cos * cos * f64::from(k - 1) / f64::from(k);
    }
    let within = if odd {
        FRAC_2_PI * (angle + sin * sum)
    } else {
        sin * sum
    };
    1.0 - within
}

/// Halvings after which nothing more changes in double precision.
const DOUBLE: u32 = 60;

/// The least argument from 0 to `high` where a decreasing function is at most `value`, by `halvings` bisections. `high`
/// is assumed to be one.
fn invert_decreasing(
    value: f64,
    mut high: f64,
    halvings: u32,
    function: impl Fn(f64) -> f64,
) -> f64 {
    let mut low = 0.0;
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        *(if function(middle) > value {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values from statistical tables, for the levels 0.05, 0.01 and 0.001.
    #[test]
    fn quantiles_of_students_t() {
        for (degrees, p, expected) in [
            (1, 0.05, 12.706),
            (1, 0.001, 636.619),
            (2, 0.05, 4.303),
            (2, 0.01, 9.925),
            (3, 0.05, 3.182),
            (4, 0.05, 2.776),
            (7, 0.05, 2.365),
            (10, 0.001, 4.587),
            (15, 0.001, 4.073),
            (20, 0.01, 2.845),
            (31, 0.01, 2.744),
            (60, 0.05, 2.000),
            (120, 0.05, 1.980),
            (1000, 0.05, 1.962),
            (1_000_000, 0.05, 1.960),
            (u32::MAX, 0.001, 3.291),
        ] {
            let t = student_t(degrees, p);
            assert!((t - expected).abs() < 5.1e-4, "{degrees} {p}: {t}");
        }
    }

    #[test]
    fn sums_and_expansion_agree_where_they_meet() {
        for degrees in [SUMMED - 1, SUMMED] {
            for p in [0.5, 0.05, 1e-3, 1e-7] {
                let difference = by_sums(degrees, p) - by_expansion(degrees, p);
                assert!(difference.abs() < 1e-6, "{degrees} {p}: {difference}");
            }
        }
    }

    #[test]
    fn means_deviations_and_their_intervals() {
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        assert_eq!(mean(&values), 5.0);
        assert_eq!(standard_deviation(&values), (32.0_f64 / 7.0).sqrt());
        let estimate = Estimate::of(&values) / -2.0;
        let error = (32.0_f64 / 7.0 / 8.0).sqrt() / 2.0;
        assert!((estimate.error - error).abs() < 1e-15);
        let [low, high] = estimate.interval(7);
        assert!((low + high + 5.0).abs() < 1e-12);
        assert!((high - low - 2.0 * 2.3646 * error).abs() < 1e-4);
    }

    #[test]
    fn few_values_have_wide_intervals() {
        let one = Estimate::of(&[3.0]);
        assert_eq!((one.mean, one.error), (3.0, f64::INFINITY));
        assert_eq!(one.interval(0), [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(Estimate::exact(3.0).interval(5), [3.0, 3.0]);
        assert_eq!(Estimate::of(&[3.0; 4]), Estimate::exact(3.0));
        assert!(mean(&[]).is_nan() && percentile(&mut [], 0.5).is_nan());
    }

    #[test]
    fn percentiles_are_values() {
        let mut values: Vec<f64> = (1..=20).rev().map(f64::from).collect();
        for (fraction, expected) in [
            (0.0, 1.0),
            (0.05, 1.0),
            (0.5, 10.0),
            (0.95, 19.0),
            (1.0, 20.0),
        ] {
            assert_eq!(percentile(&mut values, fraction), expected);
        }
        values.extend([f64::NAN; 2]);
        assert_eq!(percentile(&mut values, 0.5), 11.0);
        assert!(percentile(&mut values, 1.0).is_nan());
    }
}
