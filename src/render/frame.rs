//! One frame: first samples, adaptive samples, image and estimated error.

use super::adaptive::SampleAllocation;
use super::error_estimate::{ErrorEstimate, RelativeDeviations};
use super::estimates::Estimates;
use super::grid::{Grid, average_corners};
use super::observer::{NoObserver, RenderObserver};
use super::sampler::Sampler;
use super::{PixelSampling, RenderSettings, Renderer};
use crate::camera::Camera;
use crate::film::Film;
use glam::Vec3;

/// A rendered frame.
#[derive(Debug)]
pub struct RenderedFrame {
    /// The image: scene-linear radiance.
    pub film: Film,
    /// Half the difference of the A/B half buffers: they are the image plus and minus this. Its square is an unbiased
    /// estimate of the variance of the pixel. None if the frame has no Monte Carlo noise.
    pub deviation: Option<Film>,
    /// The error by noise and by the irradiance cache; none if the frame has neither.
    pub error: Option<ErrorEstimate>,
    /// How many rays were traced.
    pub rays: u64,
    /// How many samples were not finite and were replaced by black. Only numbers near the limits of single precision in
    /// the scene, or a bug, make any.
    pub non_finite_samples: u64,
}

impl RenderedFrame {
    /// The two independent half buffers, A and B, whose mean is the image; the image itself, twice, if it has no
    /// noise.
    pub fn half_buffers(&self) -> [Film; 2] {
        match &self.deviation {
            Some(deviation) => [1.0, -1.0].map(|sign| self.film.weighted_sum(1.0, deviation, sign)),
            None => [self.film.clone(), self.film.clone()],
        }
    }
}

/// How many tiles a frame without adaptive samples reports to its observer.
pub fn tile_count(settings: &RenderSettings) -> u64 {
    Grid::of(settings).tiles()
}

/// Lower and upper bound of the bytes of memory that a frame takes while it is rendered and encoded.
pub fn frame_memory(settings: &RenderSettings) -> [u64; 2] {
    // Per point: value and number of passes, and both again in the tile with the point's position; of two half buffers
    // also image and difference. The allocator returns less memory of small frames.
    let bytes = if settings.has_noise() {
        [80, 160]
    } else {
        [36, 90]
    };
    bytes.map(|bytes| bytes * Grid::of(settings).len() as u64)
}

impl Renderer<'_> {
    /// Renders frame number `frame` through `camera`, on the threads of the current pool.
    pub fn render_frame(&self, camera: &Camera, frame: u32) -> RenderedFrame {
        let rendered = self.render_observed(camera, frame, &NoObserver);
        rendered.expect("it is never stopped")
    }

    /// As [`Renderer::render_frame`], with an observer; none if that stops it.
    pub(super) fn render_observed(
        &self,
        camera: &Camera,
        frame: u32,
        observer: &dyn RenderObserver,
    ) -> Option<RenderedFrame> {
        let settings = &self.settings;
        let grid = Grid::of(settings);
        let sampler = Sampler::new(self, camera, frame);
        let mut estimates = Estimates::new(grid, &sampler);
        estimates.refine(grid, &sampler, |_| 1, observer);
        if observer.is_stopped() {
            return None;
        }
        let cache_error = self.cache_errors.get(frame as usize).copied();
        if sampler.half_buffers == 1 {
            let film = develop(settings, estimates.values);
            return Some(RenderedFrame {
                film,
                deviation: None,
                error: cache_error,
                rays: estimates.rays,
                non_finite_samples: estimates.non_finite,
            });
        }
        let mut developed = develop_halves(settings, &estimates);
        if let Some(target) = settings.target_error {
            let [values, deviations] = combine(&estimates);
            let width = grid.width as usize;
            let allocation =
                SampleAllocation::new(&values, &deviations, width, settings.display_white);
            let target = target_of_noise(target, cache_error);
            while let Some(fraction) = fraction_to_go(&developed.2, target) {
                let wanted = allocation.passes(&estimates.passes, fraction, sampler.most_passes());
                if wanted == estimates.passes {
                    break;
                }
                estimates.refine(grid, &sampler, |number| wanted[number], observer);
                if observer.is_stopped() {
                    return None;
                }
                developed = develop_halves(settings, &estimates);
            }
        }
        let (film, deviation, noise) = developed;
        Some(RenderedFrame {
            film,
            deviation: Some(deviation),
            error: Some(cache_error.map_or(noise, |cache| cache.plus(noise))),
            rays: estimates.rays,
            non_finite_samples: estimates.non_finite,
        })
    }
}

/// The part of a target error that the irradiance cache leaves for noise: at least half, as more samples cannot make up
/// for a cache that takes more than half.
fn target_of_noise(target: f64, cache_error: Option<ErrorEstimate>) -> f64 {
    let of_cache = cache_error.map_or(0.0, |cache| cache.interval()[1]);
    (target - of_cache).max(0.5 * target)
}

/// The fraction of a frame's error that its next samples should leave; none if the target is reached.
///
/// One decision for all pixels, on which a single pixel has next to no influence: means stay unbiased.
fn fraction_to_go(error: &ErrorEstimate, target: f64) -> Option<f64> {
    /// Errors fall faster than 1 / n: larger steps would overshoot.
    const MIN_FRACTION: f64 = 0.25;
    let [_, upper] = error.interval();
    (upper > target).then(|| (0.97 * target / upper).max(MIN_FRACTION))
}

/// The mean and half the difference of the half buffers at each point.
fn combine(estimates: &Estimates) -> [Vec<Vec3>; 2] {
    let halves = || estimates.values.chunks_exact(2);
    [
        halves().map(|half| 0.5 * (half[0] + half[1])).collect(),
        halves().map(|half| 0.5 * (half[0] - half[1])).collect(),
    ]
}

/// The image, half the difference of its half buffers, and its noise.
fn develop_halves(settings: &RenderSettings, estimates: &Estimates) -> (Film, Film, ErrorEstimate) {
    let [film, deviation] = combine(estimates).map(|points| develop(settings, points));
    let deviations = RelativeDeviations::new(
        film.pixels(),
        deviation.pixels(),
        settings.width as usize,
        settings.display_white,
        settings.sampling == PixelSampling::Corners,
    );
    let noise = ErrorEstimate::of(&deviations);
    (film, deviation, noise)
}

/// The pixels from the points' values.
fn develop(settings: &RenderSettings, points: Vec<Vec3>) -> Film {
    let (width, height) = (settings.width, settings.height);
    if settings.sampling != PixelSampling::Corners {
        return Film::from_pixels(width, height, points);
    }
    let mut film = Film::new(width, height);
    average_corners(&points, width, film.pixels_mut());
    film
}
