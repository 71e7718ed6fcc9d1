//! The error of an image against a reference: MSE, relMSE, bias and FLIP.

use super::pixel::{channel_mean, squared_error};
use super::reference::{ReferencePixel, exposed};
use super::statistics::percentile;
use super::{Reference, flip, mean};
use crate::film::Film;
use glam::DVec3;

/// The error of an image against a reference, in units of display white.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageError {
    /// The mean over pixels and channels of (x - I)^2, where I is the true image.
    ///
    /// It is estimated by (x - A)(x - B) with the half buffers of the reference, so that the reference's noise does not
    /// bias it. It may be negative if the image is much better than the reference, and is not clamped: means over many
    /// images would be too high otherwise.
    pub mse: f64,
    /// relMSE: the same, each square divided by m^2 + 0.01, where m is the local mean of the reference: see
    /// [`normaliser`](super::normaliser). It may be negative, too.
    pub rel_mse: f64,
    /// The 95th percentile of |x - r| / sqrt(m^2 + 0.01) over all pixels and channels. The reference's noise counts as
    /// the image's.
    pub p95_relative_error: f64,
    /// mean(x) / mean(r) - 1 over all pixels and channels: above 0 if the image is too bright; NaN if the reference is
    /// black.
    pub mean_bias: f64,
    /// The mean FLIP of the displayed images of 8 bits, 0 to 1; see [`flip()`].
    pub flip: f64,
}

impl ImageError {
    /// Compares an image with a reference. Their noise must be independent: no seed is shared.
    ///
    /// The exposure is in stops.
    ///
    /// # Panics
    ///
    /// If their sizes differ.
    pub fn of(image: &Film, reference: &Reference, exposure: f32) -> ImageError {
        image.assert_same_size(reference.mean());
        let image = exposed(image, exposure);
        let expected = exposed(reference.mean(), exposure);
        let reference = reference.exposed(exposure);
        let over_pixels = |value: fn(DVec3, &ReferencePixel) -> DVec3| -> Vec<f64> {
            let pixels = pairs(&image, &reference);
            pixels.map(|(x, r)| channel_mean(value(x, r))).collect()
        };
        let errors = pairs(&image, &reference).flat_map(|(x, r)| r.relative(x).to_array());
        let mut errors: Vec<f64> = errors.collect();
        let difference = mean(&over_pixels(|x, r| x - r.mean()));
        let mean_bias = difference / mean(&over_pixels(|_, r| r.mean()));
        let [shown, expected] = [&image, &expected].map(Film::to_srgb8);
        ImageError {
            mse: mean(&over_pixels(|x, r| squared_error(x, r.half_buffers))),
            rel_mse: mean(&over_pixels(|x, r| {
                squared_error(x, r.half_buffers) / r.normaliser
            })),
            p95_relative_error: percentile(&mut errors, 0.95),
            mean_bias,
            flip: flip([image.width(), image.height()], &expected, &shown),
        }
    }
}

/// The relative error at each pixel, row by row from the top left: the root of the mean over R, G and B of
/// (x - r)^2 / (m^2 + 0.01). The reference's noise counts as the image's; the exposure is in stops.
///
/// # Panics
///
/// If their sizes differ.
pub fn relative_errors(image: &Film, reference: &Reference, exposure: f32) -> Vec<f32> {
    image.assert_same_size(reference.mean());
    let image = exposed(image, exposure);
    let reference = reference.exposed(exposure);
    let error = |(x, r): (DVec3, &ReferencePixel)| (r.relative(x).length_squared() / 3.0).sqrt();
    let errors = pairs(&image, &reference).map(error);
    errors.map(|error| error as f32).collect()
}

/// Each pixel of the image with the reference's.
fn pairs<'a>(
    image: &'a Film,
    reference: &'a [ReferencePixel],
) -> impl Iterator<Item = (DVec3, &'a ReferencePixel)> {
    let pixels = image.pixels().iter().zip(reference);
    pixels.map(|(x, reference)| (x.as_dvec3(), reference))
}

#[cfg(test)]
mod tests {
    use super::super::Estimate;
    use super::super::synthetic::Noise;
    use super::*;
    use glam::Vec3;

    /// Light from a fifth of white to white.
    fn slope(width: u32, height: u32) -> Film {
        let mut film = Film::new(width, height);
        let last = (width * height) as f32;
        for (i, pixel) in film.pixels_mut().iter_mut().enumerate() {
            let value = 0.2 + 0.8 * i as f32 / last;
            *pixel = value * Vec3::new(1.0, 0.9, 0.8);
        }
        film
    }

