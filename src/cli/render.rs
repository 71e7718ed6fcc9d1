//! `render`: the frames of a camera path.

use super::bake::bake;
use super::check::NEAR;
use super::error_chart::error_chart;
use super::frames::FrameRanges;
use super::interrupt::Interrupt;
use super::job_args::JobArguments;
use super::outcome::{Failure, Status, error_summary, keep, say, say_waiting, warn};
use super::progress::{FractionProgress, SequenceProgress, clock, rays_per_second};
use super::quote::accuracy_lines;
use super::values::{OrderArgument, PrepareArgument, ProgressArgument, parse_time};
use super::verify::{changed_since, stray_line, verify};
use crate::camera::FrameCameras;
use crate::camera_formats::camera_table;
use crate::frames::{FrameFolder, Manifest, VerifyError, write_contact_sheet};
use crate::job::{Job, KeepCache, SavedEstimate, Spec, choose_samples_for_budget};
use crate::render::{FrameErrorEstimate, Outcome};
use crate::sampling::van_der_corput_order;
use crate::scene::LightGroup;
use crate::storage::Folder;
use clap::Args;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Render the frames of a camera path
///
/// Settings may also stand in the scene or the path file; the path's win over the scene's, and a flag wins over both.
///
/// Existing frames are verified: each carries a hash of its pixels and of all its inputs. Frames that are whole,
/// unchanged and made from the same inputs are kept, all others are rendered again. So the same command continues an
/// interrupted run, and several processes, on one machine or many, may share a folder. Finished frames of another scene
/// or path are not replaced unless --replace allows it.
///
/// Exit status: 0 success, all frames of the request are proven to be there, as they were rendered; 2 wrong input or
/// usage (trying again cannot help); 3 some frames failed, or files beside them look like frames (it may); 75
/// interrupted by SIGTERM, SIGINT (Ctrl-C), SIGHUP or SIGUSR1 (the same command continues).
#[derive(Debug, Args)]
pub(super) struct RenderArguments {
    #[command(flatten)]
    pub(super) job: JobArguments,
    /// Folder for the frames: frame_00000.png onward
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Frames to render, as in 0-99:2,120 [default: all]
    #[arg(short, long, value_name = "RANGES")]
    frames: Option<FrameRanges>,
    /// Choose the camera samples of each pixel so that all frames of the path take this time, as in 2h or 90min, on
    /// this machine; the choice is kept in the folder
    #[arg(long, value_name = "TIME", value_parser = parse_time, conflicts_with_all = ["samples", "target_error", "aov"])]
    budget: Option<Duration>,
    /// Preview the camera move: frames of 320 columns, ray traced, one sample in the middle of each pixel, whatever the
    /// files set. They go to DIR/preview, with a contact sheet, sheet.png; frames in DIR stay as they are
    #[arg(long, conflicts_with_all = [
        "mode", "size", "samples", "splits", "target_error", "gi", "gi_cache", "budget", "aov", "prepare",
    ])]
    preview: bool,
    /// Order of the frames
    #[arg(long, value_enum, default_value = "sequential")]
    order: OrderArgument,
    /// Render nothing, only prepare the folder for other processes
    #[arg(long, value_enum, value_name = "WHAT")]
    prepare: Option<PrepareArgument>,
    /// Render frames even if they are there already
    #[arg(long)]
    force: bool,
    /// Allow to render in place of finished frames of another scene or path, and of files that flythrough did not write
    #[arg(long)]
    replace: bool,
    /// Remove frames that are none of the sequence, as those of another format or beyond its last frame
    #[arg(long)]
    clean: bool,
    /// How progress is shown
    #[arg(long, value_enum, default_value = "auto")]
    progress: ProgressArgument,
    /// No progress, no summary and no warnings about the inputs
    #[arg(short, long)]
    quiet: bool,
}

