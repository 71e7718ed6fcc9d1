//! What many commands take.

use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// What every command that loads something loads.
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
    #[arg(short, long, value_name = "N", env = "SLURM_CPUS_PER_TASK")]
    pub(super) threads: Option<NonZeroUsize>,
}
