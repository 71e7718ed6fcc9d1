//! Bias of a technique, from independent images of it and independent estimates by an unbiased oracle.

use super::pixel::{channel_mean, mean_of_two};
use super::{Estimate, RADIANCE_FLOOR, mean, student_t};
use glam::{DVec3, Vec3};

/// The significance level, two-sided, of each of the two estimates of a [`BiasCheck`]: 3.29 standard errors with many
/// pixels, more with few.
const SIGNIFICANCE: f64 = 0.001;

/// The relative rounding error of means of single precision numbers: what is less is no bias.
const ROUNDING: f64 = 1e-6;

/// The radiance of one pixel by a technique and by an unbiased oracle: four independent values.
///
/// The technique's two share no seed. What they share, such as an irradiance cache, counts as bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOutPixel {
    /// By the technique that is checked.
    pub technique: [Vec3; 2],
    /// By an unbiased estimator.
    pub oracle: [Vec3; 2],
}

/// The bias of a technique: how far the mean of its images is from the true image, in units of display white.
///
/// Standard errors are those over pixels, which should be so far apart that their noise is independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasCheck {
    /// The mean over pixels and channels of (mean(c) - I)^2 / (r^2 + 0.01), where c are the technique's values and I
    /// the true ones: the part of relMSE that averaging images does not remove. Noise may make the estimate negative.
    ///
    /// It is estimated by (c1 - A)(c2 - B), the noise of whose factors is independent.
    pub squared_bias: Estimate,
    /// mean(c) / mean(r) - 1: above 0 if the technique is too bright; NaN if the oracle is black.
    pub mean_bias: Estimate,
    /// How many pixels were compared.
    pub pixels: usize,
}

impl BiasCheck {
    /// The bias at some pixels, at an exposure in stops.
    pub fn of(pixels: &[HeldOutPixel], exposure: f32) -> BiasCheck {
        let scale = f64::from(libm::exp2f(exposure));
        let pixels: Vec<Values> = pixels
            .iter()
            .map(|pixel| Values::of(pixel, scale))
            .collect();
        let over_pixels = |value: &dyn Fn(&Values) -> DVec3| -> Vec<f64> {
            pixels
                .iter()
                .map(|pixel| channel_mean(value(pixel)))
                .collect()
        };
        let difference =
            over_pixels(&|pixel| mean_of_two(pixel.technique) - mean_of_two(pixel.oracle));
        let oracle = over_pixels(&|pixel| mean_of_two(pixel.oracle));
        BiasCheck {
            squared_bias: Estimate::of(&over_pixels(&Values::squared_bias)),
            mean_bias: Estimate::of(&difference) / mean(&oracle),
            pixels: pixels.len(),
        }
    }

    /// Whether the squared bias, or the mean bias to either side, is significant. Never with fewer than two pixels.
    ///
    /// False positives are one in 500 checks or fewer if the noise of pixels is symmetric. Many dark pixels and a few
    /// bright ones skew the mean bias: with log-normal noise of sigma 1.5 it is one in 60 checks of 100 pixels, in 230
    /// of 1000 and in 400 of 3000.
    pub fn is_biased(&self) -> bool {
        if self.pixels < 2 {
            return false;
        }
        let degrees = u32::try_from(self.pixels - 1).unwrap_or(u32::MAX);
        let limit = student_t(degrees, SIGNIFICANCE);
        let exceeds = |estimate: Estimate, value: f64, rounding: f64| {
            value > (limit * estimate.error).max(rounding)
        };
        exceeds(
            self.squared_bias,
            self.squared_bias.mean,
            ROUNDING * ROUNDING,
        ) || exceeds(self.mean_bias, self.mean_bias.mean.abs(), ROUNDING)
    }
}

/// A pixel in units of display white.
#[derive(Debug)]
struct Values {
    technique: [DVec3; 2],
    oracle: [DVec3; 2],
}

impl Values {
    fn of(pixel: &HeldOutPixel, scale: f64) -> Values {
        let exposed = |light: Vec3| scale * light.as_dvec3();
        Values {
            technique: pixel.technique.map(exposed),
            oracle: pixel.oracle.map(exposed),
        }
    }

    /// (c1 - A)(c2 - B) / (r^2 + 0.01), where r is the mean of c1 and A, or of c2 and B: the mean of both quotients.
    ///
    /// Were r the mean of A and B, the normaliser would depend on both factors, and their noise would pass for bias. As
    /// it is, one factor is independent of it, whose expectation is 0 without bias, however large the noise.
    fn squared_bias(&self) -> DVec3 {
        let [(c1, a), (c2, b)] = [0, 1].map(|i| (self.technique[i], self.oracle[i]));
        let inverse = |c: DVec3, r: DVec3| normaliser(mean_of_two([c, r])).recip();
        (c1 - a) * (c2 - b) * mean_of_two([inverse(c1, a), inverse(c2, b)])
    }
}

/// What squared errors of a pixel of radiance r are divided by: single pixels have no local mean.
fn normaliser(r: DVec3) -> DVec3 {
    r * r + f64::from(RADIANCE_FLOOR).powi(2)
}

#[cfg(test)]
mod tests {
    use super::super::pixel::squared_error;
    use super::super::synthetic::Noise;
    use super::*;

