//! Maps of the error of a frame that are kept beside it: its arbitrary output variables.

use super::{RenderedFrame, Renderer};
use crate::camera::Camera;
use crate::film::Film;
use crate::metrics::normaliser;
use glam::Vec3;

/// What a map beside a frame shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// The estimated standard error of every pixel.
    Error,
    /// The part of it that the irradiance cache makes.
    CacheError,
}

impl RenderedFrame {
    /// A map of the frame, in linear light.
    pub fn map(&self, aov: Aov) -> Film {
        match aov {
            Aov::Error => self.standard_errors(),
            Aov::CacheError => match &self.cache_errors {
                Some(cache_errors) => cache_errors.clone(),
                None => Film::new(self.film.width(), self.film.height()),
            },
        }
    }
}

impl Renderer<'_> {
    /// The standard error of each pixel of a frame by its irradiance cache: half the difference of the pixels by each half
    /// of the cache's paths, scaled so that it makes up the cache error of the frame. None without halves.
    pub(super) fn cache_error_map(&self, camera: &Camera, frame: u32, film: &Film) -> Option<Film> {
        let halves = self.cache_halves.as_ref()?;
        let (width, height) = (self.settings.width, self.settings.height);
        let pixels: Vec<(u32, u32)> = (0..width * height)
            .map(|number| (number % width, number / width))
            .collect();
        let [a, b] = halves
            .each_ref()
            .map(|half| half.render_pixels(camera, frame, &pixels));
        let both = a.iter().zip(&b);
        let half_difference = both.map(|([a, _], [b, _])| 0.5 * (*a - *b).abs());
        let mut errors: Vec<Vec3> = half_difference.collect();
        let relative = |(index, error): (usize, &Vec3)| {
            let white = self.settings.display_white;
            let square = normaliser(film.pixels(), width as usize, index, 1, white);
            f64::from((*error * *error / square).element_sum() / 3.0)
        };
        let sum: f64 = errors.iter().enumerate().map(relative).sum();
        let error = self.cache_errors.get(frame as usize);
        let rel_mse = error.map_or(0.0, |error| error.rel_mse);
        if sum > 0.0 {
            let factor = (rel_mse * errors.len() as f64 / sum).sqrt() as f32;
            errors.iter_mut().for_each(|error| *error *= factor);
        }
        Some(Film::from_pixels(width, height, errors))
    }
}
