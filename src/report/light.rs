use super::seconds::Seconds;
use super::{Inputs, Progress, pixels};
use crate::bake::{Baked, bake};
use crate::input::{GlobalIllumination, Mode, Settings};
use crate::render::{RenderSettings, Renderer};
use serde::Serialize;

/// Paths that it takes for each pixel of the sequence, about: in `test3` and in `gallery`.
const PATHS: f64 = 0.1;

/// What it takes to work out the light of the path, once for all of its frames.
#[derive(Clone, Debug, Serialize)]
pub struct Bake {
    /// Seconds.
    pub seconds: f64,
    /// Seconds of all processors together.
    pub cpu_seconds: f64,
    /// The frames that share it: all of the path.
    pub frames: u32,
    /// IrradianceRecords that the camera sees, and places beyond.
    pub places: [usize; 2],
    /// Bytes that the light takes.
    pub bytes: usize,
}

impl Bake {
    /// Each frame's share.
    pub fn seconds_per_frame(&self) -> f64 {
        self.seconds / f64::from(self.frames)
    }
}

/// The light of the whole path as a rendering of the whole sequence works it out, at its own size.
///
/// It is worked out once, for all that looks it up: what is wrong with it is the same in every picture, whatever
/// the seed, and counts as bias.
pub(super) struct PathLight {
    baked: Baked,
    pub(super) bake: Bake,
}

impl PathLight {
    pub(super) fn new(inputs: &Inputs, progress: &mut Progress) -> PathLight {
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
        let bake = Bake {
            seconds: seconds.wall,
            cpu_seconds: seconds.cpu,
            frames: inputs.path.timeline().frame_count(),
            places: baked.cache.record_count(),
            bytes: baked.cache.memory(),
        };
        PathLight { baked, bake }
    }

    /// What renders frames of these settings.
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

/// About how many paths it takes, for a forecast.
pub(super) fn work(inputs: &Inputs) -> f64 {
    let frames = inputs.path.timeline().frame_count();
    PATHS * pixels(inputs.full_size()) * f64::from(frames)
}