impl RenderArguments {
    /// Warns of what may be wrong with the inputs of some frames, as `check` does.
    fn warn_of(&self, job: &Job, frames: &[u32]) {
        if !self.quiet {
            warn(&job.warnings(NEAR, frames));
        }
    }

    /// The folder of the frames.
    fn folder(&self) -> PathBuf {
        match self.preview {
            true => self.out.join("preview"),
            false => self.out.clone(),
        }
    }
}

/// Says where the light of the frames came from.
fn say_lights(job: &Job) {
    let input = &job.inputs().scene;
    let groups = input.scene.light_groups(&input.names);
    if !groups.is_empty() {
        let groups: Vec<String> = groups.iter().map(LightGroup::to_string).collect();
        say(format_args!("light: {}", groups.join("; ")));
    }
}

pub(super) fn run(arguments: &RenderArguments, interrupt: Interrupt) -> Result<Status, Failure> {
    let out = arguments.folder();
    // Previews are made again and again.
    let mut may_replace = arguments.replace;
    if arguments.preview
        && let Ok(there) = FrameFolder::open(&out)
    {
        may_replace = Spec::of_folder(&there).is_ok_and(|spec| spec.preview);
        if !may_replace {
            let out = out.display();
            return Err(
                format!("{out}: holds other frames than a preview; use another --out").into(),
            );
        }
    }
    let spec = arguments.job.spec(arguments.preview);
    let options = arguments.job.options(arguments.force);
    let mut job = Job::new(spec, Some(&out), &options)?;
    job.check_room()?;
    let count = job.frame_count();
    let frames = match &arguments.frames {
        None => (0..count).collect(),
        Some(ranges) => ranges.of_path(count)?,
    };
    may_replace |= job.is_of_folder(&out);
    if let Some(budget) = arguments.budget {
        choose_samples(&mut job, budget, &out, may_replace, arguments.quiet)?;
    }
    let folder = FrameFolder::new(&out, job.sequence(&out)?, arguments.force);
    if !may_replace {
        folder.check_unoccupied()?;
    }
    if arguments.prepare == Some(PrepareArgument::Sequence) {
        arguments.warn_of(&job, &frames);
        folder.prepare()?;
        return Ok(Status::Done);
    }
    let mut missing = match arguments.force {
        true => frames.clone(),
        false => (job.inputs().pool).install(|| missing(&folder, &frames, arguments.quiet)),
    };
    if !missing.is_empty() || !folder.has_its_sequence() {
        folder.prepare()?;
    }
    if arguments.clean {
        clean(&folder, arguments.quiet)?;
    }
    let strays_before = strays(&folder)?;
    warn(&strays_before);
    if !missing.is_empty() {
        arguments.warn_of(&job, &missing);
        if arguments.preview {
            // If this fails, so will drawing it again.
            let _ = folder.remove_sheet();
        }
        let keep = match arguments.prepare {
            Some(_) => KeepCache::Always,
            None => KeepCache::IfPossible,
        };
        if !arguments.quiet && job.has_to_bake() && missing.len() < count as usize {
            let path_traced = "--gi path-traced renders frames without it";
            say(format_args!(
                "baking the irradiance cache of all {count} frames, which share it, for {}: {path_traced}",
                frames_in_words(missing.len())
            ));
        }
        bake(&mut job, keep, arguments.quiet)?;
    }
    if arguments.prepare == Some(PrepareArgument::Cache) {
        return Ok(Status::Done);
    }
    if let OrderArgument::CoarseToFine = arguments.order {
        let asked: BTreeSet<u32> = missing.into_iter().collect();
        missing = van_der_corput_order(count)
            .filter(|frame| asked.contains(frame))
            .collect();
    }

    let shown = arguments.progress.shown(arguments.quiet);
    let start = Instant::now();
    let progress = SequenceProgress::new(missing.len(), job.settings(), shown, interrupt.clone());
    let outcome = job.render(&missing, &folder, &progress);
    interrupt.rendering_is_over();
    progress.finish();
    let elapsed = start.elapsed();

    let is_anothers = folder.has_another_sequence();
    let is_listed = is_anothers || list(&folder, &job, !missing.is_empty());
    if !arguments.quiet {
        let there = frames.len() - missing.len();
        summarise(&outcome, elapsed, there as u32, &folder);
        let threads = job.inputs().pool.current_num_threads();
        let accuracy = SavedEstimate::accuracy(&folder, &missing, &outcome, threads, elapsed);
        for line in accuracy.iter().flat_map(accuracy_lines) {
            say(format_args!("{line}"));
        }
        say_lights(&job);
    }
    warn(&shortcomings(&outcome, job.settings().target_error));
    if is_anothers {
        warn(&[format!(
            "{}: another process renders another sequence here; use two folders",
            folder.path().display()
        )]);
    }
    if outcome.stopped {
        return Ok(Status::Interrupted);
    }
    interrupt.nothing_is_left();
    let is_shown = match arguments.preview {
        true => (job.inputs().pool).install(|| show(&folder, &frames, arguments.quiet)),
        false => true,
    };
    let is_proven =
        outcome.failures.is_empty() && is_proven(&folder, &frames, &job, arguments.quiet);
    let mut strays = strays(&folder)?;
    // A part of the sequence is not concerned by what is beside it.
    let is_clean = frames.len() < count as usize || strays.is_empty();
    strays.retain(|stray| !strays_before.contains(stray));
    warn(&strays);
    Ok(
        match is_proven && is_listed && is_shown && !is_anothers && is_clean {
            true => Status::Done,
            false => Status::SomeFailed,
        },
    )
}

