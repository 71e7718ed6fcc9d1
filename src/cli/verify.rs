use super::args::VerifyArguments;
use super::loading::pool;
use super::progress::ShareProgress;
use super::recorded::job_of;
use super::{Failure, Status, warn};
use crate::frames::{FrameFolder, FrameRecord, VerifyError};
use rayon::prelude::*;
use std::io::Write;
use std::path::absolute;
use std::sync::atomic::{AtomicUsize, Ordering};

pub(super) fn run(arguments: &VerifyArguments) -> Result<Status, Failure> {
    let out = absolute(&arguments.folder)?;
    let written_down = FrameFolder::open(&out)?;
    let job = job_of(&written_down, arguments.threads);
    let (folder, pool) = match job.and_then(|job| Ok((job.sequence()?, job.loaded.pool))) {
        Ok((plan, pool)) => (FrameFolder::new(&out, plan, false), pool),
        Err(error) => {
            warn(&[format!(
                "what the frames were made from cannot be loaded, so changes since are not seen: {error}"
            )]);
            (written_down, pool(&arguments.threads)?)
        }
    };
    let count = folder.sequence().frames;
    let frames: Vec<u32> = (0..count).collect();
    let mut lines = Vec::new();
    for (frame, proof) in pool.install(|| verify(&folder, &frames, arguments.quiet)) {
        if let Err(fault) = proof {
            lines.push(format!("{}: {fault}", folder.file_of(frame).display()));
        }
    }
    let proven = count as usize - lines.len();
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
        lines.push(format!("{proven} of {count} frames are proven: {folder}"));
    }
    let mut out = std::io::stdout().lock();
    for line in lines {
        // Nobody has to read it: the exit status says what matters.
        let _ = writeln!(out, "{line}");
    }
    Ok(status)
}

/// Proves frames on all threads of the current pool; gives them in their order.
pub(super) fn verify(
    folder: &FrameFolder,
    frames: &[u32],
    quiet: bool,
) -> Vec<(u32, Result<FrameRecord, VerifyError>)> {
    let progress = ShareProgress::new(quiet);
    let done = AtomicUsize::new(0);
    let prove = |&frame: &u32| {
        let proof = folder.verify(frame);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.at(done as f64 / frames.len() as f64, "proving frames");
        (frame, proof)
    };
    let proofs = frames.par_iter().map(prove).collect();
    progress.finish();
    proofs
}
