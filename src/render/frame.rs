//! One frame: first samples, adaptive samples, image and estimated error.

use super::accumulator::SampleAccumulator;
use super::adaptive::SampleAllocation;
use super::error_estimate::{ErrorEstimate, RelativeHalfDifferences};
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
    pub half_difference: Option<Film>,
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
        match &self.half_difference {
            Some(half_difference) => {
                [1.0, -1.0].map(|sign| self.film.weighted_sum(1.0, half_difference, sign))
            }
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
    // Per point: value and number of passes; of two half buffers also image and difference. The allocator returns less
    // memory of small frames.
    let bytes = if settings.has_noise() {
        [60, 160]
    } else {
        [16, 90]
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
        let mut accumulator = SampleAccumulator::new(grid, &sampler);
        accumulator.refine(grid, &sampler, |_| 1, observer);
        if observer.is_stopped() {
            return None;
        }
        let cache_error = self.cache_errors.get(frame as usize).copied();
        if sampler.half_buffers == 1 {
            let film = resolve_pixels(settings, accumulator.values);
            return Some(RenderedFrame {
                film,
                half_difference: None,
                error: cache_error,
                rays: accumulator.rays,
                non_finite_samples: accumulator.non_finite,
            });
        }
        let mut resolved = resolve_half_buffers(settings, &accumulator);
        if let Some(target) = settings.target_error {
            let [values, half_differences] = combine(&accumulator);
            let width = grid.width as usize;
            let allocation =
                SampleAllocation::new(&values, &half_differences, width, settings.display_white);
            let target = noise_target(target, cache_error);
            while let Some(fraction) = next_error_fraction(&resolved.2, target) {
                let wanted = allocation.passes(&accumulator.passes, fraction, sampler.max_passes());
                if wanted == accumulator.passes {
                    break;
                }
                accumulator.refine(grid, &sampler, |index| wanted[index], observer);
                if observer.is_stopped() {
                    return None;
                }
                resolved = resolve_half_buffers(settings, &accumulator);
            }
        }
        let (film, half_difference, noise) = resolved;
        Some(RenderedFrame {
            film,
            half_difference: Some(half_difference),
            error: Some(cache_error.map_or(noise, |cache| cache.plus(noise))),
            rays: accumulator.rays,
            non_finite_samples: accumulator.non_finite,
        })
    }
}

/// The part of a target error that the irradiance cache leaves for noise: at least half, as more samples cannot make up
/// for a cache that takes more than half.
fn noise_target(target: f64, cache_error: Option<ErrorEstimate>) -> f64 {
    let of_cache = cache_error.map_or(0.0, |cache| cache.interval()[1]);
    (target - of_cache).max(0.5 * target)
}

/// The fraction of a frame's error that its next samples should leave; none if the target is reached.
///
/// One decision for all pixels, on which a single pixel has next to no influence: means stay unbiased.
fn next_error_fraction(error: &ErrorEstimate, target: f64) -> Option<f64> {
    /// Errors fall faster than 1 / n: larger steps would overshoot.
    const MIN_FRACTION: f64 = 0.25;
    let [_, upper] = error.interval();
    (upper > target).then(|| (0.97 * target / upper).max(MIN_FRACTION))
}

/// The mean and half the difference of the half buffers at each point.
fn combine(accumulator: &SampleAccumulator) -> [Vec<Vec3>; 2] {
    let halves = || accumulator.values.chunks_exact(2);
    [
        halves().map(|half| 0.5 * (half[0] + half[1])).collect(),
        halves().map(|half| 0.5 * (half[0] - half[1])).collect(),
    ]
}

/// The image, half the difference of its half buffers, and its noise.
fn resolve_half_buffers(
    settings: &RenderSettings,
    accumulator: &SampleAccumulator,
) -> (Film, Film, ErrorEstimate) {
    let [film, half_difference] =
        combine(accumulator).map(|points| resolve_pixels(settings, points));
    let relative = RelativeHalfDifferences::new(
        film.pixels(),
        half_difference.pixels(),
        settings.width as usize,
        settings.display_white,
        settings.sampling == PixelSampling::Corners,
    );
    let noise = ErrorEstimate::of(&relative);
    (film, half_difference, noise)
}

/// The pixels from the points' values.
fn resolve_pixels(settings: &RenderSettings, points: Vec<Vec3>) -> Film {
    let (width, height) = (settings.width, settings.height);
    if settings.sampling != PixelSampling::Corners {
        return Film::from_pixels(width, height, points);
    }
    let mut film = Film::new(width, height);
    average_corners(&points, width, film.pixels_mut());
    film
}
