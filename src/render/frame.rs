//! One frame: first samples, adaptive samples, picture and estimated error.

use super::accumulator::SampleAccumulator;
use super::adaptive::Survey;
use super::effort::Effort;
use super::error_estimate::{ErrorEstimate, ErrorEstimates, FrameErrorEstimate};
use super::error_estimator::{ErrorEstimator, Estimate, PixelSamples};
use super::grid::{Grid, average_corners};
use super::observer::{NoObserver, RenderObserver};
use super::picture::Picture;
use super::sampler::Sampler;
use super::{PixelSampling, RenderSettings, Renderer};
use crate::camera::Camera;
use crate::film::Film;
use crate::metrics::normaliser;
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;

/// A rendered frame.
#[derive(Debug)]
pub struct RenderedFrame {
    /// The image: scene-linear radiance.
    pub film: Film,
    /// Half the difference of the A/B half buffers: they are the image plus and minus this. Its square is an unbiased
    /// estimate of the variance of the pixel. None if the frame has no half buffers.
    pub half_difference: Option<Film>,
    /// The expected squared error of each pixel, relative to its [`normaliser`], up to a common factor.
    pub expected_errors: Vec<f32>,
    /// The standard error of each pixel by the irradiance cache; none without, or if it was not asked for.
    pub cache_errors: Option<Film>,
    /// The radiance that is displayed as white.
    pub display_white: f32,
    /// Its error.
    pub error: FrameErrorEstimate,
    /// How many rays were traced.
    pub rays: u64,
    /// How many samples were not finite and were replaced by black. Only numbers near the limits of single precision in
    /// the scene, or a bug, make any.
    pub non_finite_samples: u64,
}

/// A picture, and what is known of its error.
struct Pictured {
    picture: Picture,
    /// As [`RenderedFrame::expected_errors`].
    expected_errors: Vec<f32>,
    estimates: ErrorEstimates,
}

impl Pictured {
    fn new(expected_errors: Vec<f32>, picture: Picture) -> Pictured {
        Pictured {
            picture,
            expected_errors,
            estimates: ErrorEstimates::NONE,
        }
    }
}

impl RenderedFrame {
    /// The two independent half buffers, A and B, whose mean is the image; the image itself, twice, if it has
    /// none.
    pub fn half_buffers(&self) -> [Film; 2] {
        match &self.half_difference {
            Some(half_difference) => {
                [1.0, -1.0].map(|sign| self.film.weighted_sum(1.0, half_difference, sign))
            }
            None => [self.film.clone(), self.film.clone()],
        }
    }

    /// The estimated standard error of each pixel: half the difference of the half buffers or, without, what is expected,
    /// scaled so that it makes up the error of the frame.
    pub fn standard_errors(&self) -> Film {
        let (width, height) = (self.film.width(), self.film.height());
        let errors = match &self.half_difference {
            Some(half_difference) => half_difference.pixels().iter().map(|d| d.abs()).collect(),
            None => {
                let expected = self.expected_errors.iter().map(|&error| f64::from(error));
                let mean = expected.sum::<f64>() / self.expected_errors.len() as f64;
                let factor = if mean > 0.0 {
                    self.error.whole.rel_mse / mean
                } else {
                    0.0
                };
                let error = |(index, expected): (usize, &f32)| {
                    let pixels = self.film.pixels();
                    let square = normaliser(pixels, width as usize, index, 1, self.display_white);
                    (factor as f32 * expected * square).map(f32::sqrt)
                };
                self.expected_errors.iter().enumerate().map(error).collect()
            }
        };
        Film::from_pixels(width, height, errors)
    }
}

/// How many tiles a frame without adaptive samples reports to its observer.
pub fn tile_count(settings: &RenderSettings) -> u64 {
    Grid::of(settings).tiles()
}

