use super::pilot::Stage;
use super::quote::Quote;
use crate::render::{PixelSampling, Renderer};

/// The most camera samples that anybody gets.
const MOST: u32 = 1 << 16;

/// How often a number of samples is tried.
const TRIES: usize = 4;

/// The most camera samples of each pixel with which all frames are expected to be there within `seconds`, with
/// the whole of the forecast's interval; and that forecast. None if one sample is too much.
pub fn samples_within(
    stage: Stage,
    renderer: &Renderer,
    seconds: f64,
    memory: f64,
) -> Option<(u32, Quote)> {
    let frames: Vec<u32> = (0..stage.path.timeline().frame_count()).collect();
    let quote = |samples: u32| {
        let renderer = renderer.with_sampling(PixelSampling::Spread(samples));
        let quote = Quote::new(stage, &renderer, memory);
        (quote.seconds(&frames).high, quote)
    };
    let mut best = None;
    let mut samples = 1;
    for _ in 0..TRIES {
        let (most, quote) = quote(samples);
        let is_more = |best: &Option<(u32, Quote)>| best.as_ref().is_none_or(|(n, _)| *n < samples);
        if most <= seconds && is_more(&best) {
            best = Some((samples, quote));
        }
        // Cost goes up with their number, and with what comes before the first: the next try is near, and the
        // one after it is nearer.
        let next = (f64::from(samples) * seconds / most) as u32;
        let next = next.clamp(1, MOST);
        if next == samples {
            break;
        }
        samples = next;
    }
    best
}