    /// The mean of the reference has more noise than the image.
    #[test]
    fn squared_errors_are_free_of_the_references_noise() {
        let truth = slope(96, 64);
        let mut noise = Noise::new(3);
        let (of_picture, of_half) = (0.02_f64, 0.03_f64);
        let [a, b] = noise.half_buffers(&truth, of_half);
        let reference = Reference::new(a, b);
        let image = noise.image(&truth, of_picture);
        let difference = ImageError::of(&image, &reference, 0.0);
        let relative = difference.rel_mse;
        let channels = truth.pixels().iter().flat_map(|pixel| pixel.to_array());
        let weights: Vec<f64> = channels
            .map(|r| (f64::from(r).powi(2) + 0.01).recip())
            .collect();
        let [x, half] = [of_picture, of_half].map(|sigma| sigma.powi(2));
        let variance = 2.0 * x * x + 2.0 * x * half + half * half;
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        let error = (variance * squares).sqrt() / weights.len() as f64;
        let off = relative - x * mean(&weights);
        assert!(off.abs() < 4.0 * error, "{relative} off by {off}");
        assert!(error < 0.05 * relative);
        let rmse = difference.mse.sqrt();
        assert!((rmse - 0.02).abs() < 1e-3, "{difference:?}");
        // Two stops more are four times the light.
        let brighter = ImageError::of(&image, &reference, 2.0);
        assert!((brighter.mse.sqrt() - 4.0 * rmse).abs() < 1e-6);
        assert!(brighter.rel_mse > relative);
    }

    #[test]
    fn a_perfect_picture_has_no_error_on_average() {
        let truth = slope(32, 32);
        let mut noise = Noise::new(4);
        let mut negative = 0;
        let measured = [0; 40].map(|_| {
            let [a, b] = noise.half_buffers(&truth, 0.05);
            let difference = ImageError::of(&truth, &Reference::new(a, b), 0.0);
            negative += usize::from(difference.mse < 0.0);
            difference.mse
        });
        let measured = Estimate::of(&measured);
        assert!(measured.mean.abs() < 4.0 * measured.error, "{measured:?}");
        assert!((10..30).contains(&negative), "{negative}");
    }

    #[test]
    fn the_mean_bias_is_how_much_too_bright_it_is() {
        let truth = slope(40, 40);
        let [a, b] = Noise::new(5).half_buffers(&truth, 0.01);
        let reference = Reference::new(a, b);
        let brighter = truth.weighted_sum(1.02, &truth, 0.0);
        let difference = ImageError::of(&brighter, &reference, 1.5);
        // The mean of 9,600 numbers that are off by 0.01.
        assert!((difference.mean_bias - 0.02).abs() < 1e-3, "{difference:?}");
    }

    #[test]
    fn percentile_and_map_are_of_the_relative_error() {
        let black = Film::new(20, 10);
        let reference = Reference::new(black.clone(), black.clone());
        let mut image = black;
        for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
            // In black the divisor is 0.1.
            *pixel = Vec3::splat(0.1 * (i + 1) as f32 / 200.0);
        }
        let difference = ImageError::of(&image, &reference, 0.0);
        assert!((difference.p95_relative_error - 0.95).abs() < 1e-6);
        assert!((difference.rel_mse - 1.0 / 3.0).abs() < 0.01);
        let errors = relative_errors(&image, &reference, 0.0);
        assert!((errors[99] - 0.5).abs() < 1e-6 && errors.len() == 200);
        // Half the light in the same black.
        let errors = relative_errors(&image, &reference, -1.0);
        assert!((errors[99] - 0.25).abs() < 1e-6);
    }

    #[test]
    fn the_same_picture_differs_in_nothing() {
        for (width, height) in [(1, 1), (33, 20)] {
            let truth = slope(width, height);
            let reference = Reference::new(truth.clone(), truth.clone());
            let difference = ImageError::of(&truth, &reference, 1.0);
            assert_eq!(difference.mse, 0.0);
            assert_eq!(difference.rel_mse, 0.0);
            assert_eq!(difference.p95_relative_error, 0.0);
            assert_eq!(difference.mean_bias, 0.0);
            assert_eq!(difference.flip, 0.0);
        }
    }

    #[test]
    fn black_has_no_relative_mean() {
        let black = Film::new(1, 1);
        let reference = Reference::new(black.clone(), black.clone());
        let difference = ImageError::of(&black, &reference, 0.0);
        assert!(difference.mean_bias.is_nan());
        assert_eq!(difference.p95_relative_error, 0.0);
    }
}
