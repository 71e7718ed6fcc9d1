use super::Failure;
use super::args::JobArguments;
use super::interrupt::Interrupt;
use super::light::{LightStore, PathLight};
use super::loading::{Loaded, load};
use super::progress::{SequenceProgress, Shown, Steps};
use crate::forecast::Stage;
use crate::frames::{FrameFormat, PlanCommand, SequenceRecord};
use crate::input::{GlobalIllumination, Settings};
use crate::render::{
    FrameSink, Outcome, PixelSampling, RenderSettings, render_sequence, tile_count,
};
use std::path::Path;

/// Everything that decides the frames of a sequence: inputs loaded, settings resolved.
pub(super) struct Job {
    pub(super) loaded: Loaded,
    /// The settings of frames that gather light exactly.
    exact: RenderSettings,
    /// The settings of frames: until the light is there that they look up, the exact ones.
    pub(super) settings: RenderSettings,
    /// The light that frames look up, until it is there; none if they gather it.
    light: Option<PathLight>,
    /// The names of the paths that the light is of.
    light_of: Option<Vec<String>>,
    exposure: f32,
    format: FrameFormat,
    error_maps: bool,
}

impl Job {
    /// Of a preview, or of the frames themselves. `out` is their folder, if there is one. With `force`, light that is
    /// there but cannot be used is worked out anew.
    pub(super) fn new(
        arguments: &JobArguments,
        is_preview: bool,
        out: Option<&Path>,
        force: bool,
    ) -> Result<Job, Failure> {
        let flags = arguments.settings.settings();
        flags.check().map_err(|error| error.of_flag())?;
        let loaded = load(&arguments.input, &arguments.threads)?;
        let given = loaded.settings(flags);
        let given = if is_preview { given.preview() } else { given };
        given.check_together()?;
        let exact = given.resolve();
        let store = match (&arguments.gi_cache, out) {
            (Some(file), _) => LightStore::Shared(file.clone()),
            (None, Some(out)) => LightStore::Own(out.join("irradiance.cache")),
            (None, None) => LightStore::Nowhere,
        };
        let light = light(store, &given, &loaded, &exact, force)?;
        let error_maps = arguments.aov.is_some();
        if error_maps {
            refuse_maps_without_noise(&exact, light.is_some())?;
        }
        Ok(Job {
            settings: exact.clone(),
            light_of: light.as_ref().map(PathLight::paths),
            exposure: given.exposure.unwrap_or(0.0),
            format: FrameFormat::from(arguments.format),
            loaded,
            exact,
            light,
            error_maps,
        })
    }

    /// How many frames the path has.
    pub(super) fn frame_count(&self) -> u32 {
        self.loaded.path.path.timeline().frame_count()
    }

    /// Sees to it that the light is there that frames look up.
    pub(super) fn bake(&mut self, quiet: bool) -> Result<(), Failure> {
        if let Some(light) = self.light.take() {
            self.settings = light.bake(&self.loaded, &self.exact, quiet)?;
        }
        Ok(())
    }

    /// Frames of so many camera samples in each pixel.
    pub(super) fn take_samples(&mut self, samples: u32) {
        for settings in [&mut self.exact, &mut self.settings] {
            settings.sampling = PixelSampling::Spread(samples);
        }
    }

    /// What the frames are to be.
    pub(super) fn sequence(&self) -> Result<SequenceRecord, Failure> {
        let path = &self.loaded.path.path;
        let timeline = path.timeline();
        let program = SequenceRecord::program();
        // Of the path a frame knows its camera, and the light that is worked out for all of it.
        let of_all = format!(
            "{program} {:?} {:?} {} {:?}",
            self.exact, self.light_of, self.exposure, self.format
        );
        let input_hash = |frame| {
            let mut hasher = blake3::Hasher::new();
            hasher.update(self.loaded.scene_fingerprint.as_bytes());
            hasher.update(of_all.as_bytes());
            hasher.update(format!("{frame} {:?}", path.camera(frame)).as_bytes());
            hasher.finalize().to_string()
        };
        let typed = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned());
        Ok(SequenceRecord {
            program,
            command: PlanCommand {
                folder: std::env::current_dir()?,
                arguments: typed.collect(),
            },
            fps: timeline.fps,
            frames: timeline.frame_count(),
            width: self.exact.width,
            height: self.exact.height,
            format: self.format,
            exposure: self.exposure,
            error_maps: self.error_maps,
            path_light: self.light_of.is_some(),
            input_hash: (0..timeline.frame_count()).map(input_hash).collect(),
        })
    }

    /// Renders frames for a sink, and shows how it goes on; the first signal from now on only asks for an end.
    pub(super) fn render<Sink: FrameSink>(
        &self,
        frames: &[u32],
        sink: &Sink,
        shown: Shown,
        interrupt: Interrupt,
    ) -> Outcome {
        // How many samples a frame will need until it is good enough nobody knows: it counts as a whole.
        let steps = match self.settings.target_error {
            Some(_) => Steps::Frames,
            None => Steps::Tiles(tile_count(&self.settings)),
        };
        interrupt.wait_to_be_asked();
        let progress = SequenceProgress::new(frames.len() as u64, steps, shown, interrupt);
        let outcome = render_sequence(
            &self.loaded.scene.scene,
            &self.loaded.path.path,
            &self.settings,
            frames,
            &self.loaded.pool,
            sink,
            &progress,
        );
        progress.finish();
        outcome
    }

    /// What a forecast renders frames of.
    pub(super) fn stage<'a>(&'a self, sequence: &'a SequenceRecord) -> Stage<'a> {
        Stage {
            scene: &self.loaded.scene.scene,
            path: &self.loaded.path.path,
            pool: &self.loaded.pool,
            sequence,
        }
    }
}

/// The light that frames look up; none if they gather it.
fn light(
    store: LightStore,
    given: &Settings,
    loaded: &Loaded,
    exact: &RenderSettings,
    force: bool,
) -> Result<Option<PathLight>, Failure> {
    let frames = loaded.path.path.timeline().frame_count();
    match (given.global_illumination(frames), &store) {
        (GlobalIllumination::Cached, _) => Ok(Some(PathLight::open(store, loaded, exact, force)?)),
        (GlobalIllumination::PathTraced, LightStore::Shared(_)) => {
            Err("--gi-cache: add --gi cached".into())
        }
        (GlobalIllumination::PathTraced, _) => Ok(None),
    }
}

fn refuse_maps_without_noise(settings: &RenderSettings, looks_up: bool) -> Result<(), Failure> {
    let (has_noise, advice) = match looks_up {
        true => (
            settings.has_noise_looking_up(),
            "take more camera samples, or --gi path-traced",
        ),
        false => (settings.has_noise(), "choose a montecarlo mode"),
    };
    match has_noise {
        true => Ok(()),
        false => Err(format!("--aov error: nothing is left to chance here; {advice}").into()),
    }
}
