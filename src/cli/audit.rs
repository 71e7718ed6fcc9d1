use super::args::AuditArguments;
use super::interrupt::Interrupt;
use super::recorded::job_of;
use super::verify::verify;
use super::{Failure, Status};
use crate::frames::FrameFolder;
use crate::render::{Claim, EncodedFrame, FrameSink, RenderedFrame, SinkError};
use std::fs;
use std::io::Write;
use std::path::absolute;

pub(super) fn run(arguments: &AuditArguments, interrupt: Interrupt) -> Result<Status, Failure> {
    let out = absolute(&arguments.folder)?;
    let folder = FrameFolder::open(&out)?;
    let mut job = job_of(&folder, arguments.threads)?;
    if !FrameFolder::new(&out, job.sequence()?, false).has_its_sequence() {
        let out = out.display();
        return Err(format!(
            "{out}: scene, path or what they name have changed since; render the sequence again"
        )
        .into());
    }
    let all: Vec<u32> = (0..job.frame_count()).collect();
    let pool = &job.loaded.pool;
    let proofs = pool.install(|| verify(&folder, &all, arguments.quiet));
    let proven = proofs
        .into_iter()
        .filter_map(|(frame, proof)| proof.is_ok().then_some(frame));
    let sample = chosen(proven.collect(), arguments);
    if sample.is_empty() {
        return Err(format!("{}: no frame is proven", out.display()).into());
    }
    job.bake(arguments.quiet)?;

    let shown = arguments.progress.shown(arguments.quiet);
    let outcome = job.render(&sample, &Comparison(&folder), shown, interrupt)?;
    if !arguments.quiet {
        // Nobody has to read it: the exit status says what matters.
        let _ = writeln!(
            std::io::stdout(),
            "{} of {} frames rendered again are the same: {}",
            outcome.kept,
            sample.len(),
            out.display()
        );
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

/// Compares frames with those of a folder in place of keeping them.
struct Comparison<'a>(&'a FrameFolder);

impl FrameSink for Comparison<'_> {
    type Slot = ();

    fn claim(&self, _: u32, _: bool) -> Result<Claim<()>, SinkError> {
        Ok(Claim::Granted(()))
    }

    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        self.0.encode(frame, rendered)
    }

    fn keep(&self, frame: u32, (): (), encoded: &EncodedFrame) -> Result<(), SinkError> {
        let files = [
            (self.0.file_of(frame), Some(&encoded.picture)),
            (self.0.map_of(frame), encoded.error_map.as_ref()),
        ];
        for (file, bytes) in files {
            if let Some(bytes) = bytes
                && fs::read(&file)? != *bytes
            {
                let file = file.display();
                let what = "is not what this machine renders: check both by flythrough selftest";
                return Err(format!("{file} {what}").into());
            }
        }
        Ok(())
    }
}
