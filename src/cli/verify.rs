use super::args::VerifyArguments;
use super::progress::ShareProgress;
use super::recorded::job_of;
use super::{Failure, Status, warn};
use crate::output::{Fault, FrameFolder, FrameRecord};
use rayon::prelude::*;
use std::io::Write;
use std::path::absolute;
use std::sync::atomic::{AtomicUsize, Ordering};

pub(super) fn run(arguments: &VerifyArguments) -> Result<Status, Failure> {
    let out = absolute(&arguments.folder)?;
    let written_down = FrameFolder::open(&out)?;
    let folder = match job_of(&written_down, arguments.threads).and_then(|job| job.plan()) {
        Ok(plan) => FrameFolder::new(&out, plan, false),
        Err(error) => {
            warn(&[format!(
                "what the frames were made from cannot be loaded, so changes since are not seen: {error}"
            )]);
            written_down
        }
    };
    let count = folder.plan().frames;
    let frames: Vec<u32> = (0..count).collect();
    let mut bad = 0;
    let mut out = std::io::stdout().lock();
    for (frame, proof) in prove(&folder, &frames, arguments.quiet) {
        if let Err(fault) = proof {
            bad += 1;
            writeln!(out, "{}: {fault}", folder.file_of(frame).display())?;
        }
    }
    let strays = folder.strays()?;
    for name in &strays {
        let stray = folder.path().join(name);
        writeln!(
            out,
            "{}: no frame of the sequence; remove it",
            stray.display()
        )?;
    }
    if !arguments.quiet {
        let proven = count - bad;
        writeln!(
            out,
            "{proven} of {count} frames are proven: {}",
            folder.path().display()
        )?;
    }
    Ok(match bad == 0 && strays.is_empty() {
        true => Status::Done,
        false => Status::SomeFailed,
    })
}

/// Proves frames on all threads of the current pool; gives them in their order.
pub(super) fn prove(
    folder: &FrameFolder,
    frames: &[u32],
    quiet: bool,
) -> Vec<(u32, Result<FrameRecord, Fault>)> {
    let progress = ShareProgress::new(quiet);
    let done = AtomicUsize::new(0);
    let prove = |&frame: &u32| {
        let proof = folder.prove(frame);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.at(done as f64 / frames.len() as f64, "proving frames");
        (frame, proof)
    };
    let proofs = frames.par_iter().map(prove).collect();
    progress.finish();
    proofs
}