/// Gives the job the samples that a budget allows, and says how many.
fn choose_samples(
    job: &mut Job,
    budget: Duration,
    out: &Path,
    may_replace: bool,
    quiet: bool,
) -> Result<(), Failure> {
    let out = Folder::create(out)?;
    let progress = FractionProgress::new(quiet);
    let listener = |done: f64, what: &'static str| progress.at(done, what);
    let choice = choose_samples_for_budget(job, budget, &out, may_replace, &listener, &say_waiting);
    progress.finish();
    if let (Some(choice), false) = (choice?, quiet) {
        let budget = clock(budget);
        say(format_args!(
            "{} samples of each pixel fit into {budget}",
            choice.samples
        ));
    }
    Ok(())
}

/// Removes frames that are none of the sequence, and says which.
fn clean(folder: &FrameFolder, quiet: bool) -> Result<(), Failure> {
    for name in folder.clean()? {
        if !quiet {
            let file = folder.path().join(name);
            say(format_args!("removed {}", file.display()));
        }
    }
    Ok(())
}

/// What is wrong with files beside the frames that look like frames.
fn strays(folder: &FrameFolder) -> Result<Vec<String>, Failure> {
    let strays = folder.strays()?;
    let line = |stray| stray_line(folder, stray);
    Ok(strays.iter().map(line).collect())
}

/// Whether the frames are there as they were verified or stored. Says which are not.
fn is_proven(folder: &FrameFolder, frames: &[u32], job: &Job, quiet: bool) -> bool {
    let changed = (job.inputs().pool).install(|| changed_since(folder, frames, quiet));
    for (frame, error) in &changed {
        let file = folder.file_of(*frame);
        warn(&[format!(
            "{}: changed since it was rendered or verified: {error}; render the sequence again",
            file.display()
        )]);
    }
    let changed_inputs = job.changed_inputs();
    for file in &changed_inputs {
        let file = file.display();
        warn(&[format!(
            "{file}: has changed since it was loaded; render the sequence again"
        )]);
    }
    let is_recorded = folder.is_recorded();
    if !is_recorded {
        let file = folder.sequence_file();
        warn(&[format!(
            "{}: lost or changed; render the sequence again",
            file.display()
        )]);
    }
    changed.is_empty() && changed_inputs.is_empty() && is_recorded
}

