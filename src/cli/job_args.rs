//! Arguments that several commands share: inputs, settings, jobs.

use super::values::{AovArgument, FormatArgument, parse_size, parse_threads};
use crate::frames::{FrameFolder, FrameFormat};
use crate::input::{ExtraLight, GlobalIllumination, Mode, Samples, Settings};
use crate::job::{Job, JobError, JobOptions, Spec};
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// A scene and a camera path.
#[derive(Debug, Args)]
pub(super) struct InputArguments {
    /// The scene file (RON)
    pub(super) scene: PathBuf,
    /// The camera path file (RON)
    pub(super) path: PathBuf,
}

#[derive(Clone, Copy, Debug, Args)]
pub(super) struct ThreadsArgument {
    /// Threads to use [default: all cores that the process may use]
    #[arg(short, long, value_name = "N", env = "SLURM_CPUS_PER_TASK", value_parser = parse_threads)]
    pub(super) threads: Option<NonZeroUsize>,
}

/// How a job is done.
#[derive(Debug, Args)]
struct JobOptionArguments {
    /// Take frames and caches of another build for this one's (--version shows the build); may be given several times
    #[arg(long = "accept-build", value_name = "ID")]
    accepted_builds: Vec<String>,
    #[command(flatten)]
    threads: ThreadsArgument,
}

impl JobOptionArguments {
    fn options(&self) -> JobOptions {
        JobOptions {
            threads: self.threads.threads,
            rebake: false,
            replace: false,
            accepted_builds: self.accepted_builds.clone(),
        }
    }
}

/// What decides the frames of a sequence, and how they are made.
#[derive(Debug, Args)]
pub(super) struct JobArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    #[command(flatten)]
    pub(super) settings: SettingsArguments,
    /// File of the irradiance cache of --gi cached, shared with other jobs; baked if it is not there
    /// [default: irradiance.cache in the folder of the frames]
    #[arg(long, value_name = "FILE")]
    gi_cache: Option<PathBuf>,
    /// File format of the frames
    #[arg(long, value_enum, default_value = "png")]
    format: FormatArgument,
    /// Also keep a map of errors beside each frame, in linear light; more than one by commas
    #[arg(long, value_enum, value_name = "LAYER", value_delimiter = ',')]
    aov: Vec<AovArgument>,
    #[command(flatten)]
    options: JobOptionArguments,
}

impl JobArguments {
    pub(super) fn spec(&self, preview: bool) -> Spec {
        Spec {
            settings: self.settings.settings(),
            format: FrameFormat::from(self.format),
            error_maps: self.aov.contains(&AovArgument::Error),
            cache_error_maps: self.aov.contains(&AovArgument::CacheError),
            irradiance_cache: self.gi_cache.clone(),
            preview,
            ..Spec::new(&self.input.scene, &self.input.path)
        }
    }

    /// With `rebake`, a shared cache that cannot be used is baked anew.
    pub(super) fn options(&self, rebake: bool) -> JobOptions {
        JobOptions {
            rebake,
            ..self.options.options()
        }
    }
}

/// Where the inputs are now from which the frames of a folder were made.
#[derive(Debug, Args)]
pub(super) struct RecordedJobArguments {
    /// The scene file [default: as recorded in the folder]
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// The camera path file [default: as recorded in the folder]
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    #[command(flatten)]
    options: JobOptionArguments,
}

impl RecordedJobArguments {
    /// The job of a folder's frames, with its inputs as they are now.
    pub(super) fn job_of(&self, folder: &FrameFolder) -> Result<Job, JobError> {
        let (scene, path) = (self.scene.clone(), self.path.clone());
        Job::of_folder(folder, scene, path, &self.options())
    }

    pub(super) fn options(&self) -> JobOptions {
        self.options.options()
    }
}

#[derive(Debug, Args)]
pub(super) struct SettingsArguments {
    /// raytracing, supersampling, montecarlo or montecarlo-supersampling [default: raytracing]
    #[arg(short, long)]
    mode: Option<Mode>,
    /// Columns and rows, as in 1280x720 [default: 1280x720]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Camera samples of each pixel: a number, stratified over its square, center for one in its middle, or corners for
    /// four in its corners that neighbours share [default: center in raytracing; else as many as it takes, where they
    /// are needed, for a relMSE of 0.0002, or 0.001 where light is
    /// path-traced; the error of an irradiance cache comes to it]
    #[arg(long, value_name = "N")]
    samples: Option<Samples>,
    /// Mirror reflections; in the montecarlo modes all bounces [default: 4]
    #[arg(long, value_name = "N")]
    bounces: Option<u32>,
    /// Paths that continue from the first, second, ... diffuse bounce in the montecarlo modes [default: 32,1,1,1]
    #[arg(long, value_name = "N,N,...", value_delimiter = ',')]
    splits: Option<Vec<u32>>,
    /// Shadow rays from each surface that a camera sample sees: for all surfaces that emit and lights with a radius
    /// together, for each sun that is not a point, and for the sky where shadow rays find it [default: 4]
    #[arg(long, value_name = "N")]
    shadow_rays: Option<u32>,
    /// A light beside those of the scene: camera, a headlight that shows scenes without any
    #[arg(long, value_name = "WHICH")]
    light: Option<ExtraLight>,
    /// Seed of the random numbers [default: 0]
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// The same random numbers in all frames: noise stands still where the camera does [default: new ones in each
    /// frame]
    #[arg(long)]
    lock_seed: bool,
    /// Exposure in stops: +1 doubles the light of PNG frames; EXR is not exposed [default: 0]
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    exposure: Option<f32>,
    /// Add samples where they are needed until the upper 95 % bound of the frame's whole relMSE, edges, textures, noise
    /// and irradiance cache, is below X. Noise is just visible at 0.01, and hardly at 0.001; edges are smooth at 0.0002
    /// [default: as --samples says]
    #[arg(long, value_name = "X")]
    target_error: Option<f64>,
    /// Indirect diffuse light in the montecarlo modes: path-traced for each camera sample, or cached: an irradiance
    /// cache baked once for the sequence, many times as fast, its error a few thousandths on average [default: cached
    /// for sequences, unless splits are set; path-traced for stills]
    #[arg(long, value_name = "HOW")]
    gi: Option<GlobalIllumination>,
}

impl SettingsArguments {
    pub(super) fn settings(&self) -> Settings {
        Settings {
            mode: self.mode,
            size: self.size,
            samples: self.samples,
            bounces: self.bounces,
            splits: self.splits.clone(),
            shadow_rays: self.shadow_rays,
            light: self.light,
            seed: self.seed,
            lock_seed: self.lock_seed.then_some(true),
            exposure: self.exposure,
            target_error: self.target_error,
            gi: self.gi,
        }
    }
}
