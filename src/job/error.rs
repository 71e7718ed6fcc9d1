//! Why a job cannot be done.

use crate::bake::CacheFileError;
use crate::frames::FolderError;
use crate::input::{InputError, SettingsError};
use crate::memory::MemoryError;
use crate::storage::FileError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a job cannot be done.
#[derive(Debug, Error)]
pub enum JobError {
    /// A file of the scene or the camera path is wrong.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A setting of the job is out of range.
    #[error("{}", .0.of_flag())]
    Setting(SettingsError),
    /// Settings of the job, the path and the scene contradict each other.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// An irradiance cache cannot be read or written.
    #[error(transparent)]
    Cache(#[from] CacheFileError),
    /// The folder of the frames cannot be used.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The job spec in `sequence.ron` cannot be read.
    #[error(
        "{folder}/sequence.ron: job: {message}: render the sequence again; verified frames are kept",
        folder = .folder.display()
    )]
    UnreadableJob {
        /// The folder.
        folder: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// A shared cache is named, but frames look nothing up.
    #[error("--gi-cache: add --gi cached")]
    UnusedCache,
    /// A map of the cache error is asked for, but frames look nothing up.
    #[error(
        "--aov cache-error: these frames use no irradiance cache; add --gi cached, or leave it out"
    )]
    NoCacheError,
    /// A budget and a target error both decide on samples.
    #[error(
        "--budget: cannot be combined with target_error, which the scene or the camera path sets"
    )]
    BudgetWithTargetError,
    /// A budget is too small.
    #[error("--budget: one sample of each pixel takes longer than {seconds} s")]
    BudgetTooSmall {
        /// The budget.
        seconds: f64,
    },
    /// The frames of a folder are of another build.
    #[error(
        "{folder}: its frames are of build {theirs}, and this is build {ours}: use that build, render them again, or \
         accept them by --accept-build {theirs}",
        folder = .folder.display()
    )]
    OtherBuild {
        /// The folder.
        folder: PathBuf,
        /// The build of its frames.
        theirs: String,
        /// This build.
        ours: &'static str,
    },
    /// A file beside the frames cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The irradiance cache has the name of another file of the job.
    #[error("--gi-cache: {file}: is a file of the scene, the path or the frames; use another name", file = .file.display())]
    CacheName {
        /// The file.
        file: PathBuf,
    },
    /// Something needs more memory than there is.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// Threads cannot be started.
    #[error("threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The system refuses something else.
    #[error(transparent)]
    System(#[from] io::Error),
}
