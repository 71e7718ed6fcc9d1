use super::args::RenderArguments;
use super::frames::coarse_to_fine;
use super::interrupt::Interrupt;
use super::job::Job;
use super::progress::{clock, rays_per_second};
use super::quote::{keep_within, score};
use super::recorded::is_preview;
use super::sheet::draw;
use super::values::{OrderArgument, PrepareArgument};
use super::verify::verify;
use super::{Failure, Status, warn};
use crate::camera::FrameCameras;
use crate::frames::{FrameFolder, Manifest, VerifyError};
use crate::render::{ErrorEstimate, Outcome};
use std::io::Write;
use std::time::{Duration, Instant};

pub(super) fn run(arguments: &RenderArguments, interrupt: Interrupt) -> Result<Status, Failure> {
    let out = arguments.folder();
    if arguments.preview
        && let Ok(there) = FrameFolder::open(&out)
        && !is_preview(&there)
    {
        let out = out.display();
        return Err(format!("{out}: holds other frames than a preview; use another --out").into());
    }
    let mut job = Job::new(
        &arguments.job,
        arguments.preview,
        Some(&out),
        arguments.force,
    )?;
    let count = job.frame_count();
    let frames = match &arguments.frames {
        None => (0..count).collect(),
        Some(ranges) => ranges.of_path(count)?,
    };
    if let Some(budget) = arguments.budget {
        keep_within(&mut job, budget, &out, arguments.quiet)?;
    }
    let folder = FrameFolder::new(&out, job.sequence()?, arguments.force);
    if arguments.prepare == Some(PrepareArgument::Sequence) {
        folder.prepare()?;
        return Ok(Status::Done);
    }
    let mut missing = match arguments.force {
        true => frames.clone(),
        false => job
            .loaded
            .pool
            .install(|| missing(&folder, &frames, arguments.quiet)),
    };
    if !missing.is_empty() || !folder.has_its_sequence() {
        folder.prepare()?;
    }
    if !missing.is_empty() {
        if arguments.preview {
            // It shows other frames, if this is interrupted.
            let _ = std::fs::remove_file(folder.sheet());
        }
        job.bake(arguments.quiet)?;
    }
    if arguments.prepare == Some(PrepareArgument::Cache) {
        return Ok(Status::Done);
    }
    if let OrderArgument::CoarseToFine = arguments.order {
        coarse_to_fine(&mut missing, count);
    }

    let shown = arguments.progress.shown(arguments.quiet);
    let start = Instant::now();
    let outcome = job.render(&missing, &folder, shown, interrupt)?;
    let elapsed = start.elapsed();

    let cameras = FrameCameras::of(&job.loaded.path.path);
    let is_anothers = folder.has_another_sequence();
    let is_listed = is_anothers || list(&folder, &cameras, !missing.is_empty());
    if !arguments.quiet {
        let there = frames.len() - missing.len();
        summarise(&outcome, elapsed, there as u32, &folder);
        let threads = job.loaded.pool.current_num_threads();
        if let Some(score) = score(&folder, &missing, &outcome, threads, elapsed) {
            // As the summary.
            let _ = writeln!(std::io::stdout(), "{score}");
        }
    }
    let is_shown = match arguments.preview && !outcome.stopped {
        true => job
            .loaded
            .pool
            .install(|| show(&folder, &frames, arguments.quiet)),
        false => true,
    };
    warn(&shortcomings(&outcome, job.settings.target_error));
    if is_anothers {
        warn(&[format!(
            "{}: somebody else has begun to render another sequence here; use two folders",
            folder.path().display()
        )]);
    }
    Ok(if outcome.stopped {
        Status::Interrupted
    } else if outcome.failures.is_empty() && is_listed && is_shown && !is_anothers {
        Status::Done
    } else {
        Status::SomeFailed
    })
}

