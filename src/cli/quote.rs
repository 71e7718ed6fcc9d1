use super::args::QuoteArguments;
use super::job::Job;
use super::progress::clock;
use super::{Failure, Status, written};
use crate::forecast::{Forecast, Quote, samples_within};
use crate::frames::{FrameFolder, SequenceRecord};
use crate::render::Outcome;
use crate::storage::{PartFile, write_atomic};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

pub(super) fn run(arguments: &QuoteArguments) -> Result<Status, Failure> {
    let out = arguments.out.as_deref();
    let mut job = Job::new(&arguments.job, false, out, false)?;
    if let Some(out) = out {
        make(out)?;
    }
    let kept = Kept::new(&mut job, arguments.budget, out, arguments.quiet)?;
    let frames: Vec<u32> = (0..job.frame_count()).collect();
    let quote = &kept.quote;
    let seconds = quote.seconds(&frames);
    let bytes = quote.bytes(&frames);
    let mut out = io::stdout().lock();
    if let (Some(choice), Some(_)) = (&kept.choice, arguments.budget) {
        writeln!(
            out,
            "samples  {} of each pixel (--samples {0})",
            choice.samples
        )?;
    }
    writeln!(
        out,
        "time     {} on {} threads, {} frames of {:.2} s",
        in_time(seconds),
        quote.threads,
        frames.len(),
        seconds.expected / frames.len() as f64
    )?;
    writeln!(out, "disk     {}", in_bytes(bytes))?;
    writeln!(out, "memory   {}", in_bytes(quote.memory))?;
    Ok(Status::Done)
}

/// What was quoted for the frames of a folder, as it is kept there.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Quote")]
pub(super) struct Kept {
    /// A hash of what all frames were to be made from.
    of: String,
    choice: Option<Choice>,
    quote: Quote,
}

/// Samples that were chosen for a budget.
#[derive(Debug, Serialize, Deserialize)]
struct Choice {
    samples: u32,
    /// In seconds.
    budget: f64,
    /// As `of` in [`Kept`], but that each pixel has one sample.
    of_one_sample: String,
}

impl Kept {
    const FILE: &str = "quote.ron";

    /// Renders a few frames of a job, gives it the samples that a budget allows, and keeps what is expected beside
    /// the frames, in a folder that is there.
    pub(super) fn new(
        job: &mut Job,
        budget: Option<Duration>,
        out: Option<&Path>,
        quiet: bool,
    ) -> Result<Kept, Failure> {
        if budget.is_some() && job.settings.target_error.is_some() {
            return Err(
                "--budget: the target error of the scene or the path decides on samples".into(),
            );
        }
        job.bake(quiet)?;
        let memory = resident().map_or(0.0, |[now, _]| now);
        let sequence = job.sequence()?;
        let (quote, choice) = match budget {
            // What was chosen before stays: frames are made of it.
            None => {
                let choice = out.and_then(Kept::read).and_then(|kept| kept.choice);
                let quote = Quote::new(job.stage(&sequence), &job.renderer()?, memory);
                (quote, choice)
            }
            Some(budget) => {
                let seconds = budget.as_secs_f64();
                let within =
                    samples_within(job.stage(&sequence), &job.renderer()?, seconds, memory);
                let (samples, quote) = within.ok_or_else(|| {
                    let budget = clock(budget);
                    format!("--budget: one sample of each pixel takes longer than {budget}")
                })?;
                job.take_samples(1);
                let of_one_sample = hash(&job.sequence()?);
                job.take_samples(samples);
                let choice = Choice {
                    samples,
                    budget: seconds,
                    of_one_sample,
                };
                (quote, Some(choice))
            }
        };
        let kept = Kept {
            of: hash(&job.sequence()?),
            choice,
            quote,
        };
        if let Some(out) = out {
            let pretty = ron::ser::PrettyConfig::new().struct_names(true);
            let text = ron::ser::to_string_pretty(&kept, pretty)?;
            let file = out.join(Kept::FILE);
            written(&file, write_atomic(&file, text.as_bytes()))?;
        }
        Ok(kept)
    }

    fn read(out: &Path) -> Option<Kept> {
        let text = fs::read_to_string(out.join(Kept::FILE)).ok()?;
        ron::from_str(&text).ok()
    }
}