/// Lower and upper bound of the bytes of memory that a frame of a scene takes while it is rendered and encoded.
pub fn frame_memory(scene: &Scene, settings: &RenderSettings) -> [u64; 2] {
    // Per point: means and numbers of samples; of two half buffers also image, difference and expected errors; of
    // adaptive samples the moments of quadrants. The allocator returns less memory of small frames.
    let bytes = if settings.is_adaptive() {
        [140, 320]
    } else if settings.is_noisy(scene) {
        [60, 200]
    } else {
        [20, 100]
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
        if let Some(renderer) = self.instead(frame) {
            return renderer.render_observed(camera, frame, observer);
        }
        let grid = Grid::of(&self.settings);
        let sampler = Sampler::new(self, camera, frame);
        let mut samples = SampleAccumulator::new(grid, &sampler);
        let cache_error = self.cache_errors.get(frame as usize).copied();
        let target = self.settings.target_of_samples(self.scene(), cache_error);
        samples.refine(grid, &sampler, |_| sampler.first, observer);
        let pictured = match target {
            Some(target) => self.refined(&mut samples, grid, &sampler, target, observer)?,
            None if observer.is_stopped() => return None,
            None => {
                let picture = self.picture(&samples);
                let mut pictured = Pictured::new(picture.contrasts(), picture);
                self.estimate(&mut pictured, &mut samples, &sampler, &mut 0, |error| {
                    !error.is_vague()
                });
                pictured
            }
        };
        let Pictured {
            picture,
            expected_errors,
            estimates,
        } = pictured;
        let error = match (self.is_lit(), cache_error) {
            (false, _) => FrameErrorEstimate::UNKNOWN,
            (true, None) => estimates.mean(),
            (true, Some(cache)) => estimates.mean().plus_cache(cache),
        };
        Some(RenderedFrame {
            cache_errors: self.cache_error_map(camera, frame, &picture.film),
            film: picture.film,
            half_difference: picture.half_difference,
            expected_errors,
            display_white: self.settings.display_white,
            error,
            rays: samples.rays,
            non_finite_samples: samples.non_finite,
        })
    }

    /// Adds samples until the upper 95 % bound of the error is below `target`, or no more are possible; none if the
    /// observer stops.
    fn refined(
        &self,
        samples: &mut SampleAccumulator,
        grid: Grid,
        sampler: &Sampler,
        target: f64,
        observer: &dyn RenderObserver,
    ) -> Option<Pictured> {
        /// The part of the target that the upper bound of the error shall take.
        const AIM: f64 = 0.9;
        /// A pass that leaves more than this part of the error that was there before has stalled: those after it aim at this
        /// part of the error that they would aim at, ...
        const STALLED: f64 = 0.9;
        const AFTER_STALLED: f64 = 0.7;
        /// ... and a frame is given as it is after so many of them: more samples of the same kind do not help it.
        const MOST_STALLED: i32 = 6;
        let settings = &self.settings;
        let (width, display_white) = (settings.width as usize, settings.display_white);
        let (mut before, mut stalled) = (f64::INFINITY, 0);
        let mut round = 0;
        loop {
            if observer.is_stopped() {
                return None;
            }
            let survey = Survey::new(samples, width, display_white, self.is_noisy());
            let picture = self.picture(samples);
            let expected_errors = survey.expected_errors(&samples.counts, &picture.contrasts());
            let mut pictured = Pictured::new(expected_errors, picture);
            let is_reached = |error: &ErrorEstimate| error.interval()[1] <= target;
            // Not if the interval alone is above the target, or far above the error.
            let error = self.estimate(&mut pictured, samples, sampler, &mut round, |error| {
                is_reached(error) || error.rel_mse >= AIM * target && !error.is_vague()
            });
            let error = match is_reached(&error) {
                // Too low estimates end frames: one that has decided nothing mends some of that.
                true => self.estimate(&mut pictured, samples, sampler, &mut round, |_| true),
                false => error,
            };
            let [_, upper] = error.interval();
            stalled += i32::from(upper > STALLED * before);
            before = upper;
            if upper <= target || stalled == MOST_STALLED {
                return Some(pictured);
            }
            // As far as it is known: not more than twice the estimate.
            let known = upper.min(2.0 * error.rel_mse);
            // One decision for all pixels, on which a single pixel has next to no influence.
            let fraction = AIM * target / known.max(target) * AFTER_STALLED.powi(stalled);
            match survey.next_counts(&samples.counts, fraction, sampler.most()) {
                Some(next) => samples.refine(grid, sampler, |index| next[index], observer),
                None => return Some(pictured),
            }
        }
    }

    /// Estimates the error of a picture of all samples so far: until the mean of all estimates `is_enough`, or no effort
    /// tells more. There were `round` others of this frame.
    fn estimate(
        &self,
        pictured: &mut Pictured,
        samples: &mut SampleAccumulator,
        sampler: &Sampler,
        round: &mut u32,
        is_enough: impl Fn(&ErrorEstimate) -> bool,
    ) -> ErrorEstimate {
        let has_fixed_positions = matches!(
            self.settings.sampling,
            PixelSampling::Center | PixelSampling::Corners
        );
        let estimator = ErrorEstimator::new(
            &pictured.picture,
            &pictured.expected_errors,
            match self.settings.is_adaptive() {
                true => PixelSamples::Listed(&samples.counts),
                false => PixelSamples::Even(sampler.first),
            },
            has_fixed_positions,
            !self.scene().textures().is_empty(),
        );
        let sampler = sampler.of_whole_pixels();
        let mut effort = Effort::after(*round);
        loop {
            let Estimate {
                of_held_out,
                work,
                more,
            } = estimator.estimate(&sampler, effort);
            *round += 1;
            samples.rays += work.query_state.rays;
            samples.non_finite += work.non_finite;
            // The more rays, the more an estimate knows.
            let weight = work.query_state.rays.max(1) as f64;
            let estimates = &mut pictured.estimates;
            estimates.add(estimator.of_half_buffers, of_held_out, weight);
            let mean = estimates.mean().whole;
            match more {
                Some(more) if !is_enough(&mean) => effort = more,
                _ => return mean,
            }
        }
    }

    /// The picture of all samples so far.
    fn picture(&self, samples: &SampleAccumulator) -> Picture {
        let resolve = |points: Vec<Vec3>| resolve_pixels(&self.settings, points);
        let means = &samples.means;
        let (film, half_difference): (Vec<Vec3>, _) = match self.is_noisy() {
            false => (means.clone(), None),
            true => {
                let halves = || means.par_chunks_exact(2);
                let film = halves().map(|halves| 0.5 * (halves[0] + halves[1]));
                let difference = halves().map(|halves| 0.5 * (halves[0] - halves[1]));
                (film.collect(), Some(difference.collect()))
            }
        };
        Picture {
            film: resolve(film),
            half_difference: half_difference.map(resolve),
            spacing: match self.settings.sampling {
                PixelSampling::Corners if self.is_noisy() => 2,
                _ => 1,
            },
            display_white: self.settings.display_white,
        }
    }
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
