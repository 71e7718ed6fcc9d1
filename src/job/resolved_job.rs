//! A job resolved: inputs loaded, settings complete, and what its frames are made from known.

use super::cache::{CacheLocation, KeepCache, OpenedCache};
use super::error::JobError;
use super::identity::{BUILD, CacheIdentity, SequenceInputs};
use super::inputs::Inputs;
use super::options::JobOptions;
use super::spec::{Spec, is_same};
use crate::bake::{Baked, CacheFileError, Listener};
use crate::forecast::Workload;
use crate::frames::{FrameFolder, SequenceRecord, is_name_of_frames};
use crate::input::{GlobalIllumination, Mode, Samples, Settings};
use crate::integrator::IntegratorSettings;
use crate::irradiance_cache::IrradianceCache;
use crate::memory::check_room;
use crate::render::{
    FRAMES_IN_FLIGHT, FrameSink, Outcome, PixelSampling, RenderObserver, RenderSettings, Renderer,
    frame_memory,
};
use crate::storage::WaitListener;
use rayon::ThreadPool;
use std::path::{Path, PathBuf};

/// About the memory that a frame of the path takes before it is rendered: its camera, hashes and records.
const BYTES_PER_FRAME: u64 = 800;

/// A job resolved: all that decides the frames of a sequence.
#[derive(Debug)]
pub struct Job {
    spec: Spec,
    inputs: Inputs,
    settings: RenderSettings,
    exposure: f32,
    accepted_builds: Vec<String>,
    /// The irradiance cache until it is baked; none if nothing is looked up.
    opened_cache: Option<OpenedCache>,
    /// What the cache is made from.
    cache_identity: Option<CacheIdentity>,
    baked: Option<Baked>,
    /// The halves of its irradiance cache, if maps of its error are asked for.
    cache_halves: Option<[IrradianceCache; 2]>,
}

impl Job {
    /// Loads and resolves a job. `folder` is that of its frames, if there is one: it keeps the irradiance cache if the
    /// spec names none.
    pub fn new(spec: Spec, folder: Option<&Path>, options: &JobOptions) -> Result<Job, JobError> {
        let is_preview = spec.preview;
        let settings = |given: Settings| if is_preview { given.preview() } else { given };
        Job::resolve(spec, folder, options, settings)
    }

    /// The job of baking the irradiance cache that the spec names, whether or not its settings use one.
    pub fn for_bake(spec: Spec, options: &JobOptions) -> Result<Job, JobError> {
        let settings = |given: Settings| Settings {
            mode: given.mode.or(Some(Mode::Montecarlo)),
            gi: Some(GlobalIllumination::Cached),
            ..given
        };
        Job::resolve(spec, None, options, settings)
    }

    fn resolve(
        spec: Spec,
        folder: Option<&Path>,
        options: &JobOptions,
        adjust: impl FnOnce(Settings) -> Settings,
    ) -> Result<Job, JobError> {
        spec.settings.check().map_err(JobError::Setting)?;
        let inputs = Inputs::load(&spec.scene, &spec.path, options.threads)?;
        let given = adjust(inputs.settings(spec.settings.clone()));
        given.check_together()?;
        let settings = given.resolve(inputs.frame_count());
        let frames = inputs.frame_count();
        let need = BYTES_PER_FRAME * u64::from(frames);
        check_room(
            &format!("a path of {frames} frames"),
            need,
            "choose a lower fps, or split the path",
        )?;
        let opened_cache = open_cache(&spec, folder, &inputs, &settings, options)?;
        Ok(Job {
            cache_identity: opened_cache.as_ref().map(OpenedCache::identity),
            exposure: given.exposure.unwrap_or(0.0),
            accepted_builds: options.accepted_builds.clone(),
            baked: None,
            cache_halves: None,
            spec,
            inputs,
            settings,
            opened_cache,
        })
    }

