//! The irradiance cache of the sequence, baked once for all techniques that use it.

use super::inputs::{Inputs, pixels};
use super::progress::Progress;
use super::seconds::Seconds;
use crate::bake::{Baked, bake};
use crate::input::{GlobalIllumination, Mode, Settings};
use crate::render::{RenderSettings, Renderer};
use serde::Serialize;

/// Paths that baking traces for each pixel of the sequence, about: measured in `test3` and in `gallery`.
const PATHS: f64 = 0.1;

/// The cost of the irradiance cache, which all frames of a sequence share.
#[derive(Clone, Debug, Serialize)]
pub struct BakeCost {
    /// Seconds that baking takes.
    pub seconds: f64,
    /// CPU seconds, of all threads together.
    pub cpu_seconds: f64,
    /// The frames that share it: all of the camera path.
    pub frames: u32,
    /// Primary and secondary irradiance records.
    pub records: [usize; 2],
    /// Bytes of memory.
    pub bytes: usize,
}

impl BakeCost {
    /// The part of the seconds that each frame is charged.
    pub fn seconds_per_frame(&self) -> f64 {
        self.seconds / f64::from(self.frames)
    }
}

/// The irradiance cache as a rendering of the whole sequence bakes it, at its own size, and what it took.
///
/// As all frames of all seeds use the same cache, its error counts as bias.
pub(super) struct BakedCache {
    baked: Baked,
    pub(super) bake: BakeCost,
}

impl BakedCache {
    pub(super) fn new(inputs: &Inputs, progress: &mut Progress) -> BakedCache {
        let settings = Settings {
            mode: Some(Mode::Montecarlo),
            gi: Some(GlobalIllumination::Cached),
            target_error: None,
            ..inputs.given.clone()
        };
        let settings = inputs.resolve(&settings);
        let (baked, seconds) = Seconds::of(|| {
            progress.part(work(inputs), |listener| {
                bake(inputs.scene, inputs.path, "path", &settings, None, listener)
            })
        });
        let bake = BakeCost {
            seconds: seconds.wall,
            cpu_seconds: seconds.cpu,
            frames: inputs.path.timeline().frame_count(),
            records: baked.cache.record_count(),
            bytes: baked.cache.memory(),
        };
        BakedCache { baked, bake }
    }

    /// A renderer of these settings, which uses the cache where they ask for it.
    pub(super) fn renderer<'a>(
        &'a self,
        inputs: &Inputs<'a>,
        settings: RenderSettings,
    ) -> Renderer<'a> {
        Renderer::new(inputs.scene, settings, Some(&self.baked.cache))
            .expect("all settings have the bounces of the sequence")
            .with_cache_errors(&self.baked.errors)
    }
}

/// About how many paths baking traces, for the progress.
pub(super) fn work(inputs: &Inputs) -> f64 {
    let frames = inputs.path.timeline().frame_count();
    PATHS * pixels(inputs.full_size()) * f64::from(frames)
}
