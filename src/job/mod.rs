//! A job: from its spec to the rendered frames.
//!
//! A [`Spec`] is the job as data; `render`, `verify`, `audit`, `quote` and `missing` all start from one, whether it
//! comes from the command line or from the `sequence.ron` of a folder. A [`Job`] is the spec resolved: inputs loaded,
//! settings complete, and what frames are made from known. Knows nothing of terminals.

mod cache;
mod error;
mod identity;
mod inputs;
mod options;
mod resolved_job;
mod saved_estimate;
mod spec;
mod warnings;

pub use cache::{CacheLocation, KeepCache, OpenedCache};
pub use error::JobError;
pub use identity::{BUILD, CacheIdentity};
pub use inputs::{Inputs, pool};
pub use options::JobOptions;
pub use resolved_job::{BakeOutcome, Job, open_folder};
pub use saved_estimate::{Accuracy, SampleChoice, SavedEstimate, choose_samples_for_budget};
pub use spec::Spec;
