//! The estimate of a sequence, saved beside its frames, and how far off it was.

use super::cache::KeepCache;
use super::error::JobError;
use super::resolved_job::Job;
use crate::bake::Listener;
use crate::forecast::{Estimate, Forecast, samples_within};
use crate::frames::{FrameFolder, SequenceRecord};
use crate::memory::resident;
use crate::render::Outcome;
use crate::storage::{FileError, Folder, WaitListener};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Duration;

/// An estimate as it is saved in the folder of the frames.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Estimate")]
pub struct SavedEstimate {
    /// A hash of the inputs of all frames.
    inputs: String,
    /// Samples that were chosen for a budget; none where there was none.
    pub choice: Option<SampleChoice>,
    /// The estimate.
    pub estimate: Estimate,
}

/// The most bytes that are read of the file.
const MAX_TEXT: u64 = 1 << 24;

/// Samples of each pixel, chosen for a budget.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Samples")]
pub struct SampleChoice {
    /// Camera samples of each pixel.
    pub samples: u32,
    /// In seconds.
    pub budget: f64,
    /// As [`SavedEstimate::inputs`], of frames with one sample in each pixel.
    inputs_of_one_sample: String,
}

/// An estimate beside what the frames took.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// Seconds.
    pub seconds: (Forecast, f64),
    /// Bytes of all files.
    pub bytes: (Forecast, f64),
    /// Bytes of memory; none where the system does not say.
    pub memory: Option<(Forecast, f64)>,
}

impl SavedEstimate {
    const FILE: &str = "estimate.ron";

    /// Bakes the irradiance cache if frames need one, renders a few frames, gives the job the samples that a budget
    /// allows, and saves the estimate in `out`, a folder.
    pub fn new(
        job: &mut Job,
        budget: Option<Duration>,
        out: Option<&Folder>,
        listener: Listener,
        waiting: WaitListener,
    ) -> Result<SavedEstimate, JobError> {
        if budget.is_some() && job.settings().target_error.is_some() {
            return Err(JobError::BudgetWithTargetError);
        }
        job.bake(listener, KeepCache::IfPossible, waiting)?;
        let memory = resident().map_or(0.0, |[now, _]| now as f64);
        let folder = out.map_or(Path::new("."), Folder::path);
        let sequence = job.sequence(folder)?;
        let (estimate, choice) = match budget {
            // What was chosen before stays: frames are made of it.
            None => {
                let saved = out.and_then(SavedEstimate::read);
                let estimate = Estimate::new(&job.workload(&sequence), memory);
                (estimate, saved.and_then(|saved| saved.choice))
            }
            Some(budget) => {
                let seconds = budget.as_secs_f64();
                let within = samples_within(job.workload(&sequence), seconds, memory);
                let (samples, estimate) = within.ok_or(JobError::BudgetTooSmall { seconds })?;
                job.set_samples(1);
                let inputs_of_one_sample = hash(&job.sequence(folder)?);
                job.set_samples(samples);
                let choice = SampleChoice {
                    samples,
                    budget: seconds,
                    inputs_of_one_sample,
                };
                (estimate, Some(choice))
            }
        };
        let saved = SavedEstimate {
            inputs: hash(&job.sequence(folder)?),
            choice,
            estimate,
        };
        if let Some(out) = out {
            saved.write(out)?;
        }
        Ok(saved)
    }

    fn write(&self, out: &Folder) -> Result<(), FileError> {
        let pretty = ron::ser::PrettyConfig::new().struct_names(true);
        let text = ron::ser::to_string_pretty(self, pretty).map_err(std::io::Error::other);
        let text =
            text.map_err(|error| FileError::writing(&out.file(SavedEstimate::FILE), error))?;
        out.write_atomic(SavedEstimate::FILE, text.as_bytes())
    }

    fn read(out: &Folder) -> Option<SavedEstimate> {
        let text = out.read_text(SavedEstimate::FILE, MAX_TEXT).ok()?;
        ron::from_str(&text).ok()
    }

    /// Holds the estimate of a folder's frames against what they took; none if there is none, or not all of them were
    /// rendered here.
    pub fn accuracy(
        folder: &FrameFolder,
        rendered: &[u32],
        outcome: &Outcome,
        threads: usize,
        elapsed: Duration,
    ) -> Option<Accuracy> {
        let SavedEstimate {
            inputs, estimate, ..
        } = SavedEstimate::read(&Folder::open(folder.path()).ok()?)?;
        let is_whole = outcome.stored as usize == rendered.len() && !rendered.is_empty();
        if inputs != hash(folder.sequence()) || estimate.threads != threads || !is_whole {
            return None;
        }
        Some(Accuracy {
            seconds: (estimate.seconds(rendered), elapsed.as_secs_f64()),
            bytes: (estimate.bytes(rendered), outcome.bytes as f64),
            memory: resident().map(|[_, most]| (estimate.memory, most as f64)),
        })
    }
}

/// Sets the samples that were chosen for this budget before, and saved in the folder. Returns whether there are any.
fn reuse_saved_choice(job: &mut Job, budget: Duration, out: &Folder) -> Result<bool, JobError> {
    let unchosen = job.settings().sampling;
    job.set_samples(1);
    let inputs_of_one_sample = hash(&job.sequence(out.path())?);
    let choice = SavedEstimate::read(out).and_then(|saved| saved.choice);
    let choice = choice.filter(|choice| {
        choice.budget == budget.as_secs_f64() && choice.inputs_of_one_sample == inputs_of_one_sample
    });
    match &choice {
        Some(choice) => job.set_samples(choice.samples),
        None => job.set_sampling(unchosen),
    }
    Ok(choice.is_some())
}

/// Sets the samples that a budget allows: those that were chosen before, or else as many as it allows now. Returns the
/// choice, if it was made now. A choice of before is replaced only if the folder is free for frames or `replace` allows
/// it. `waiting` hears of another process that chooses and is waited for.
pub fn choose_samples_for_budget(
    job: &mut Job,
    budget: Duration,
    out: &Folder,
    replace: bool,
    listener: Listener,
    waiting: WaitListener,
) -> Result<Option<SampleChoice>, JobError> {
    if reuse_saved_choice(job, budget, out)? {
        return Ok(None);
    }
    // A process that starts at the same time waits for the choice of the first.
    let _lock = out.lock_with_timeout(SavedEstimate::FILE, Duration::MAX, waiting)?;
    if reuse_saved_choice(job, budget, out)? {
        return Ok(None);
    }
    if !replace {
        FrameFolder::new(out.path(), job.sequence(out.path())?, false).check_unoccupied()?;
    }
    SavedEstimate::new(job, Some(budget), Some(out), listener, waiting).map(|saved| saved.choice)
}

/// A hash of the inputs of all frames.
fn hash(sequence: &SequenceRecord) -> String {
    blake3::hash(sequence.input_hashes.concat().as_bytes()).to_string()
}