fn frames_in_words(count: usize) -> String {
    match count {
        1 => "1 frame".to_owned(),
        count => format!("{count} frames"),
    }
}

/// The frames that are not verified. Says what is wrong with those that are there.
fn missing(folder: &FrameFolder, frames: &[u32], quiet: bool) -> Vec<u32> {
    let mut missing = Vec::new();
    let mut stale = 0;
    let mut of_other_builds = 0;
    for (frame, verified) in verify(folder, frames, quiet) {
        let Err(error) = verified else { continue };
        missing.push(frame);
        match error {
            VerifyError::Missing => {}
            VerifyError::Stale => stale += 1,
            VerifyError::OtherBuild(_) => of_other_builds += 1,
            error => warn(&[format!("{}: {error}", folder.file_of(frame).display())]),
        }
    }
    let folder = folder.path().display();
    if stale > 0 {
        warn(&[format!(
            "{folder}: {stale} frames are rendered again: {}",
            VerifyError::Stale
        )]);
    }
    if of_other_builds > 0 {
        warn(&[format!(
            "{folder}: {of_other_builds} frames of other builds are rendered again (--accept-build keeps them)"
        )]);
    }
    missing
}

/// Writes the manifest and the table of cameras, as far as they are not there; `changed` if frames were rendered.
fn list(folder: &FrameFolder, job: &Job, changed: bool) -> bool {
    let list = || {
        if changed || !Manifest::is_current(folder) {
            folder.sync();
            Manifest::update(folder, error_chart, &say_waiting)?;
        }
        let table = camera_table(&FrameCameras::of(&job.inputs().path.path))?;
        Ok::<(), Failure>(folder.write_camera_table(&table)?)
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
    let drawn = keep(&sheet, folder.has_its_sheet())
        .and_then(|()| Ok(write_contact_sheet(folder, frames, &sheet)?));
    match &drawn {
        Err(error) => warn(&[error.to_string()]),
        Ok(()) if quiet => {}
        Ok(()) => say(format_args!("contact sheet: {}", sheet.display())),
    }
    drawn.is_ok()
}

fn summarise(outcome: &Outcome, elapsed: Duration, there: u32, folder: &FrameFolder) {
    say(format_args!(
        "{} frames rendered in {} ({}), {} were there, {} failed{}: {}",
        outcome.stored,
        clock(elapsed),
        rays_per_second(outcome.rays, elapsed),
        there + outcome.stored_by_others,
        outcome.failures.len(),
        if outcome.stopped { ", interrupted" } else { "" },
        folder.path().display()
    ));
    if outcome.errors.iter().any(|(_, error)| !error.is_known()) {
        return say(format_args!("error unknown: nothing lights the surfaces"));
    }
    let errors = || outcome.errors.iter().copied();
    if let Some(whole) = error_summary(errors().map(|(frame, error)| (frame, error.whole)), "in") {
        let largest =
            |of: fn(FrameErrorEstimate) -> f64| errors().map(|(_, e)| of(e)).fold(0.0, f64::max);
        say(format_args!("error (relMSE) {whole}"));
        say(format_args!(
            "  worst 8x8 block of a frame {:.2e}, blurred over 8x8 pixels at most {:.2e}",
            largest(|error| error.worst_block),
            largest(|error| error.blurred)
        ));
    }
}

/// What frames lack that were rendered.
fn shortcomings(outcome: &Outcome, target_error: Option<f64>) -> Vec<String> {
    let mut warnings = Vec::new();
    let black = outcome.non_finite_samples;
    if black > 0 {
        warnings.push(format!(
            "{black} samples were not finite numbers and are black"
        ));
    }
    if let Some(target) = target_error {
        let reaches = |error: &FrameErrorEstimate| error.whole.interval()[1] <= target;
        let count = outcome.errors.iter().filter(|(_, e)| !reaches(e)).count();
        if count > 0 {
            warnings.push(format!("{count} frames stayed above the error of {target}"));
        }
    }
    warnings
}