    /// Pixels from black to white, which a technique changes, with noise of standard deviations `of_technique` and
    /// `of_oracle`.
    fn held_out(
        noise: &mut Noise,
        count: usize,
        [of_technique, of_oracle]: [f64; 2],
        technique: impl Fn(usize, Vec3) -> Vec3,
    ) -> Vec<HeldOutPixel> {
        let pixel = |i: usize| {
            let truth = noise.between(0.0, 1.0);
            let mean = technique(i, truth);
            HeldOutPixel {
                technique: [0; 2].map(|_| noise.light(mean, of_technique)),
                oracle: [0; 2].map(|_| noise.light(truth, of_oracle)),
            }
        };
        (0..count).map(pixel).collect()
    }

    fn alarms(runs: usize, mut pixels: impl FnMut() -> Vec<HeldOutPixel>) -> usize {
        let biased = (0..runs).filter(|_| BiasCheck::of(&pixels(), 0.0).is_biased());
        biased.count()
    }

    /// Of 200 checks without bias 0.3 false positives are expected; more than 3 come once in thousands of times.
    #[test]
    fn unbiased_techniques_pass() {
        for sigmas in [[0.05, 0.02], [0.02, 0.1], [0.2, 0.2], [0.0, 0.1]] {
            let mut noise = Noise::new(6);
            let alarms = alarms(200, || held_out(&mut noise, 150, sigmas, |_, truth| truth));
            assert!(alarms <= 3, "{alarms} with {sigmas:?}");
        }
    }

    /// Divided by the mean of A and B, the noise of this oracle would pass for bias.
    #[test]
    fn a_noisy_oracle_is_no_bias() {
        let mut noise = Noise::new(7);
        let black = |_| HeldOutPixel {
            technique: [Vec3::ZERO; 2],
            oracle: [0; 2].map(|_| noise.light(Vec3::ZERO, 0.1)),
        };
        let pixels: Vec<HeldOutPixel> = (0..5000).map(black).collect();
        let check = BiasCheck::of(&pixels, 0.0);
        let products = pixels.iter().map(|pixel| {
            let values = Values::of(pixel, 1.0);
            let error = squared_error(values.technique[0], values.oracle);
            channel_mean(error / normaliser(mean_of_two(values.oracle)))
        });
        let divided_by_mean = Estimate::of(&products.collect::<Vec<f64>>());
        assert!(divided_by_mean.mean < -20.0 * divided_by_mean.error);
        let squared = check.squared_bias;
        assert!(squared.mean.abs() < 3.0 * squared.error, "{check:?}");
    }

    #[test]
    fn mean_bias_is_found() {
        let mut noise = Noise::new(8);
        for exposure in [0.0, -1.5] {
            let pixels = held_out(&mut noise, 3000, [0.05, 0.02], |_, truth| 1.02 * truth);
            let check = BiasCheck::of(&pixels, exposure);
            assert!(check.is_biased(), "{check:?}");
            let off = check.mean_bias.mean - 0.02;
            assert!(off.abs() < 4.0 * check.mean_bias.error, "{check:?}");
        }
    }

    /// Pixels are brighter and darker in turn: only the squared bias shows it.
    #[test]
    fn local_bias_is_found() {
        let mut noise = Noise::new(9);
        let local = |i: usize, truth: Vec3| truth * if i.is_multiple_of(2) { 1.1 } else { 0.9 };
        let pixels = held_out(&mut noise, 2000, [0.05, 0.03], local);
        let check = BiasCheck::of(&pixels, 0.0);
        assert!(check.is_biased(), "{check:?}");
        assert!(check.mean_bias.mean.abs() < 4.0 * check.mean_bias.error);
        // The integral over x from 0 to 1 of (0.1 x)^2 / (x^2 + 0.01).
        let expected = 0.01 * (1.0 - 0.1 * libm::atan(10.0));
        let off = check.squared_bias.mean - expected;
        assert!(off.abs() < 4.0 * check.squared_bias.error, "{check:?}");
    }

    #[test]
    fn without_noise_every_bias_is_found_and_none_invented() {
        let mut noise = Noise::new(10);
        let mut biased = |technique: fn(Vec3) -> Vec3| {
            let pixels = held_out(&mut noise, 50, [0.0, 0.0], |_, truth| technique(truth));
            BiasCheck::of(&pixels, 0.0).is_biased()
        };
        assert!(!biased(|truth| truth));
        // In another order of summation.
        assert!(!biased(|truth| truth * (1.0 + f32::EPSILON)));
        assert!(biased(|truth| truth * 1.001));
        assert!(biased(|_| Vec3::ZERO));
        // The same everywhere: the spread is 0.
        let even = |[technique, oracle]: [f32; 2]| HeldOutPixel {
            technique: [Vec3::splat(technique); 2],
            oracle: [Vec3::splat(oracle); 2],
        };
        for (light, expected) in [
            ([0.5, 0.5], false),
            ([0.0, 0.0], false),
            ([0.5, 0.4], true),
            ([0.1, 0.0], true),
        ] {
            let check = BiasCheck::of(&[even(light); 9], 0.0);
            assert_eq!(check.is_biased(), expected, "{light:?} {check:?}");
            assert!(!BiasCheck::of(&[even(light)], 0.0).is_biased());
        }
        assert!(!BiasCheck::of(&[], 0.0).is_biased());
    }
}
