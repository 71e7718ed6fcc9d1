//! References: two independent half buffers of the same image.

use super::mean;
use super::normaliser;
use super::pixel::{channel_mean, mean_of_two};
use crate::film::Film;
use glam::DVec3;

/// Two independent half buffers, A and B, of one image, and their mean.
///
/// Each is unbiased, with noise of its own. From both together the noise of the reference can be estimated, and errors
/// against it without that noise.
#[derive(Clone, Debug)]
pub struct Reference {
    a: Film,
    b: Film,
    mean: Film,
}

impl Reference {
    /// A reference of two unbiased images with different seeds.
    ///
    /// # Panics
    ///
    /// If their sizes differ.
    pub fn new(a: Film, b: Film) -> Reference {
        let mean = a.weighted_sum(0.5, &b, 0.5);
        Reference { a, b, mean }
    }

    /// The mean of the half buffers.
    pub fn mean(&self) -> &Film {
        &self.mean
    }

    /// The estimated relMSE of the mean, at an exposure in stops: the mean over pixels and channels of
    /// ((A - B) / 2)^2 / (m^2 + 0.01), the expectation of whose numerator is the variance of the mean.
    pub fn rel_mse(&self, exposure: f32) -> f64 {
        let squares = self.exposed(exposure).into_iter().map(|pixel| {
            let half = 0.5 * (pixel.half_buffers[0] - pixel.half_buffers[1]);
            channel_mean(half * half / pixel.normaliser)
        });
        let squares: Vec<f64> = squares.collect();
        mean(&squares)
    }

    /// The standard error of the mean radiance of all pixels, relative to it.
    pub fn error_of_mean(&self) -> f64 {
        let half_buffers = self.a.pixels().iter().zip(self.b.pixels());
        let squares = half_buffers.map(|(a, b)| {
            let half = 0.5 * (a.as_dvec3() - b.as_dvec3());
            channel_mean(half).powi(2)
        });
        let light = self
            .mean
            .pixels()
            .iter()
            .map(|r| channel_mean(r.as_dvec3()));
        squares.sum::<f64>().sqrt() / light.sum::<f64>()
    }

    /// The pixels in units of display white.
    pub(super) fn exposed(&self, exposure: f32) -> Vec<ReferencePixel> {
        let [a, b, mean] = [&self.a, &self.b, &self.mean].map(|film| exposed(film, exposure));
        let width = mean.width() as usize;
        let pixel = |index: usize| ReferencePixel {
            half_buffers: [&a, &b].map(|film| film.pixels()[index].as_dvec3()),
            normaliser: normaliser(mean.pixels(), width, index, 1, 1.0).as_dvec3(),
        };
        (0..mean.pixels().len()).map(pixel).collect()
    }
}

/// A pixel of a reference, in units of display white.
#[derive(Clone, Copy)]
pub(super) struct ReferencePixel {
    pub(super) half_buffers: [DVec3; 2],
    /// What squared errors there are divided by.
    pub(super) normaliser: DVec3,
}

impl ReferencePixel {
    /// The mean of the half buffers.
    pub(super) fn mean(&self) -> DVec3 {
        mean_of_two(self.half_buffers)
    }

    /// |x - r| / sqrt(m^2 + 0.01), with the noise of the reference.
    pub(super) fn relative(&self, x: DVec3) -> DVec3 {
        (x - self.mean()).abs() / self.normaliser.map(f64::sqrt)
    }
}

/// The image at an exposure in stops.
pub(super) fn exposed(film: &Film, exposure: f32) -> Film {
    let mut film = film.clone();
    film.expose(exposure);
    film
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::Noise;
    use super::*;
    use glam::Vec3;

    #[test]
    fn knows_its_own_noise() {
        let mut noise = Noise::new(1);
        let truth = noise.even(64, 48, 0.5);
        let [a, b] = noise.half_buffers(&truth, 0.1);
        let reference = Reference::new(a, b);
        for exposure in [0.0, -2.0] {
            let scale = libm::exp2(exposure);
            // The mean of two has half the variance.
            let expected = (0.1 * scale).powi(2) / 2.0 / ((0.5 * scale).powi(2) + 0.01);
            let own = reference.rel_mse(exposure as f32);
            // Of 3072 pixels, each the mean of two half buffers and of three channels.
            let error = 0.1 / 0.5 / (2.0_f64 * 3.0 * 3072.0).sqrt();
            assert!((reference.error_of_mean() / error - 1.0).abs() < 0.06);
            // Of 9216 channels; the noise of the mean of eight adds up to 3 / 8 of the square.
            let tolerance = 4.0 * expected * (2.0_f64 / 9216.0).sqrt() + 0.4 * expected * expected;
            assert!((own - expected).abs() < tolerance, "{own} {expected}");
        }
    }

    #[test]
    fn its_mean_is_between_its_halves() {
        let [mut a, b] = [Film::new(1, 1), Film::new(1, 1)];
        a.pixels_mut()[0] = Vec3::new(1.0, 2.0, 3.0);
        let reference = Reference::new(a, b);
        assert_eq!(reference.mean().pixels(), [Vec3::new(0.5, 1.0, 1.5)]);
        // One pixel has none around it: ((1 / 4) / 0.26 + 1 / 1.01 + (9 / 4) / 2.26) / 3.
        let own = reference.rel_mse(0.0);
        assert!((own - 0.982_404).abs() < 1e-6, "{own}");
    }

    #[test]
    #[should_panic(expected = "different sizes")]
    fn halves_are_of_one_size() {
        Reference::new(Film::new(2, 1), Film::new(1, 2));
    }
}
