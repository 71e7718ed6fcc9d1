use super::Failure;
use super::args::JobArguments;
use super::interrupt::Interrupt;
use super::light::{LightStore, PathLight};
use super::loading::{Loaded, load};
use super::progress::{SequenceProgress, Shown, Steps};
use crate::bake::Baked;
use crate::forecast::Stage;
use crate::frames::{FrameFormat, PlanCommand, SequenceRecord};
use crate::integrator::IntegratorSettings;
use crate::render::{FrameSink, Outcome, PixelSampling, RenderSettings, Renderer, tile_count};
use std::path::Path;

/// Everything that decides the frames of a sequence: inputs loaded, settings resolved.
pub(super) struct Job {
    pub(super) loaded: Loaded,
    /// The settings of frames.
    pub(super) settings: RenderSettings,
    /// The light that frames look up, until it is there; none if they gather it.
    light: Option<PathLight>,
    /// That light, once it is there.
    baked: Option<Baked>,
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
        let settings = given.resolve(loaded.path.path.timeline().frame_count());
        let store = match (&arguments.gi_cache, out) {
            (Some(file), _) => LightStore::Shared(file.clone()),
            (None, Some(out)) => LightStore::Own(out.join("irradiance.cache")),
            (None, None) => LightStore::Nowhere,
        };
        let light = light(store, &loaded, &settings, force)?;
        let error_maps = arguments.aov.is_some();
        if error_maps {
            refuse_maps_without_noise(&settings)?;
        }
        Ok(Job {
            baked: None,
            light_of: light.as_ref().map(PathLight::paths),
            exposure: given.exposure.unwrap_or(0.0),
            format: FrameFormat::from(arguments.format),
            loaded,
            settings,
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
            self.baked = Some(light.bake(&self.loaded, &self.settings, quiet)?);
        }
        Ok(())
    }

    /// Frames of so many camera samples in each pixel.
    pub(super) fn take_samples(&mut self, samples: u32) {
        self.settings.sampling = PixelSampling::Spread(samples);
    }

    /// What the frames are to be.
    pub(super) fn sequence(&self) -> Result<SequenceRecord, Failure> {
        let path = &self.loaded.path.path;
        let timeline = path.timeline();
        let program = SequenceRecord::program();
        // Of the path a frame knows its camera, and the light that is worked out for all of it.
        let of_all = format!(
            "{program} {:?} {:?} {} {:?}",
            self.settings, self.light_of, self.exposure, self.format
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
            width: self.settings.width,
            height: self.settings.height,
            format: self.format,
            exposure: self.exposure,
            error_maps: self.error_maps,
            path_light: self.light_of.is_some(),
            input_hash: (0..timeline.frame_count()).map(input_hash).collect(),
        })
    }

    /// What renders its frames, once the light is there that they look up.
    pub(super) fn renderer(&self) -> Result<Renderer<'_>, Failure> {
        let cache = self.baked.as_ref().map(|baked| &baked.cache);
        let errors = self.baked.as_ref().map_or(&[][..], |baked| &baked.errors);
        let renderer = Renderer::new(&self.loaded.scene.scene, self.settings.clone(), cache)?;
        Ok(renderer.with_cache_errors(errors))
    }

    /// Renders frames for a sink, and shows how it goes on; the first signal from now on only asks for an end.
    pub(super) fn render<Sink: FrameSink>(
        &self,
        frames: &[u32],
        sink: &Sink,
        shown: Shown,
        interrupt: Interrupt,
    ) -> Result<Outcome, Failure> {
        let renderer = self.renderer()?;
        // How many samples a frame will need until it is good enough nobody knows: it counts as a whole.
        let steps = match self.settings.target_error {
            Some(_) => Steps::Frames,
            None => Steps::Tiles(tile_count(&self.settings)),
        };
        interrupt.wait_to_be_asked();
        let progress = SequenceProgress::new(frames.len() as u64, steps, shown, interrupt);
        let outcome = renderer.render_sequence(
            &self.loaded.path.path,
            frames,
            &self.loaded.pool,
            sink,
            &progress,
        );
        progress.finish();
        Ok(outcome)
    }

    /// What a forecast renders frames of.
    pub(super) fn stage<'a>(&'a self, sequence: &'a SequenceRecord) -> Stage<'a> {
        Stage {
            path: &self.loaded.path.path,
            pool: &self.loaded.pool,
            sequence,
        }
    }
}

/// The light that frames look up; none if they gather it.
fn light(
    store: LightStore,
    loaded: &Loaded,
    settings: &RenderSettings,
    force: bool,
) -> Result<Option<PathLight>, Failure> {
    match (&settings.integrator, &store) {
        (IntegratorSettings::Cached { .. }, _) => {
            Ok(Some(PathLight::open(store, loaded, settings, force)?))
        }
        (_, LightStore::Shared(_)) => Err("--gi-cache: add --gi cached".into()),
        _ => Ok(None),
    }
}

fn refuse_maps_without_noise(settings: &RenderSettings) -> Result<(), Failure> {
    if settings.has_noise() {
        return Ok(());
    }
    let advice = match settings.integrator {
        IntegratorSettings::Cached { .. } => "take more camera samples, or --gi path-traced",
        _ => "choose a montecarlo mode",
    };
    Err(format!("--aov error: nothing is left to chance here; {advice}").into())
}
