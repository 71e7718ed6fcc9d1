//! `report`: speed against error of every technique on a scene and a path.

use super::frames::FrameRanges;
use super::job_args::{InputArguments, ThreadsArgument};
use super::outcome::{Failure, Status, say, warn};
use super::progress::FractionProgress;
use super::values::parse_size;
use crate::input::Settings;
use crate::job::{self, BUILD};
use crate::report::{Inputs, check_free_for_report, report};
use clap::Args;
use std::path::PathBuf;

/// Measure the speed and the error of every technique on a scene and a path
///
/// Renders a few small frames of the path by each technique, with several seeds, and compares them with references,
/// which are made once and kept in the folder. Writes report.md, report.csv, report.json, the curves of error against
/// time, the flicker along the path, a picture of each technique's errors, and advice: the cheapest flags of render for
/// a relMSE of 0.01, where noise is just visible, of 0.001, where it hardly is, and of 0.0002, where edges are smooth.
/// All errors count: edges, textures, noise, the irradiance cache, and the bias of what leaves out indirect light.
///
/// The irradiance cache (--gi cached) is baked once, as for the whole sequence at its own size, and each frame is
/// charged its part: those seconds are right if all frames are rendered.
///
/// Exposure, bounces and the size that the advice is for are the scene's and the path's. The error is relMSE: the mean
/// of (x - r)^2 / (m^2 + 0.01), where x is a pixel, r is the reference's, and m the local mean of the reference; 1 is
/// display white. Run it on a machine that does nothing else.
///
/// Exit status: 0 success, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct ReportArguments {
    #[command(flatten)]
    input: InputArguments,
    /// Folder for the report
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Frames to measure, as in 0-99:50,120 [default: three, spread over the path]
    #[arg(short, long, value_name = "RANGES")]
    frames: Option<FrameRanges>,
    /// Columns and rows of the frames that are measured [default: 128 columns]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// How often each technique renders each frame
    #[arg(long, value_name = "N", default_value = "5", value_parser = clap::value_parser!(u32).range(2..=1000))]
    seeds: u32,
    /// relMSE of the references: half the smallest error of interest or less
    #[arg(long, value_name = "X", default_value = "0.0001")]
    reference_error: f64,
    /// Write over files of the report's names that flythrough did not write
    #[arg(long)]
    replace: bool,
    #[command(flatten)]
    threads: ThreadsArgument,
    /// No progress bar and no summary
    #[arg(short, long)]
    quiet: bool,
}

/// Columns of the frames that are measured, unless given.
const COLUMNS: u32 = 128;

/// Frames that are measured, unless given: from the middles of this many parts of the path.
const FRAMES: u32 = 3;

pub(super) fn run(arguments: &ReportArguments) -> Result<Status, Failure> {
    if !arguments.replace {
        check_free_for_report(&arguments.out)?;
    }
    let loaded = job::Inputs::load(
        &arguments.input.scene,
        &arguments.input.path,
        arguments.threads.threads,
    )?;
    warn(&loaded.scene.warnings);
    let given = loaded.settings(Settings::default());
    let size = arguments.size.unwrap_or_else(|| given.size_within(COLUMNS));
    let check = Settings {
        size: Some(size),
        target_error: Some(arguments.reference_error),
        ..Settings::default()
    };
    check.check().map_err(|error| match error.key {
        "size" => format!("--{error}"),
        _ => format!("--reference-error: {}", error.message),
    })?;
    let timeline = loaded.path.path.timeline();
    let frames = match &arguments.frames {
        Some(ranges) => ranges.of_path(timeline.frame_count())?,
        None => timeline.spread(FRAMES),
    };
    let stem = arguments.input.path.file_stem().unwrap_or_default();
    let inputs = Inputs {
        scene: &loaded.scene.scene,
        path: &loaded.path.path,
        given,
        fingerprint: format!("{BUILD} {} {}", loaded.scene_hash, loaded.path_hash),
        frames,
        size,
        seeds: arguments.seeds,
        reference_error: arguments.reference_error,
        folder: &arguments.out,
        title: stem.to_string_lossy().into_owned(),
    };
    let progress = FractionProgress::new(arguments.quiet);
    let made = loaded
        .pool
        .install(|| report(&inputs, &|done, what| progress.at(done, what)));
    progress.finish();
    let made = made?;
    if !arguments.quiet {
        for line in &made.advice {
            say(format_args!("{line}"));
        }
        say(format_args!(
            "{}",
            arguments.out.join("report.md").display()
        ));
    }
    Ok(Status::Done)
}
