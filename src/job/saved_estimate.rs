//! The estimate of a sequence, saved beside its frames, and how far off it was.

use super::error::JobError;
use super::resolved_job::Job;
use crate::bake::Listener;
use crate::forecast::{Estimate, Forecast, samples_within};
use crate::frames::{FrameFolder, SequenceRecord};
use crate::render::Outcome;
use crate::storage::{PartFile, write_atomic};
use serde::{Deserialize, Serialize};
use std::fs;
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
    /// allows, and saves the estimate in `out`, a folder that exists.
    pub fn new(
        job: &mut Job,
        budget: Option<Duration>,
        out: Option<&Path>,
        listener: Listener,
    ) -> Result<SavedEstimate, JobError> {
        if budget.is_some() && job.settings().target_error.is_some() {
            return Err(JobError::BudgetWithTargetError);
        }
        job.bake(listener)?;
        let memory = resident_memory().map_or(0.0, |[now, _]| now);
        let folder = out.unwrap_or(Path::new("."));
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

    fn write(&self, out: &Path) -> Result<(), JobError> {
        let file = out.join(SavedEstimate::FILE);
        let pretty = ron::ser::PrettyConfig::new().struct_names(true);
        let text = ron::ser::to_string_pretty(self, pretty).map_err(std::io::Error::other);
        let written = text.and_then(|text| write_atomic(&file, text.as_bytes()));
        written.map_err(|source| JobError::Unwritable { file, source })
    }

    fn read(out: &Path) -> Option<SavedEstimate> {
        let text = fs::read_to_string(out.join(SavedEstimate::FILE)).ok()?;
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
        } = SavedEstimate::read(folder.path())?;
        let is_whole = outcome.stored as usize == rendered.len() && !rendered.is_empty();
        if inputs != hash(folder.sequence()) || estimate.threads != threads || !is_whole {
            return None;
        }
        Some(Accuracy {
            seconds: (estimate.seconds(rendered), elapsed.as_secs_f64()),
            bytes: (estimate.bytes(rendered), outcome.bytes as f64),
            memory: resident_memory().map(|[_, most]| (estimate.memory, most)),
        })
    }
}

/// Sets the samples that were chosen for this budget before, and saved in the folder. Returns whether there are any.
fn reuse_saved_choice(job: &mut Job, budget: Duration, out: &Path) -> Result<bool, JobError> {
    let unchosen = job.settings().sampling;
    job.set_samples(1);
    let inputs_of_one_sample = hash(&job.sequence(out)?);
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
/// choice, if it was made now.
pub fn choose_samples_for_budget(
    job: &mut Job,
    budget: Duration,
    out: &Path,
    listener: Listener,
) -> Result<Option<SampleChoice>, JobError> {
    make_folder(out)?;
    if reuse_saved_choice(job, budget, out)? {
        return Ok(None);
    }
    // A process that starts at the same time waits for the choice of the first.
    let _lock = PartFile::lock_with_timeout(&out.join(SavedEstimate::FILE), Duration::MAX)?;
    if reuse_saved_choice(job, budget, out)? {
        return Ok(None);
    }
    SavedEstimate::new(job, Some(budget), Some(out), listener).map(|saved| saved.choice)
}

/// Makes a folder if it is not there.
pub fn make_folder(folder: &Path) -> Result<(), JobError> {
    fs::create_dir_all(folder).map_err(|source| JobError::Unwritable {
        file: folder.to_owned(),
        source,
    })
}

/// A hash of the inputs of all frames.
fn hash(sequence: &SequenceRecord) -> String {
    blake3::hash(sequence.input_hashes.concat().as_bytes()).to_string()
}

/// Bytes of memory that the process has now, and the most that it had; none where the system does not say.
fn resident_memory() -> Option<[f64; 2]> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        let number: f64 = line.split_whitespace().next()?.parse().ok()?;
        Some(1024.0 * number)
    };
    Some([kilobytes("VmRSS:")?, kilobytes("VmHWM:")?])
}