    /// The job of a folder's frames, with its inputs as they are now. `scene` and `path` say where these are, if they
    /// are no longer where they were.
    pub fn of_folder(
        folder: &FrameFolder,
        scene: Option<PathBuf>,
        path: Option<PathBuf>,
        options: &JobOptions,
    ) -> Result<Job, JobError> {
        let mut spec = Spec::of_folder(folder)?;
        spec.scene = scene.unwrap_or(spec.scene);
        spec.path = path.unwrap_or(spec.path);
        let mut options = options.clone();
        let accepted = &folder.sequence().accepted_builds;
        options.accepted_builds.extend(accepted.iter().cloned());
        Job::new(spec, Some(folder.path()), &options)
    }

    /// Its spec.
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// Scene, camera path and threads.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Whether a folder is, by its `sequence.ron`, for frames of the same scene and path files, whatever has changed in
    /// these or in the settings since.
    pub fn is_of_folder(&self, folder: &Path) -> bool {
        let recorded = FrameFolder::open(folder).ok();
        let recorded = recorded.and_then(|there| Spec::of_folder(&there).ok());
        recorded.is_some_and(|there| there.has_the_files_of(&self.spec))
    }

    /// The files of the scene and the path that have changed since the job was loaded: what frames were made from is no longer
    /// what is there.
    pub fn changed_inputs(&self) -> Vec<PathBuf> {
        let changed = self.inputs.changed_files().into_iter();
        changed.map(Path::to_owned).collect()
    }

    /// Its threads, for other work than its own.
    pub fn into_pool(self) -> ThreadPool {
        self.inputs.pool
    }

    /// The settings of its frames.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// Frames of the path.
    pub fn frame_count(&self) -> u32 {
        self.inputs.frame_count()
    }

    /// Sets the camera samples of each pixel, in the settings and in the spec.
    pub fn set_samples(&mut self, samples: u32) {
        self.settings.sampling = PixelSampling::Spread(samples);
        self.spec.settings.samples = Some(Samples::Spread(samples));
    }

    /// Sets the sampling of each pixel, and drops the choice from the spec.
    pub(super) fn set_sampling(&mut self, sampling: PixelSampling) {
        self.settings.sampling = sampling;
        self.spec.settings.samples = None;
    }

    /// Whether frames need an irradiance cache that is not baked yet, not even in a file.
    pub fn has_to_bake(&self) -> bool {
        let opened = self.opened_cache.as_ref();
        opened.is_some_and(|opened| !opened.is_complete(&self.settings))
    }

    /// Bakes the irradiance cache if frames need one and it is not there yet. Returns what came of it, once.
    pub fn bake(
        &mut self,
        listener: Listener,
        keep: KeepCache,
        waiting: WaitListener,
    ) -> Result<Option<BakeOutcome<'_>>, JobError> {
        let Some(opened) = self.opened_cache.take() else {
            return Ok(None);
        };
        let was_complete = opened.is_complete(&self.settings);
        let (baked, not_kept) =
            opened.bake(&self.inputs, &self.settings, listener, keep, waiting)?;
        if self.spec.cache_error_maps {
            self.cache_halves = Some(baked.cache.halves());
        }
        Ok(Some(BakeOutcome {
            baked: self.baked.insert(baked),
            was_complete,
            not_kept,
        }))
    }

    /// The record of the expected frames, for the folder that stores them.
    pub fn sequence(&self, folder: &Path) -> Result<SequenceRecord, JobError> {
        let timeline = self.inputs.path.path.timeline();
        let all = SequenceInputs {
            inputs: &self.inputs,
            settings: &self.settings,
            exposure: self.exposure,
            format: self.spec.format,
            cache: self.cache_identity.as_ref(),
        };
        Ok(SequenceRecord {
            build: BUILD.to_owned(),
            accepted_builds: self.accepted_builds.clone(),
            job: self.spec.for_folder(folder)?,
            fps: timeline.fps,
            frames: timeline.frame_count(),
            width: self.settings.width,
            height: self.settings.height,
            format: self.spec.format,
            exposure: self.exposure,
            error_maps: self.spec.error_maps,
            cache_error_maps: self.spec.cache_error_maps,
            irradiance_cache: self.cache_identity.is_some(),
            input_hashes: all.hashes(),
        })
    }

    /// What renders its frames; the irradiance cache is baked.
    fn renderer(&self) -> Renderer<'_> {
        let cache = self.baked.as_ref().map(|baked| &baked.cache);
        let errors = self.baked.as_ref().map_or(&[][..], |baked| &baked.errors);
        let renderer = Renderer::new(&self.inputs.scene.scene, self.settings.clone(), cache)
            .expect("frames that look light up have a baked cache")
            .with_cache_errors(errors);
        match &self.cache_halves {
            Some(halves) => renderer.with_cache_halves(halves),
            None => renderer,
        }
    }

    /// Checks that the memory suffices for its frames.
    pub fn check_room(&self) -> Result<(), JobError> {
        let RenderSettings { width, height, .. } = self.settings;
        let need =
            FRAMES_IN_FLIGHT as u64 * frame_memory(&self.inputs.scene.scene, &self.settings)[1];
        let what = format!("frames of {width}x{height}");
        Ok(check_room(&what, need, "choose a smaller --size")?)
    }

    /// Renders frames for a sink. The irradiance cache is baked, unless there are no frames to render.
    pub fn render<Sink: FrameSink>(
        &self,
        frames: &[u32],
        sink: &Sink,
        observer: &dyn RenderObserver,
    ) -> Outcome {
        if frames.is_empty() {
            return Outcome::default();
        }
        let path = &self.inputs.path.path;
        self.renderer()
            .render_sequence(path, frames, &self.inputs.pool, sink, observer)
    }

    /// What an estimate renders frames of. The irradiance cache is baked.
    pub(super) fn workload<'a>(&'a self, sequence: &'a SequenceRecord) -> Workload<'a> {
        Workload {
            renderer: self.renderer(),
            path: &self.inputs.path.path,
            pool: &self.inputs.pool,
            sequence,
        }
    }
}

