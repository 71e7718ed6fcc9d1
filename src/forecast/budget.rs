//! The number of camera samples that a time budget allows.

use super::estimate::Estimate;
use super::pilot::Workload;
use crate::render::PixelSampling;

/// Largest number of camera samples of a pixel.
const MAX_SAMPLES: u32 = 1 << 16;

/// Numbers of samples that are tried.
const TRIES: usize = 4;

/// The most camera samples of each pixel with which all frames take at most `seconds`, by the upper 95 % bound of the
/// estimate; and that estimate. None if one sample takes longer. `memory` are the bytes that the program takes now.
pub fn samples_within(workload: Workload, seconds: f64, memory: f64) -> Option<(u32, Estimate)> {
    let frames: Vec<u32> = (0..workload.path.timeline().frame_count()).collect();
    let estimate = |samples: u32| {
        let sampling = PixelSampling::Spread(samples);
        let renderer = workload.renderer.with_sampling(sampling);
        let workload = Workload {
            renderer,
            ..workload.clone()
        };
        let estimate = Estimate::new(&workload, memory);
        (estimate.seconds(&frames).high, estimate)
    };
    let mut best: Option<(u32, Estimate)> = None;
    let mut samples = 1;
    for _ in 0..TRIES {
        let (most, estimate) = estimate(samples);
        if most <= seconds && best.as_ref().is_none_or(|(least, _)| *least < samples) {
            best = Some((samples, estimate));
        }
        // Cost is linear in samples, plus what comes before the first: each try is nearer than the last.
        let next = (f64::from(samples) * seconds / most) as u32;
        let next = next.clamp(1, MAX_SAMPLES);
        if next == samples {
            break;
        }
        samples = next;
    }
    best
}