/// The frames that are not proven. Says of those that are there what is wrong with them.
fn missing(folder: &FrameFolder, frames: &[u32], quiet: bool) -> Vec<u32> {
    let mut missing = Vec::new();
    let mut stale = 0;
    for (frame, proof) in verify(folder, frames, quiet) {
        let Err(fault) = proof else { continue };
        missing.push(frame);
        match fault {
            VerifyError::Missing => {}
            VerifyError::Stale => stale += 1,
            fault => warn(&[format!("{}: {fault}", folder.file_of(frame).display())]),
        }
    }
    if stale > 0 {
        let folder = folder.path().display();
        let why = VerifyError::Stale;
        warn(&[format!(
            "{folder}: {stale} frames are rendered again, as they are {why}"
        )]);
    }
    missing
}

/// Writes down what the frames of the folder say of themselves, and their cameras, as far as it is not there; `changed`
/// if frames were rendered.
fn list(folder: &FrameFolder, cameras: &FrameCameras, changed: bool) -> bool {
    let list = || {
        if changed || !Manifest::is_right(folder) {
            folder.sync();
            Manifest::update(folder)?;
        }
        folder.keep_cameras(cameras)
    };
    let listed = list();
    if let Err(error) = &listed {
        let folder = folder.path().display();
        warn(&[format!("{folder}: its frames cannot be listed: {error}")]);
    }
    listed.is_ok()
}

/// Makes a contact sheet of frames, and says where it is.
fn show(folder: &FrameFolder, frames: &[u32], quiet: bool) -> bool {
    let sheet = folder.sheet();
    let drawn = draw(folder, frames, &sheet);
    match &drawn {
        Err(error) => warn(&[error.to_string()]),
        Ok(()) if quiet => {}
        Ok(()) => {
            // As the summary.
            let _ = writeln!(std::io::stdout(), "contact sheet: {}", sheet.display());
        }
    }
    drawn.is_ok()
}

fn summarise(outcome: &Outcome, elapsed: Duration, there: u32, folder: &FrameFolder) {
    // Nobody has to read it: the exit status says what matters.
    let mut out = std::io::stdout();
    let _ = writeln!(
        out,
        "{} frames rendered in {} ({}), {} were there, {} failed{}: {}",
        outcome.kept,
        clock(elapsed),
        rays_per_second(outcome.rays, elapsed),
        there + outcome.kept_by_others,
        outcome.failures.len(),
        if outcome.stopped { ", interrupted" } else { "" },
        folder.path().display()
    );
    if let Some(errors) = summary(&outcome.errors) {
        let _ = writeln!(out, "{errors}");
    }
}

/// What to say of frames that are there but not all that they could be.
fn shortcomings(outcome: &Outcome, target_error: Option<f64>) -> Vec<String> {
    let mut warnings = Vec::new();
    let black = outcome.non_finite_samples;
    if black > 0 {
        warnings.push(format!(
            "{black} samples were not finite numbers and are black"
        ));
    }
    if let Some(target) = target_error {
        let reaches = |error: &ErrorEstimate| error.interval()[1] <= target;
        let count = outcome.errors.iter().filter(|(_, e)| !reaches(e)).count();
        if count > 0 {
            warnings.push(format!("{count} frames stayed above the error of {target}"));
        }
    }
    warnings
}

/// The errors of the frames that were rendered; none where nothing was left to chance.
fn summary(errors: &[(u32, ErrorEstimate)]) -> Option<String> {
    let error = |(_, error): &(u32, ErrorEstimate)| error.relative_square_error;
    let worst = errors.iter().max_by(|a, b| error(a).total_cmp(&error(b)))?;
    let mean = errors.iter().map(error).sum::<f64>() / errors.len() as f64;
    let [low, high] = worst.1.interval();
    Some(format!(
        "error (relMSE) {mean:.2e} on average, at worst {:.2e} ({low:.2e} to {high:.2e}) in frame {}",
        error(worst),
        worst.0,
    ))
}