/// An irradiance cache, ready for frames.
#[derive(Debug)]
pub struct BakeOutcome<'a> {
    /// The cache and its errors.
    pub baked: &'a Baked,
    /// Whether it was read, with nothing left to bake.
    pub was_complete: bool,
    /// Why it could not be kept in its file; none if it was, or has none.
    pub not_kept: Option<CacheFileError>,
}

/// Opens a folder whose frames are of this build, or of one that is accepted.
pub fn open_folder(folder: &Path, accepted_builds: &[String]) -> Result<FrameFolder, JobError> {
    let there = FrameFolder::open(folder)?;
    let sequence = SequenceRecord {
        accepted_builds: [&there.sequence().accepted_builds, accepted_builds].concat(),
        ..there.sequence().clone()
    };
    match sequence.accepts(BUILD) || accepted_builds.contains(&sequence.build) {
        true => Ok(FrameFolder::new(folder, sequence, false)),
        false => Err(JobError::OtherBuild {
            folder: folder.to_owned(),
            theirs: sequence.build,
            ours: BUILD,
        }),
    }
}

/// Opens the irradiance cache that frames need; none if they look nothing up.
fn open_cache(
    spec: &Spec,
    folder: Option<&Path>,
    inputs: &Inputs,
    settings: &RenderSettings,
    options: &JobOptions,
) -> Result<Option<OpenedCache>, JobError> {
    if !matches!(settings.integrator, IntegratorSettings::Cached { .. }) {
        return match (&spec.irradiance_cache, spec.cache_error_maps) {
            (Some(_), _) => Err(JobError::UnusedCache),
            (None, true) => Err(JobError::NoCacheError),
            (None, false) => Ok(None),
        };
    }
    if let Some(file) = &spec.irradiance_cache
        && (is_same(file, &spec.scene)
            || is_same(file, &spec.path)
            || folder.is_some_and(|folder| is_name_of_frames(folder, file)))
    {
        return Err(JobError::CacheName { file: file.clone() });
    }
    let location = match (&spec.irradiance_cache, folder) {
        (Some(file), _) => CacheLocation::Shared(file.clone()),
        (None, Some(folder)) => CacheLocation::Own(folder.join("irradiance.cache")),
        (None, None) => CacheLocation::Memory,
    };
    OpenedCache::open(location, inputs, settings, options).map(Some)
}
