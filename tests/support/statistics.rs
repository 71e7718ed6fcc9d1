//! Statistics of Monte Carlo estimates: whether they agree, and how fast they converge.

pub(crate) use flythrough::metrics::Estimate;

use super::{pixels, render_frame, renderer, settings};
use flythrough::camera::Camera;
use flythrough::integrator::IntegratorSettings;
use flythrough::metrics::student_t;
use flythrough::render::{PixelSampling, RenderSettings};
use flythrough::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;

/// Settings with `samples` camera samples spread over each pixel.
pub(crate) fn spread(
    integrator: IntegratorSettings,
    [width, height]: [u32; 2],
    samples: u32,
) -> RenderSettings {
    RenderSettings {
        sampling: PixelSampling::Spread(samples),
        ..settings(integrator, width, height)
    }
}

/// The channels of pixels.
pub(crate) fn channels(pixels: &[Vec3]) -> Vec<f64> {
    let channels = pixels.iter().flat_map(|pixel| pixel.to_array());
    channels.map(f64::from).collect()
}

/// The channels of a frame, rendered with each of the seeds.
pub(crate) fn runs(
    scene: &Scene,
    camera: &Camera,
    settings: &RenderSettings,
    seeds: std::ops::Range<u32>,
) -> Vec<Vec<f64>> {
    let renderer = renderer(scene, settings);
    let with_seed = |seed| channels(&pixels(&renderer.with_seed(seed), camera));
    let first = channels(&render_frame(&renderer.with_seed(seeds.start), camera));
    let runs: Vec<Vec<f64>> = seeds.into_par_iter().map(with_seed).collect();
    for (pixel, frame) in runs[0].iter().zip(&first) {
        assert!((pixel - frame).abs() <= 1e-6 * frame, "{pixel} {frame}");
    }
    runs
}

/// The mean and the standard error of each channel over independent runs.
pub(crate) fn estimates(runs: &[Vec<f64>]) -> Vec<Estimate> {
    let estimate = |i: usize| {
        let values: Vec<f64> = runs.iter().map(|run| run[i]).collect();
        Estimate::of(&values)
    };
    (0..runs[0].len()).map(estimate).collect()
}

/// How well estimates agree with references: z is their difference over its standard error.
#[derive(Debug)]
pub(crate) struct Agreement {
    /// The largest |z|.
    pub(crate) worst: f64,
    /// What noise alone exceeds in 1 of 100 comparisons like this one (Sidak 1967).
    pub(crate) limit: f64,
    /// The mean of z^2: 1 if both are unbiased and their standard errors are right.
    pub(crate) mean_square: f64,
}

impl Agreement {
    /// Compares estimates from `degrees + 1` runs, an even number, with references from at least as many, or with exact
    /// values.
    ///
    /// `rounding` times the value is added to the standard error.
    pub(crate) fn of(
        estimates: &[Estimate],
        references: &[Estimate],
        degrees: u32,
        rounding: f64,
    ) -> Agreement {
        assert_eq!(estimates.len(), references.len());
        let pairs = estimates.iter().zip(references);
        let squares = pairs.filter_map(|(a, b)| {
            let rounding = rounding * b.mean;
            let variance = a.error.powi(2) + b.error.powi(2) + rounding.powi(2);
            let square = (a.mean - b.mean).powi(2) / variance;
            assert!(!square.is_nan() || a.mean == b.mean, "{a:?} {b:?}");
            // Black in both has no error at all.
            (a.mean != b.mean || variance > 0.0).then_some(square)
        });
        let squares: Vec<f64> = squares.collect();
        assert!(!squares.is_empty());
        let count = squares.len() as f64;
        Agreement {
            worst: squares.iter().copied().fold(0.0, f64::max).sqrt(),
            limit: student_t(degrees, 1.0 - 0.99_f64.powf(1.0 / count)),
            mean_square: squares.iter().sum::<f64>() / count,
        }
    }

    /// Whether no estimate is further off than noise explains.
    pub(crate) fn holds(&self) -> bool {
        self.worst <= self.limit
    }
}

/// The slope of the logarithm of the mean error over the logarithm of the number of samples, by least squares. Its
/// standard error is that of the jackknife: one run after the other is left out.
///
/// `errors` are those of independent runs, for numbers of samples each of which is twice the last.
pub(crate) fn slope(errors: &[Vec<f64>]) -> Estimate {
    let middle = (errors.len() as f64 - 1.0) / 2.0;
    let without = |left_out: Option<usize>| {
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for (size, errors) in errors.iter().enumerate() {
            let kept = (0..errors.len()).filter(|run| Some(*run) != left_out);
            let sum: f64 = kept.map(|run| errors[run]).sum();
            let x = size as f64 - middle;
            numerator += x * sum.log2();
            denominator += x * x;
        }
        numerator / denominator
    };
    let count = errors[0].len();
    let mean = without(None);
    let squares: f64 = (0..count)
        .map(|run| (without(Some(run)) - mean).powi(2))
        .sum();
    Estimate {
        mean,
        error: (squares * (count as f64 - 1.0) / count as f64).sqrt(),
    }
}
