use super::adaptive::SampleAllocation;
use super::error_estimate::{ErrorEstimate, RelativeDeviations};
use super::grid::{Grid, average_corners};
use super::observer::{FrameObserver, NoObserver};
use super::sampler::{Estimates, Sampler};
use super::{PixelSampling, RenderSettings, Renderer};
use crate::camera::Camera;
use crate::film::Film;
use glam::Vec3;

/// A frame and what it took.
#[derive(Debug)]
pub struct RenderedFrame {
    /// The picture.
    pub film: Film,
    /// Half the difference of the two halves of its samples, whose mean it is: the halves are the picture plus
    /// and minus this. Its square is an unbiased estimate of the variance of the pixel. None where nothing was
    /// left to chance.
    pub deviation: Option<Film>,
    /// How far off it is: by chance, and by the light that it looked up. None where neither had a part.
    pub error: Option<ErrorEstimate>,
    /// How many rays were traced.
    pub rays: u64,
    /// Samples whose light was not a finite number, replaced by black: a fault of the scene's
    /// numbers or of the program.
    pub non_finite_samples: u64,
}

impl RenderedFrame {
    /// The two halves that it is the mean of, independent of each other; the frame itself, twice, where nothing
    /// was left to chance.
    pub fn halves(&self) -> [Film; 2] {
        match &self.deviation {
            Some(deviation) => [1.0, -1.0].map(|sign| self.film.weighted_sum(1.0, deviation, sign)),
            None => [self.film.clone(), self.film.clone()],
        }
    }
}

/// How many steps of progress a frame makes that is not refined after its first samples.
pub fn tile_count(settings: &RenderSettings) -> u64 {
    Grid::of(settings).tiles()
}

/// The fewest and the most bytes that a frame takes while it is rendered and encoded.
pub fn frame_memory(settings: &RenderSettings) -> [u64; 2] {
    // Of each point: its value, the number of its passes, and both once more in its tile with where it is; of two
    // halves also what is developed of them. The allocator gives back less of what it has of small frames.
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
        observer: &dyn FrameObserver,
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
        if sampler.halves == 1 {
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

/// What is left of a target error by the light that is looked up: half of it at least, as no samples make good
/// what the light takes beyond its half.
fn target_of_noise(target: f64, cache_error: Option<ErrorEstimate>) -> f64 {
    let of_cache = cache_error.map_or(0.0, |cache| cache.interval()[1]);
    (target - of_cache).max(0.5 * target)
}

/// What share of its error should be left of a frame by its next samples; none if it is good enough.
///
/// The decision is one for all pixels, each of which has next to no part in it.
fn fraction_to_go(error: &ErrorEstimate, target: f64) -> Option<f64> {
    /// Errors fall faster than as 1 / n: larger steps would overshoot.
    const LEAST: f64 = 0.25;
    let [_, upper] = error.interval();
    (upper > target).then(|| (0.97 * target / upper).max(LEAST))
}

/// The mean and half the difference of the two halves of each point.
fn combine(estimates: &Estimates) -> [Vec<Vec3>; 2] {
    let halves = || estimates.values.chunks_exact(2);
    [
        halves().map(|half| 0.5 * (half[0] + half[1])).collect(),
        halves().map(|half| 0.5 * (half[0] - half[1])).collect(),
    ]
}

/// The picture, half the difference of its halves, and its noise.
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

/// The pixels, of what is known of the points.
fn develop(settings: &RenderSettings, points: Vec<Vec3>) -> Film {
    let (width, height) = (settings.width, settings.height);
    if settings.sampling != PixelSampling::Corners {
        return Film::from_pixels(width, height, points);
    }
    let mut film = Film::new(width, height);
    average_corners(&points, width, film.pixels_mut());
    film
}