/// Gives a job the samples that were chosen for a budget when its folder was first rendered to. False if none were.
pub(super) fn choose_again(job: &mut Job, budget: Duration, out: &Path) -> Result<bool, Failure> {
    job.take_samples(1);
    let of_one_sample = hash(&job.sequence()?);
    let choice = Kept::read(out).and_then(|kept| kept.choice);
    let is_it = |choice: &Choice| {
        choice.budget == budget.as_secs_f64() && choice.of_one_sample == of_one_sample
    };
    let Some(choice) = choice.filter(is_it) else {
        return Ok(false);
    };
    job.take_samples(choice.samples);
    Ok(true)
}

/// Gives a job the samples that a budget allows: those that were chosen before, or else as many as it allows now.
pub(super) fn keep_within(
    job: &mut Job,
    budget: Duration,
    out: &Path,
    quiet: bool,
) -> Result<(), Failure> {
    make(out)?;
    if choose_again(job, budget, out)? {
        return Ok(());
    }
    // Whoever else begins at the same time waits for the choice of the first.
    let _turn = PartFile::claim_in_turn(&out.join(Kept::FILE), Duration::MAX)?;
    if choose_again(job, budget, out)? {
        return Ok(());
    }
    let kept = Kept::new(job, Some(budget), Some(out), quiet)?;
    if let (Some(choice), false) = (kept.choice, quiet) {
        let budget = clock(budget);
        // Nobody has to read it.
        let _ = writeln!(
            io::stdout(),
            "{} samples of each pixel fit into {budget}",
            choice.samples
        );
    }
    Ok(())
}

/// Holds what was quoted for a folder's frames against what they took; none if nothing was, or if they were not
/// all rendered here.
pub(super) fn score(
    folder: &FrameFolder,
    rendered: &[u32],
    outcome: &Outcome,
    threads: usize,
    elapsed: Duration,
) -> Option<String> {
    let Kept { of, quote, .. } = Kept::read(folder.path())?;
    let is_whole = outcome.kept as usize == rendered.len() && !rendered.is_empty();
    if of != hash(folder.sequence()) || quote.threads != threads || !is_whole {
        return None;
    }
    let seconds = quote.seconds(rendered);
    let bytes = quote.bytes(rendered);
    let off = |quoted: Forecast, actual: f64| {
        let percent = 100.0 * (actual / quoted.expected - 1.0);
        let within = (quoted.low..=quoted.high).contains(&actual);
        format!("{percent:+.1} %{}", if within { "" } else { ", OUTSIDE" })
    };
    let mut lines = format!(
        "quoted {}: {}\nquoted {}: {}",
        in_time(seconds),
        off(seconds, elapsed.as_secs_f64()),
        in_bytes(bytes),
        off(bytes, outcome.bytes as f64)
    );
    if let Some([_, most]) = resident() {
        let memory = in_bytes(quote.memory);
        lines += &format!("\nquoted {memory} of memory: {}", off(quote.memory, most));
    }
    Some(lines)
}

/// Makes a folder if it is not there.
fn make(out: &Path) -> Result<(), Failure> {
    fs::create_dir_all(out).map_err(|error| format!("{}: {error}", out.display()).into())
}

/// A hash of what all frames are to be made from.
fn hash(sequence: &SequenceRecord) -> String {
    blake3::hash(sequence.input_hash.concat().as_bytes()).to_string()
}

/// Bytes of memory that the process has now, and the most that it had; none where the system does not say.
fn resident() -> Option<[f64; 2]> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        let number: f64 = line.split_whitespace().next()?.parse().ok()?;
        Some(1024.0 * number)
    };
    Some([kilobytes("VmRSS:")?, kilobytes("VmHWM:")?])
}

fn in_time(seconds: Forecast) -> String {
    let [expected, low, high] = [seconds.expected, seconds.low, seconds.high]
        .map(|seconds| clock(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)));
    format!("{expected} ({low} to {high})")
}

fn in_bytes(bytes: Forecast) -> String {
    let [expected, low, high] =
        [bytes.expected, bytes.low, bytes.high].map(|bytes| format!("{:.1}", bytes / 1e6));
    format!("{expected} MB ({low} to {high})")
}
