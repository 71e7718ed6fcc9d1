//! `quote`: time, disk and memory of a sequence, estimated before it is rendered.

use super::job_args::JobArguments;
use super::outcome::{Failure, Status, say_waiting, warn};
use super::progress::{FractionProgress, clock};
use super::values::parse_time;
use crate::forecast::Forecast;
use crate::frames::FrameFolder;
use crate::job::{Accuracy, Job, KeepCache, SavedEstimate};
use crate::storage::Folder;
use clap::Args;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

/// Estimate time, disk and memory of a sequence before rendering it
///
/// Renders a few frames of the path, small ones where whole ones would take long, and prints the expected totals on
/// this machine with their 95 % confidence intervals. The irradiance cache of --gi cached is baked for it; with
/// --out or --gi-cache it is kept, and costs nothing more.
///
/// With --out the estimate is kept, too, and render prints how far off it was.
///
/// Exit status: 0 success; 2 wrong input or usage; 3 the system lacked something for now, as room on the disk.
#[derive(Debug, Args)]
pub(super) struct QuoteArguments {
    #[command(flatten)]
    job: JobArguments,
    /// Folder that the frames will be rendered to
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Choose the camera samples of each pixel so that all frames take this time, as in 2h or 90min
    #[arg(long, value_name = "TIME", value_parser = parse_time, conflicts_with_all = ["samples", "target_error"])]
    budget: Option<Duration>,
    /// Allow to write to a folder with finished frames of another scene or path, or with files that flythrough did not
    /// write
    #[arg(long)]
    replace: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &QuoteArguments) -> Result<Status, Failure> {
    let out = arguments.out.as_deref();
    let mut job = Job::new(
        arguments.job.spec(false),
        out,
        &arguments.job.options(false),
    )?;
    job.check_room()?;
    warn(&job.inputs().scene.warnings);
    if let Some(out) = out
        && !arguments.replace
        && !job.is_of_folder(out)
    {
        FrameFolder::new(out, job.sequence(out)?, false).check_unoccupied()?;
    }
    let folder = out.map(Folder::create).transpose()?;
    super::bake::bake(&mut job, KeepCache::IfPossible, arguments.quiet)?;
    let progress = FractionProgress::new(arguments.quiet);
    let listener = |done: f64, what: &'static str| progress.at(done, what);
    let saved = SavedEstimate::new(
        &mut job,
        arguments.budget,
        folder.as_ref(),
        &listener,
        &say_waiting,
    );
    progress.finish();
    let SavedEstimate {
        choice, estimate, ..
    } = saved?;
    let frames: Vec<u32> = (0..job.frame_count()).collect();
    let seconds = estimate.seconds(&frames);
    let mut out = io::stdout().lock();
    if let (Some(choice), Some(_)) = (&choice, arguments.budget) {
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
        estimate.threads,
        frames.len(),
        seconds.expected / frames.len() as f64
    )?;
    writeln!(out, "disk     {}", in_bytes(estimate.bytes(&frames)))?;
    writeln!(out, "memory   {}", in_bytes(estimate.memory))?;
    Ok(Status::Done)
}

/// What a sequence was estimated to take, and how far off that was.
pub(super) fn accuracy_lines(accuracy: &Accuracy) -> Vec<String> {
    let off = |(estimated, actual): (Forecast, f64)| {
        let percent = 100.0 * (actual / estimated.expected - 1.0);
        let within = (estimated.low..=estimated.high).contains(&actual);
        format!("{percent:+.1} %{}", if within { "" } else { ", OUTSIDE" })
    };
    let mut lines = vec![
        format!(
            "estimated {}: {}",
            in_time(accuracy.seconds.0),
            off(accuracy.seconds)
        ),
        format!(
            "estimated {}: {}",
            in_bytes(accuracy.bytes.0),
            off(accuracy.bytes)
        ),
    ];
    if let Some(memory) = accuracy.memory {
        lines.push(format!(
            "estimated {} of memory: {}",
            in_bytes(memory.0),
            off(memory)
        ));
    }
    lines
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
