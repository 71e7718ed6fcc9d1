//! `bake`: the irradiance cache of a camera path, for jobs that share it; and what other commands say when they bake.

use super::frames::ranges;
use super::job_args::{InputArguments, SettingsArguments, ThreadsArgument};
use super::outcome::{Failure, Status, error_summary, say, say_waiting, warn};
use super::progress::{FractionProgress, clock};
use crate::bake::Baked;
use crate::job::{BakeOutcome, Job, JobOptions, KeepCache, Spec};
use crate::render::RenderSettings;
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

/// Bake the irradiance cache of a camera path into a file, for render --gi-cache
///
/// An existing cache is reused: if it holds other paths through the same scene, with the same settings, what this path
/// needs is added.
///
/// Of the settings, size, bounces, seed and target error decide the cache; renderings that share it set the same.
///
/// Exit status: 0 success; 2 wrong input or usage; 3 the file cannot be written for now, as on a full disk.
#[derive(Debug, Args)]
pub(super) struct BakeArguments {
    #[command(flatten)]
    input: InputArguments,
    /// File for the irradiance cache
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    threads: ThreadsArgument,
    /// Bake anew if the file is damaged or a cache of something else
    #[arg(long)]
    force: bool,
    /// Write over the file whatever it is, unless it is this cache
    #[arg(long)]
    replace: bool,
    /// No progress bar and no summary
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &BakeArguments) -> Result<Status, Failure> {
    let spec = Spec {
        irradiance_cache: Some(arguments.out.clone()),
        settings: arguments.settings.settings(),
        ..Spec::new(&arguments.input.scene, &arguments.input.path)
    };
    let options = JobOptions {
        threads: arguments.threads.threads,
        rebake: arguments.force,
        replace: arguments.replace,
        ..JobOptions::default()
    };
    let mut job = Job::for_bake(spec, &options)?;
    warn(&job.inputs().scene.warnings);
    bake(&mut job, KeepCache::Always, arguments.quiet)?;
    Ok(Status::Done)
}

/// Bakes the irradiance cache of a job if its frames need one, and says what it took.
pub(super) fn bake(job: &mut Job, keep: KeepCache, quiet: bool) -> Result<(), Failure> {
    let start = Instant::now();
    let progress = FractionProgress::new(quiet);
    let settings = job.settings().clone();
    let outcome = job.bake(&|done, what| progress.at(done, what), keep, &say_waiting);
    progress.finish();
    let Some(BakeOutcome {
        baked,
        was_complete,
        not_kept,
    }) = outcome?
    else {
        return Ok(());
    };
    if !quiet {
        let what = match was_complete {
            true => "read",
            false => "baked",
        };
        say(format_args!(
            "irradiance cache {what} in {}",
            clock(start.elapsed())
        ));
        for line in summary(baked).lines() {
            say(format_args!("{line}"));
        }
    }
    warn(&shortfall(baked, &settings).into_iter().collect::<Vec<_>>());
    if let Some(error) = not_kept {
        warn(&[format!(
            "the irradiance cache is used, but not kept: {error}"
        )]);
    }
    Ok(())
}

/// How large the cache is, and its error.
fn summary(baked: &Baked) -> String {
    let [primary, secondary] = baked.cache.record_count();
    let megabytes = baked.cache.memory() as f64 / 1e6;
    let mut summary =
        format!("  {primary} primary, {secondary} secondary records, {megabytes:.1} MB in memory");
    let errors = (0..).zip(baked.errors.iter().copied());
    if let Some(errors) = error_summary(errors, "around") {
        summary += &format!("\n  cache error (relMSE) {errors}");
    }
    summary
}

/// What to say of a cache whose error leaves too little room for the target error.
fn shortfall(baked: &Baked, settings: &RenderSettings) -> Option<String> {
    let target = settings.target_error.filter(|_| !baked.missed.is_empty())?;
    let errors = baked
        .missed
        .iter()
        .map(|&frame| baked.errors[frame as usize]);
    let worst = errors.map(|error| error.interval()[1]).fold(0.0, f64::max);
    Some(format!(
        "frames {}: the cache error, up to {worst:.2e}, leaves too little room for the target error of {target}{}",
        ranges(&baked.missed),
        if settings.is_adaptive() {
            "; they are path traced, which takes longer"
        } else {
            ""
        }
    ))
}
