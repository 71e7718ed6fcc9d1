//! `verify`: whether every frame of a sequence is there, whole, unchanged and made from what it should be.

use super::job_args::RecordedJobArguments;
use super::outcome::{Failure, Status, say};
use super::progress::FractionProgress;
use crate::frames::{FrameFolder, FrameRecord, Stray, VerifyError};
use crate::job::{JobError, open_folder, pool};
use crate::memory::room;
use clap::Args;
use rayon::prelude::*;
use std::path::{PathBuf, absolute};
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;

/// Verify that every frame of a sequence is there, whole, unchanged and made from its inputs as they are now
///
/// Prints a line for each frame that is not, and why; and what sequence.ron says of frame rate, number, size and format
/// of the frames that is not so.
///
/// Exit status: 0 all frames are verified; 2 not a folder of frames, or its inputs cannot be loaded; 3 some frames are
/// not: render again.
#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    /// Folder of the frames
    folder: PathBuf,
    #[command(flatten)]
    inputs: RecordedJobArguments,
    /// Verify frames against what was recorded when they were rendered, whatever has become of scene and path since:
    /// for a folder that was copied without them
    #[arg(long, conflicts_with_all = ["scene", "path"])]
    as_recorded: bool,
    /// No progress bar and no summary
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &VerifyArguments) -> Result<Status, Failure> {
    let out = absolute(&arguments.folder)?;
    let recorded = FrameFolder::open(&out)?;
    let options = arguments.inputs.options();
    let (folder, pool, mut lines) = if arguments.as_recorded {
        let folder = open_folder(&out, &options.accepted_builds)?;
        (folder, pool(options.threads)?, Vec::new())
    } else {
        let job = arguments.inputs.job_of(&recorded);
        let job = job.map_err(|error| CannotBeLoaded {
            folder: out.clone(),
            error,
        })?;
        let sequence = job.sequence(&out)?;
        let contradictions = sequence.contradictions(recorded.sequence()).into_iter();
        let file = recorded.sequence_file();
        let lines = contradictions
            .map(|what| format!("{}: {what}; render the sequence again", file.display()));
        (
            FrameFolder::new(&out, sequence, false),
            job.into_pool(),
            lines.collect(),
        )
    };
    let count = folder.sequence().frames;
    let frames: Vec<u32> = (0..count).collect();
    let mut verified_count = 0;
    for (frame, verified) in pool.install(|| verify(&folder, &frames, arguments.quiet)) {
        match verified {
            Ok(_) => verified_count += 1,
            Err(error) => lines.push(format!("{}: {error}", folder.file_of(frame).display())),
        }
    }
    lines.extend(
        folder
            .strays()?
            .iter()
            .map(|stray| stray_line(&folder, stray)),
    );
    let status = match lines.is_empty() {
        true => Status::Done,
        false => Status::SomeFailed,
    };
    if !arguments.quiet {
        let folder = folder.path().display();
        lines.push(format!(
            "{verified_count} of {count} frames are verified: {folder}"
        ));
    }
    for line in lines {
        say(format_args!("{line}"));
    }
    Ok(status)
}

/// What is wrong with a file that is no frame of the sequence.
pub(super) fn stray_line(folder: &FrameFolder, stray: &Stray) -> String {
    let file = folder.path().join(&stray.name);
    let what_to_do = match stray.is_own {
        true => "render --clean removes it",
        false => "move it away",
    };
    format!("{}: no frame of the sequence: {what_to_do}", file.display())
}

/// Why frames are not verified: what they were made from cannot be loaded.
#[derive(Debug, Error)]
#[error(
    "{folder}: what its frames were made from cannot be loaded: {error}: --scene and --path say where it is now, and \
     --as-recorded verifies the frames against what was recorded",
    folder = .folder.display()
)]
struct CannotBeLoaded {
    folder: PathBuf,
    #[source]
    error: JobError,
}

/// Verifies frames on all threads of the current pool; gives them in their order.
pub(super) fn verify(
    folder: &FrameFolder,
    frames: &[u32],
    quiet: bool,
) -> Vec<(u32, Result<FrameRecord, VerifyError>)> {
    of_each(folder, frames, "verifying frames", quiet, |frame| {
        folder.verify(frame)
    })
}

/// Proves frames that were verified or stored before: see [`FrameFolder::prove`]. Gives those that have changed since.
pub(super) fn changed_since(
    folder: &FrameFolder,
    frames: &[u32],
    quiet: bool,
) -> Vec<(u32, VerifyError)> {
    let proven = of_each(folder, frames, "proving frames", quiet, |frame| {
        folder.prove(frame)
    });
    let changed = proven.into_iter();
    changed
        .filter_map(|(frame, proven)| Some((frame, proven.err()?)))
        .collect()
}

/// Reads frames on all threads of the current pool, or on as many at a time as the memory suffices for.
fn of_each<T: Send>(
    folder: &FrameFolder,
    frames: &[u32],
    what: &str,
    quiet: bool,
    of: impl Fn(u32) -> T + Sync,
) -> Vec<(u32, T)> {
    let progress = FractionProgress::new(quiet);
    let done = AtomicUsize::new(0);
    let one = |&frame: &u32| {
        let found = of(frame);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.at(done as f64 / frames.len() as f64, what);
        (frame, found)
    };
    let left = room().map_or(u64::MAX, |room| room.left());
    let at_a_time = (left / folder.memory_to_verify()).clamp(1, frames.len().max(1) as u64);
    let groups = frames.chunks(at_a_time as usize);
    let all = groups.flat_map(|group| group.par_iter().map(one).collect::<Vec<_>>());
    let all = all.collect();
    progress.finish();
    all
}
