//! Images with noise of known variance, for tests.

use crate::film::Film;
use crate::sampling::Random;
use glam::Vec3;
use std::f64::consts::TAU;

/// Normally distributed numbers, the same in every run.
#[derive(Debug)]
pub(crate) struct Noise(Random);

impl Noise {
    pub(crate) fn new(seed: u64) -> Noise {
        Noise(Random::new(seed))
    }

    /// A number of mean 0 and variance 1 (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let [u, v] = [0; 2].map(|_| f64::from(self.0.unit()));
        (-2.0 * libm::log(1.0 - u)).sqrt() * libm::cos(TAU * v)
    }

    /// A radiance with noise of standard deviation `sigma` in each channel.
    pub(crate) fn light(&mut self, truth: Vec3, sigma: f64) -> Vec3 {
        let mut channel = || (sigma * self.normal()) as f32;
        truth + Vec3::new(channel(), channel(), channel())
    }

    /// A radiance whose channels are uniformly distributed between two values.
    pub(super) fn between(&mut self, low: f32, high: f32) -> Vec3 {
        let mut channel = || low + (high - low) * self.0.unit();
        Vec3::new(channel(), channel(), channel())
    }

    /// An image that is `value` everywhere.
    pub(super) fn even(&self, width: u32, height: u32, value: f32) -> Film {
        let mut film = Film::new(width, height);
        film.pixels_mut().fill(Vec3::splat(value));
        film
    }

    /// An image with noise of standard deviation `sigma` in each channel.
    pub(super) fn image(&mut self, truth: &Film, sigma: f64) -> Film {
        let mut film = truth.clone();
        for pixel in film.pixels_mut() {
            *pixel = self.light(*pixel, sigma);
        }
        film
    }

    /// Two half buffers with noise of standard deviation `sigma`.
    pub(super) fn half_buffers(&mut self, truth: &Film, sigma: f64) -> [Film; 2] {
        [0; 2].map(|_| self.image(truth, sigma))
    }
}
