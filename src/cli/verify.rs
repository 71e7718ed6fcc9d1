//! `verify`: whether every frame of a sequence is there, whole, unchanged and made from what it should be.

use super::job_args::RecordedJobArguments;
use super::outcome::{Failure, Status, say, warn};
use super::progress::FractionProgress;
use crate::frames::{FrameFolder, FrameRecord, VerifyError};
use crate::job::{open_folder, pool};
use clap::Args;
use rayon::prelude::*;
use std::path::{PathBuf, absolute};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Verify that every frame of a sequence is there, whole, unchanged and made from its inputs as they are now
///
/// Prints a line for each frame that is not, and why. If the inputs cannot be loaded, a warning says so, and frames are
/// verified against the inputs as recorded when they were rendered.
///
/// Exit status: 0 all frames are verified, 2 not a folder of frames, 3 some frames are not: render again.
#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    /// Folder of the frames
    folder: PathBuf,
    #[command(flatten)]
    inputs: RecordedJobArguments,
    /// No progress bar and no summary
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &VerifyArguments) -> Result<Status, Failure> {
    let out = absolute(&arguments.folder)?;
    let recorded = FrameFolder::open(&out)?;
    let options = arguments.inputs.options();
    let job = arguments.inputs.job_of(&recorded);
    let current = job.and_then(|job| Ok((job.sequence(&out)?, job)));
    let folder = match &current {
        Ok((sequence, _)) => FrameFolder::new(&out, sequence.clone(), false),
        Err(error) => {
            warn(&[format!(
                "what the frames were made from cannot be loaded, so changes since are not seen: {error}"
            )]);
            open_folder(&out, &options.accepted_builds)?
        }
    };
    let own_pool;
    let pool = match &current {
        Ok((_, job)) => &job.inputs().pool,
        Err(_) => {
            own_pool = pool(options.threads)?;
            &own_pool
        }
    };
    let count = folder.sequence().frames;
    let frames: Vec<u32> = (0..count).collect();
    let mut lines = Vec::new();
    for (frame, verified) in pool.install(|| verify(&folder, &frames, arguments.quiet)) {
        if let Err(error) = verified {
            lines.push(format!("{}: {error}", folder.file_of(frame).display()));
        }
    }
    let verified = count as usize - lines.len();
    for name in folder.strays()? {
        let stray = folder.path().join(name);
        lines.push(format!(
            "{}: no frame of the sequence; remove it",
            stray.display()
        ));
    }
    let status = match lines.is_empty() {
        true => Status::Done,
        false => Status::SomeFailed,
    };
    if !arguments.quiet {
        let folder = folder.path().display();
        lines.push(format!(
            "{verified} of {count} frames are verified: {folder}"
        ));
    }
    for line in lines {
        say(format_args!("{line}"));
    }
    Ok(status)
}

/// Verifies frames on all threads of the current pool; gives them in their order.
pub(super) fn verify(
    folder: &FrameFolder,
    frames: &[u32],
    quiet: bool,
) -> Vec<(u32, Result<FrameRecord, VerifyError>)> {
    let progress = FractionProgress::new(quiet);
    let done = AtomicUsize::new(0);
    let verify = |&frame: &u32| {
        let verified = folder.verify(frame);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.at(done as f64 / frames.len() as f64, "verifying frames");
        (frame, verified)
    };
    let all = frames.par_iter().map(verify).collect();
    progress.finish();
    all
}
