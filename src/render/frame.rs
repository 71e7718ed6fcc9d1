use super::allocation::Allocation;
use super::grid::{Grid, average_corners};
use super::noise::{ErrorEstimate, RelativeDeviations};
use super::samples::{Estimates, Sampler};
use super::watch::{Unwatched, Watch};
use super::{PixelSampling, RenderSettings};
use crate::camera::Camera;
use crate::film::Film;
use crate::scene::Scene;
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

/// Renders frame number `frame` through `camera` on the threads of the current pool.
pub fn render_frame(
    scene: &Scene,
    camera: &Camera,
    settings: &RenderSettings,
    frame: u32,
) -> RenderedFrame {
    let rendered = render_watched(scene, camera, settings, frame, &Unwatched);
    rendered.expect("nobody stops it")
}

/// The same under the eyes of `watch`; none if that stops it.
pub(super) fn render_watched(
    scene: &Scene,
    camera: &Camera,
    settings: &RenderSettings,
    frame: u32,
    watch: &dyn Watch,
) -> Option<RenderedFrame> {
    let grid = Grid::of(settings);
    let sampler = Sampler::new(scene, camera, settings, frame);
    let mut estimates = Estimates::new(grid, &sampler);
    estimates.refine(grid, &sampler, |_| 1, watch);
    if watch.is_stopped() {
        return None;
    }
    let light_error = settings.cache_errors.get(frame as usize).copied();
    if sampler.halves == 1 {
        let film = develop(settings, estimates.values);
        return Some(RenderedFrame {
            film,
            deviation: None,
            error: light_error,
            rays: estimates.rays,
            non_finite_samples: estimates.non_finite,
        });
    }
    let mut developed = develop_halves(settings, &estimates);
    if let Some(target) = settings.target_error {
        let [values, deviations] = combine(&estimates);
        let width = grid.width as usize;
        let allocation = Allocation::new(&values, &deviations, width, settings.white);
        let target = target_of_noise(target, light_error);
        while let Some(share) = share_to_go(&developed.2, target) {
            let wanted = allocation.passes(&estimates.passes, share, sampler.most_passes());
            if wanted == estimates.passes {
                break;
            }
            estimates.refine(grid, &sampler, |number| wanted[number], watch);
            if watch.is_stopped() {
                return None;
            }
            developed = develop_halves(settings, &estimates);
        }
    }
    let (film, deviation, noise) = developed;
    Some(RenderedFrame {
        film,
        deviation: Some(deviation),
        error: Some(light_error.map_or(noise, |light| light.plus(noise))),
        rays: estimates.rays,
        non_finite_samples: estimates.non_finite,
    })
}

/// What is left of a target error by the light that is looked up: half of it at least, as no samples make good
/// what the light takes beyond its half.
fn target_of_noise(target: f64, light_error: Option<ErrorEstimate>) -> f64 {
    let of_light = light_error.map_or(0.0, |light| light.interval()[1]);
    (target - of_light).max(0.5 * target)
}

/// What share of its error should be left of a frame by its next samples; none if it is good enough.
///
/// The decision is one for all pixels, each of which has next to no part in it.
fn share_to_go(error: &ErrorEstimate, target: f64) -> Option<f64> {
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
        settings.white,
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
