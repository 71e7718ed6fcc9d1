//! Monte Carlo estimates are unbiased, and converge as fast as theory predicts.

use crate::support::statistics::*;
use crate::support::*;
use flythrough::camera::Camera;
use flythrough::integrator::LightSampler;
use flythrough::metrics::mean;
use flythrough::render::RenderSettings;
use flythrough::scene::Scene;
use glam::DVec3;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::LazyLock;

const SIZE: [u32; 2] = [16, 12];

/// Paths of each of the runs whose mean is the reference.
fn reference_paths() -> u32 {
    scaled(512, 512, 2048)
}

/// The seeds of the runs whose errors are measured.
const SEEDS: Range<u32> = 0..16;

/// A Cornell box with a mirror, and with a near light that guides a quarter of the diffuse rays.
struct Room {
    scene: Scene,
    camera: Camera,
    /// Estimates of 4 bounces that share no seeds with those they are compared with.
    reference: Vec<Estimate>,
}

static ROOM: LazyLock<Room> = LazyLock::new(|| {
    let scene = shipped_scene("test3.ron");
    assert!(!LightSampler::new(&scene).is_empty());
    let camera = shipped_path("test3.ron").camera(0);
    let reference = runs(
        &scene,
        &camera,
        &centers(4, &[reference_paths()]),
        1_000_000..1_000_032,
    );
    Room {
        scene,
        camera,
        reference: estimates(&reference),
    }
});

/// Settings whose camera rays go through pixel centres, so that only paths are random.
fn centers(bounces: u32, splits: &[u32]) -> RenderSettings {
    settings(monte_carlo(bounces, splits), SIZE[0], SIZE[1])
}

/// The mean of (x - r)^2 / (r^2 + 0.01).
fn rel_mse(picture: &[f64], reference: &[f64]) -> f64 {
    let errors = picture.iter().zip(reference);
    let sum: f64 = errors.map(|(x, r)| (x - r).powi(2) / (r * r + 0.01)).sum();
    sum / picture.len() as f64
}

fn errors(runs: &[Vec<f64>], reference: &[f64]) -> Vec<f64> {
    let error = |run: &Vec<f64>| rel_mse(run, reference);
    runs.iter().map(error).collect()
}

fn means(estimates: &[Estimate]) -> Vec<f64> {
    estimates.iter().map(|estimate| estimate.mean).collect()
}

/// 32 seeds rather than 8: in 576 comparisons, noise alone is off by up to 10 standard errors with 7 degrees of
/// freedom, but by 5 with 31.
#[test]
fn estimates_are_unbiased() {
    let Room {
        scene,
        camera,
        reference,
    } = &*ROOM;
    let paths = reference_paths() / 128;
    for splits in [&[paths][..], &[paths, 2]] {
        let agreement = |bounces| {
            let estimates = estimates(&runs(scene, camera, &centers(bounces, splits), 0..32));
            // The reference adds next to nothing to the errors.
            let variance = |of: &[Estimate]| of.iter().map(|e| e.error.powi(2)).sum::<f64>();
            assert!(variance(reference) < 0.01 * variance(&estimates));
            Agreement::of(&estimates, reference, 31, 0.0)
        };
        let four = agreement(4);
        assert!(four.holds(), "{splits:?}: {four:?}");
        // A missing bounce is detected.
        let three = agreement(3);
        assert!(!three.holds(), "{splits:?}: {three:?}");
    }
}

/// Independent samples, each with a seed of its own, converge as 1/n. Sobol points do so, too, in what depends on
/// several bounces at once, but faster in the rest.
#[test]
fn sobol_points_converge_faster_over_many_bounces() {
    let Room {
        scene,
        camera,
        reference,
    } = &*ROOM;
    let reference = means(reference);
    let seeds = scaled(8, 8, 16);
    let samples = runs(scene, camera, &centers(4, &[1]), 0..seeds * 256);
    let independent = |log: u32| {
        let runs = samples.chunks_exact(256).map(|run| &run[..1 << log]);
        let errors = runs.map(|run| rel_mse(&means(&estimates(run)), &reference));
        errors.collect()
    };
    let sobol = |log: u32| {
        let runs = runs(scene, camera, &centers(4, &[1 << log]), 0..seeds);
        errors(&runs, &reference)
    };
    let independent: Vec<Vec<f64>> = (0..=8).map(independent).collect();
    let sobol: Vec<Vec<f64>> = (0..=8).map(sobol).collect();
    let (independent_slope, sobol_slope) = (slope(&independent), slope(&sobol));
    assert!(independent_slope.error < 0.03);
    assert!(
        (independent_slope.mean + 1.0).abs() < 4.0 * independent_slope.error,
        "{independent_slope:?}"
    );
    assert!(
        sobol_slope.mean + 4.0 * sobol_slope.error < -1.0,
        "{sobol_slope:?}"
    );
    assert!(mean(&sobol[8]) < mean(&independent[8]));
}

/// Where an edge crosses a pixel, only the strata that it crosses are noisy: about n^(1/2) of n, each with a variance
/// of n^-2, which makes n^(-3/2).
#[test]
fn edges_converge_as_n_to_the_minus_three_halves() {
    let Room { scene, camera, .. } = &*ROOM;
    let of_samples = |samples, seeds| {
        let settings = spread(monte_carlo(0, &[]), SIZE, samples);
        runs(scene, camera, &settings, seeds)
    };
    let last = scaled(9, 9, 11);
    let reference = means(&estimates(&of_samples(2 << last, 1000..1016)));
    let error = |log: u32| errors(&of_samples(1 << log, SEEDS), &reference);
    let slope = slope(&(6..=last).map(error).collect::<Vec<_>>());
    assert!((-1.6..-1.4).contains(&slope.mean), "{slope:?}");
}

/// What is smooth in two dimensions converges as n^-3 log n (Owen 1997, "Scrambled Net Variance for
/// Integrals of Smooth Functions"). Along a kink, which the map of the square to the hemisphere has along its
/// diagonals, n^(1/2) strata are each off by their width, n^(-1/2), over n, which makes n^(-5/2). Here with one bounce
/// inside a sphere, where the irradiance is known: I rho / R^2.
#[test]
fn smooth_light_converges_as_n_to_the_minus_five_halves_or_faster() {
    let scene = scene(
        "Scene(
            materials: {\"grey\": (diffuse: (0.5, 0.5, 0.5))},
            lights: [(position: (5, -1, 7), intensity: (3, 3, 3))],
            objects: [sphere(center: (5, -2, 7), radius: 2, material: \"grey\")],
        )",
    );
    assert!(LightSampler::new(&scene).is_empty());
    let camera = camera(DVec3::new(4.5, -2.5, 6.5), DVec3::new(9.0, -2.0, 6.0), 40.0);
    let direct = channels(&render(&scene, &camera, &centers(0, &[])));
    let indirect = 0.5 / PI * 0.5 * 3.0 / 4.0;
    let reference: Vec<f64> = direct.iter().map(|direct| direct + indirect).collect();
    let error = |log: u32| {
        let runs = runs(&scene, &camera, &centers(1, &[1 << log]), SEEDS);
        errors(&runs, &reference)
    };
    let slope = slope(&(7..=scaled(10, 10, 12)).map(error).collect::<Vec<_>>());
    assert!((-3.1..-2.5).contains(&slope.mean), "{slope:?}");
}
