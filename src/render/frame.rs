//! One frame: first samples, adaptive samples, picture and estimated error.

use super::accumulator::SampleAccumulator;
use super::adaptive::Survey;
use super::error_estimate::FrameErrorEstimate;
use super::grid::{Grid, average_corners};
use super::half_buffer_error::HalfBufferError;
use super::held_out::{ErrorEstimator, PixelSamples};
use super::observer::{NoObserver, RenderObserver};
use super::picture::Picture;
use super::sampler::Sampler;
use super::{PixelSampling, RenderSettings, Renderer};
use crate::camera::Camera;
use crate::film::Film;
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
    /// Its error.
    pub error: FrameErrorEstimate,
    /// How many rays were traced.
    pub rays: u64,
    /// How many samples were not finite and were replaced by black. Only numbers near the limits of single precision in
    /// the scene, or a bug, make any.
    pub non_finite_samples: u64,
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
}

/// How many tiles a frame without adaptive samples reports to its observer.
pub fn tile_count(settings: &RenderSettings) -> u64 {
    Grid::of(settings).tiles()
}

/// Lower and upper bound of the bytes of memory that a frame takes while it is rendered and encoded.
pub fn frame_memory(settings: &RenderSettings) -> [u64; 2] {
    // Per point: means and numbers of samples; of two half buffers also image, difference and expected errors; of
    // adaptive samples the moments of quadrants. The allocator returns less memory of small frames.
    let bytes = if settings.is_adaptive() {
        [140, 320]
    } else if settings.has_half_buffers() {
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
        let grid = Grid::of(&self.settings);
        let sampler = Sampler::new(self, camera, frame);
        let mut samples = SampleAccumulator::new(grid, &sampler);
        let cache_error = self.cache_errors.get(frame as usize).copied();
        let target = self.settings.target_of_samples(cache_error);
        // A pixel like those around it keeps a single sample, without another half buffer.
        let has_single = target.is_some() && sampler.first == 1 && !self.settings.is_noisy();
        let first = |index: usize| match has_single && index % 2 == 1 {
            true => 0,
            false => sampler.first,
        };
        samples.refine(grid, &sampler, first, observer);
        let (picture, error) = match target {
            Some(target) => self.refined(&mut samples, grid, &sampler, target, observer)?,
            None if observer.is_stopped() => return None,
            None => {
                let picture = self.picture(&samples);
                let expected_errors = picture.contrasts();
                let error = self.error(&mut samples, &picture, expected_errors, &sampler, 0);
                (picture, error)
            }
        };
        Some(RenderedFrame {
            film: picture.film,
            half_difference: picture.half_difference,
            error: cache_error.map_or(error, |cache| error.plus_cache(cache)),
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
    ) -> Option<(Picture, FrameErrorEstimate)> {
        /// The part of the target that the upper bound of the error by half buffers shall take, with what single samples
        /// are expected to add.
        const AIM: f64 = 0.97;
        /// How many estimates of the whole error may be above the target before the frame is given as it is.
        const MOST_ESTIMATES: u32 = 6;
        let settings = &self.settings;
        let (width, display_white) = (settings.width as usize, settings.display_white);
        let mut aim = AIM * target;
        let mut estimates = 0;
        // The error of single samples, over what their contrast makes expected: only held-out pixels know it.
        let mut of_expected = None;
        loop {
            if observer.is_stopped() {
                return None;
            }
            let survey = Survey::new(samples, width, display_white, settings.is_noisy());
            let picture = self.picture(samples);
            let of_halves = HalfBufferError::of(&picture).map(|error| error.estimate().interval());
            let singles = survey.error_of_singles(&samples.counts);
            let is_first = singles > 0.0 && of_expected.is_none();
            let of_halves = of_halves.map_or(0.0, |[_, upper]| upper);
            let known = of_halves + of_expected.unwrap_or(0.0) * singles;
            // One decision for all pixels, on which a single pixel has next to no influence.
            if !is_first
                && known > aim
                && let Some(next) = survey.next_counts(&samples.counts, aim / known, sampler.most())
            {
                samples.refine(grid, sampler, |index| next[index], observer);
                continue;
            }
            let mut expected_errors = survey.expected_errors(&samples.counts);
            if singles > 0.0 {
                // Those around a single sample do not know that it hit something small; its own contrast tells.
                let halves = samples.counts.chunks_exact(2);
                let expected = expected_errors.iter_mut().zip(halves);
                for ((expected, halves), contrast) in expected.zip(picture.contrasts()) {
                    if halves[1] == 0 {
                        *expected = expected.max(contrast);
                    }
                }
            }
            let error = self.error(samples, &picture, expected_errors, sampler, estimates);
            let [_, upper] = error.whole.interval();
            estimates += 1;
            if upper <= target || estimates == MOST_ESTIMATES {
                return Some((picture, error));
            }
            if is_first {
                of_expected = Some(upper / singles);
            } else {
                // What half buffers and single samples do not tell is left in proportion.
                aim = known.min(aim) * (AIM * target / upper).min(0.9);
            }
        }
    }

    /// The error of a picture of all samples so far.
    fn error(
        &self,
        samples: &mut SampleAccumulator,
        picture: &Picture,
        expected_errors: Vec<f32>,
        sampler: &Sampler,
        round: u32,
    ) -> FrameErrorEstimate {
        let has_fixed_positions = matches!(
            self.settings.sampling,
            PixelSampling::Center | PixelSampling::Corners
        );
        let estimator = ErrorEstimator {
            picture,
            expected_errors,
            samples: match self.settings.is_adaptive() {
                true => PixelSamples::Listed(&samples.counts),
                false => PixelSamples::Even(sampler.half_buffers as u32 * sampler.first),
            },
            has_fixed_positions,
            has_textures: !self.scene().textures().is_empty(),
        };
        let (error, work) = estimator.estimate(&sampler.of_whole_pixels(), round);
        samples.rays += work.query_state.rays;
        samples.non_finite += work.non_finite;
        error
    }

    /// The picture of all samples so far.
    fn picture(&self, samples: &SampleAccumulator) -> Picture {
        let resolve = |points: Vec<Vec3>| resolve_pixels(&self.settings, points);
        let SampleAccumulator { means, counts, .. } = samples;
        let halves = || {
            let means = means.par_chunks_exact(2);
            means.zip(counts.par_chunks_exact(2))
        };
        let (film, half_difference): (Vec<Vec3>, _) = match self.settings.has_half_buffers() {
            false => (means.clone(), None),
            true => {
                let value = |(halves, counts): (&[Vec3], &[u32])| match counts[1] {
                    0 => halves[0],
                    _ => 0.5 * (halves[0] + halves[1]),
                };
                let difference = |(halves, counts): (&[Vec3], &[u32])| match counts[1] {
                    0 => Vec3::ZERO,
                    _ => 0.5 * (halves[0] - halves[1]),
                };
                (
                    halves().map(value).collect(),
                    Some(halves().map(difference).collect()),
                )
            }
        };
        Picture {
            film: resolve(film),
            half_difference: half_difference.map(resolve),
            spacing: match self.settings.sampling {
                PixelSampling::Corners if self.settings.is_noisy() => 2,
                _ => 1,
            },
            is_noisy: self.settings.is_noisy(),
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
