//! How a job is done.

use std::num::NonZeroUsize;

/// How a job is done: what decides no pixel.
#[derive(Clone, Debug, Default)]
pub struct JobOptions {
    /// Threads; by default as many as the process may use.
    pub threads: Option<NonZeroUsize>,
    /// Whether a shared irradiance cache that cannot be used is baked anew.
    pub rebake: bool,
    /// Whether it is written over anything else under its name, too.
    pub replace: bool,
    /// Builds of the program whose frames and caches count as this one's.
    pub accepted_builds: Vec<String>,
}
