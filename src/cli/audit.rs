//! `audit`: renders some frames of a folder again and compares them byte for byte.

use super::bake::bake;
use super::interrupt::Interrupt;
use super::job_args::RecordedJobArguments;
use super::outcome::{Failure, Status, say, warn};
use super::progress::SequenceProgress;
use super::values::{ProgressArgument, SampleSize};
use super::verify::verify;
use crate::frames::{FrameFolder, SequenceRecord};
use crate::job::{KeepCache, open_folder};
use crate::render::{Claim, EncodedFrame, FrameSink, RenderedFrame, SinkError};
use clap::Args;
use std::path::{PathBuf, absolute};

/// Render some frames of a folder again, and compare them byte for byte
///
/// They are rendered by the job that is recorded in the folder, with its irradiance cache as it is. So a machine of a
/// farm that renders other pixels than this one is found.
///
/// Exit status: 0 all are the same; 2 not a folder of frames, or its inputs have changed; 3 some are not the same.
#[derive(Debug, Args)]
pub(super) struct AuditArguments {
    /// Folder of the frames
    folder: PathBuf,
    /// How many frames, as in 1% or 5; at least one
    #[arg(long, value_name = "N", default_value = "1%")]
    sample: SampleSize,
    /// Chooses other frames
    #[arg(long, value_name = "N", default_value = "0")]
    seed: u64,
    #[command(flatten)]
    inputs: RecordedJobArguments,
    /// How progress is shown
    #[arg(long, value_enum, default_value = "auto")]
    progress: ProgressArgument,
    /// No progress and no summary
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &AuditArguments, interrupt: Interrupt) -> Result<Status, Failure> {
    let out = absolute(&arguments.folder)?;
    let folder = open_folder(&out, &arguments.inputs.options().accepted_builds)?;
    let mut job = arguments.inputs.job_of(&folder)?;
    job.check_room()?;
    warn(&job.inputs().scene.warnings);
    let sequence = job.sequence(&out)?;
    let contradictions = sequence.contradictions(folder.sequence());
    if sequence.input_hashes != folder.sequence().input_hashes || !contradictions.is_empty() {
        let out = out.display();
        return Err(format!(
            "{out}: scene, path or what they name have changed since; render the sequence again"
        )
        .into());
    }
    let folder = FrameFolder::new(&out, sequence, false);
    let all: Vec<u32> = (0..job.frame_count()).collect();
    let pool = &job.inputs().pool;
    let verified = pool.install(|| verify(&folder, &all, arguments.quiet));
    let verified = verified
        .into_iter()
        .filter_map(|(frame, verified)| verified.is_ok().then_some(frame));
    let sample = chosen(verified.collect(), arguments);
    if sample.is_empty() {
        return Err(format!("{}: no frame is verified", out.display()).into());
    }
    bake(&mut job, KeepCache::IfPossible, arguments.quiet)?;

    let shown = arguments.progress.shown(arguments.quiet);
    let progress = SequenceProgress::new(sample.len(), job.settings(), shown, interrupt);
    let outcome = job.render(&sample, &Comparison(&folder), &progress);
    progress.finish();
    if !arguments.quiet {
        say(format_args!(
            "{} of {} frames rendered again are the same: {}",
            outcome.stored,
            sample.len(),
            out.display()
        ));
    }
    Ok(if outcome.stopped {
        Status::Interrupted
    } else if outcome.failures.is_empty() {
        Status::Done
    } else {
        Status::SomeFailed
    })
}

/// Some of the frames, by the hashes of their numbers and the seed, in their order.
fn chosen(mut frames: Vec<u32>, arguments: &AuditArguments) -> Vec<u32> {
    let count = arguments.sample.of(frames.len());
    let seed = arguments.seed;
    frames
        .sort_by_cached_key(|frame| *blake3::hash(format!("{seed} {frame}").as_bytes()).as_bytes());
    frames.truncate(count);
    frames.sort_unstable();
    frames
}

/// Compares frames with those of a folder in place of storing them.
struct Comparison<'a>(&'a FrameFolder);

impl FrameSink for Comparison<'_> {
    type Lock = ();

    fn claim(&self, _: u32, _: bool) -> Result<Claim<()>, SinkError> {
        Ok(Claim::Granted(()))
    }

    /// As the build did that the frame says it is of.
    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        let record = self.0.record(frame).ok_or("its record is gone")?;
        let sequence = SequenceRecord {
            build: record.build,
            ..self.0.sequence().clone()
        };
        sequence.encode(frame, rendered)
    }

    fn store(&self, frame: u32, (): (), encoded: &EncodedFrame) -> Result<(), SinkError> {
        let stored = self.0.files(frame)?;
        let image = (self.0.file_of(frame), stored.image == encoded.image);
        let maps = stored.maps.iter().zip(&encoded.maps);
        let maps = self.0.maps_of(frame).zip(maps.map(|(a, b)| a == b));
        let files = std::iter::once(image).chain(maps);
        for (file, is_same) in files {
            if !is_same {
                let file = file.display();
                let what = "is not what this machine renders: check both by flythrough selftest";
                return Err(format!("{file} {what}").into());
            }
        }
        Ok(())
    }
}
