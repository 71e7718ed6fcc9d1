use super::frames::FrameRanges;
use super::input_args::{InputArguments, ThreadsArgument};
use super::path_args::PathArguments;
use super::values::{
    AovArgument, FormatArgument, ListFormatArgument, OrderArgument, PrepareArgument,
    ProgressArgument, SampleSize, parse_distance, parse_size, parse_time,
};
use crate::input::{GlobalIllumination, Mode, Settings};
use clap::{Args, Parser, Subcommand};
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::time::Duration;

/// Renders pre-recorded camera fly-throughs: a scene and a camera path in, every frame out.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(RenderArguments),
    Quote(QuoteArguments),
    Verify(VerifyArguments),
    Missing(MissingArguments),
    Audit(AuditArguments),
    Sheet(SheetArguments),
    Bake(BakeArguments),
    Check(CheckArguments),
    Report(ReportArguments),
    Path(PathArguments),
    /// Run numerically hard cases with known answers on this machine
    ///
    /// Takes less than a minute. Prints for each case what is measured, the most that is right, and the
    /// worst value with each set of instructions that the processor has.
    ///
    /// Exit status: 0 all values are within their limits, 1 some are not.
    Selftest,
}

/// Render the frames of a camera path
///
/// Settings may also stand in the scene or the path file; the path's win over the scene's, and a
/// flag wins over both.
///
/// Frames that are already in the folder are proven: each says in its file what it was made from and what
/// its pixels are. Those that are whole, unchanged and made from the same files and settings are left as they
/// are, all others are rendered again; so an interrupted run is taken up by the same command, and several
/// processes, on one machine or many, may work on one folder at the same time.
///
/// Exit status: 0 all frames are there, 2 wrong input or usage (trying again cannot help), 3 some frames
/// failed (it may), 75 interrupted by SIGTERM or Ctrl-C (it goes on from there).
#[derive(Debug, Args)]
pub(super) struct RenderArguments {
    #[command(flatten)]
    pub(super) job: JobArguments,
    /// Folder for the frames: frame_00000.png onward
    #[arg(short, long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Frames to render, as in 0-99:2,120 [default: all]
    #[arg(short, long, value_name = "RANGES")]
    pub(super) frames: Option<FrameRanges>,
    /// Take as many camera samples as all frames of the path can have in this time, as in 2h or 90min, on this
    /// machine; the choice is kept in the folder
    #[arg(long, value_name = "TIME", value_parser = parse_time, conflicts_with_all = ["samples", "target_error", "aov"])]
    pub(super) budget: Option<Duration>,
    /// See the move before paying for it: frames of 320 columns, ray traced, one sample in the middle of each
    /// pixel, whatever files set. They go to DIR/preview, with a contact sheet, sheet.png; frames in DIR stay as they are
    #[arg(long, conflicts_with_all = [
        "mode", "size", "samples", "splits", "target_error", "gi", "gi_cache", "budget", "aov", "prepare",
    ])]
    pub(super) preview: bool,
    /// Which frames come first
    #[arg(long, value_enum, default_value = "sequential")]
    pub(super) order: OrderArgument,
    /// Render nothing, only make the folder ready for processes that will
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(super) prepare: Option<PrepareArgument>,
    /// Render frames even if they are there already
    #[arg(long)]
    pub(super) force: bool,
    /// How progress is told
    #[arg(long, value_enum, default_value = "auto")]
    pub(super) progress: ProgressArgument,
    /// No progress and no summary
    #[arg(short, long)]
    pub(super) quiet: bool,
}

impl RenderArguments {
    /// The folder that the frames are kept in.
    pub(super) fn folder(&self) -> PathBuf {
        match self.preview {
            true => self.out.join("preview"),
            false => self.out.clone(),
        }
    }
}

/// What decides the frames of a sequence, and how they are made.
#[derive(Debug, Args)]
pub(super) struct JobArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    #[command(flatten)]
    pub(super) settings: SettingsArguments,
    /// File for the light of --gi cached, which may be that of a bake or of other runs; made if it is not there
    /// [default: irradiance.cache in the folder of the frames]
    #[arg(long, value_name = "FILE")]
    pub(super) gi_cache: Option<PathBuf>,
    /// File format of the frames
    #[arg(long, value_enum, default_value = "png")]
    pub(super) format: FormatArgument,
    /// Also keep, beside each frame of the montecarlo modes, error_00000.exr: how far chance may have moved
    /// every pixel (half the difference between the two halves of its samples; linear light)
    #[arg(long, value_enum, value_name = "LAYER")]
    pub(super) aov: Option<AovArgument>,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
}

/// Say what a sequence will take, before it is paid for: time, disk and memory
///
/// Renders a few frames of the path, small ones where whole ones would take long, and tells what all of them will
/// take on this machine: what is most likely, and between what it is 19 times of 20. Light of --gi cached is worked
/// out for it; with --out or --gi-cache it is kept, and costs nothing more.
///
/// What is quoted to a folder is held against what it took, when its frames are rendered.
///
/// Exit status: 0 it is told, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct QuoteArguments {
    #[command(flatten)]
    pub(super) job: JobArguments,
    /// Folder that the frames will be rendered to
    #[arg(short, long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Choose as many camera samples as all frames can have in this time, as in 2h or 90min
    #[arg(long, value_name = "TIME", value_parser = parse_time, conflicts_with_all = ["samples", "target_error"])]
    pub(super) budget: Option<Duration>,
    /// No progress bar
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Render some frames of a folder again, and compare them with what is there, byte for byte
///
/// They are made as the command made them that is written down in the folder, light of --gi cached as it is kept in
/// its file. So a machine of a farm that renders other pictures than this one is found.
///
/// Exit status: 0 all are the same, 2 not a folder of frames, or made from something else, 3 some are not the
/// same.
#[derive(Debug, Args)]
pub(super) struct AuditArguments {
    /// Folder of the frames
    pub(super) folder: PathBuf,
    /// How many frames, as in 1% or 5; one at least
    #[arg(long, value_name = "N", default_value = "1%")]
    pub(super) sample: SampleSize,
    /// Chooses other frames
    #[arg(long, value_name = "N", default_value = "0")]
    pub(super) seed: u64,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
    /// How progress is told
    #[arg(long, value_enum, default_value = "auto")]
    pub(super) progress: ProgressArgument,
    /// No progress and no summary
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Prove that every frame of a sequence is there, whole, unchanged and made from what it should be
///
/// Prints a line for each frame that is not, and why. What the frames were made from is loaded as it is now: if it
/// was changed since, frames are stale. If it cannot be loaded, that is said in a warning, and frames are held
/// against what was written down when they were rendered.
///
/// Exit status: 0 all frames are proven, 2 not a folder of frames, 3 some are not: render again.
#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    /// Folder of the frames
    pub(super) folder: PathBuf,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
    /// No progress bar and no summary
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// List the frames of a sequence that are not proven, to be rendered again
///
/// Prints nothing if all are. What the frames should be stands in the folder, as the last render has left it
/// there; render --prepare plan writes it anew after a change.
///
/// Exit status: 0 they are listed, 2 not a folder of frames.
#[derive(Debug, Args)]
pub(super) struct MissingArguments {
    /// Folder of the frames
    pub(super) folder: PathBuf,
    /// How they are listed
    #[arg(long, value_enum, default_value = "list")]
    pub(super) format: ListFormatArgument,
    /// Frames of each task of a Slurm array: task N renders frames N x CHUNK to (N + 1) x CHUNK - 1
    #[arg(long, value_name = "CHUNK", default_value = "1")]
    pub(super) chunk: NonZeroU32,
    /// No progress bar
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Draw a contact sheet of a folder of frames: a camera move at a glance
///
/// Shows at most 30 frames, spread evenly, the first and the last among them, each with its number and its time. A
/// frame that is not proven leaves its place empty, but for what is wrong with it.
///
/// Exit status: 0 the sheet is there, 2 not a folder of frames, or the sheet cannot be written.
#[derive(Debug, Args)]
pub(super) struct SheetArguments {
    /// Folder of the frames
    pub(super) folder: PathBuf,
    /// File for the sheet, a PNG [default: sheet.png in the folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Frames to choose from, as in 0-99:2,120 [default: all]
    #[arg(short, long, value_name = "RANGES")]
    pub(super) frames: Option<FrameRanges>,
    /// Do not name the sheet
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Work out the indirect light of a camera path and keep it in a file, for render --gi-cache
///
/// A file that is there already is not worked out again: if it holds the light of other paths through the same
/// scene, with the same settings, what this path needs is added.
///
/// Of the settings, size, bounces, seed and target error decide the light; renderings that share it set the
/// same.
///
/// Exit status: 0 the file is there, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct BakeArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    /// File for the light
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    pub(super) settings: SettingsArguments,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
    /// Work it out anew if the file holds the light of something else or is damaged
    #[arg(long)]
    pub(super) force: bool,
    /// No progress bar and no summary
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// Load a scene and a camera path, say what is there and what is odd, render nothing
///
/// Of the path it says, with frame numbers: where the camera is inside or passes through something or comes too
/// near, where its speed or its turning jumps or is out of proportion, where what is seen moves so fast that it
/// strobes, where look_at makes the picture spin, and whether a closed path has a seam.
///
/// Exit status: 0 both can be rendered, whatever is odd, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    /// How many metres the camera should stay away from surfaces
    #[arg(long, value_name = "METRES", default_value = "0.1", value_parser = parse_distance)]
    pub(super) near: f64,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
}

/// Measure what every technique costs on a scene and a path, and how far off it is
///
/// Renders a few small frames of the path by each technique, with several seeds, and compares them with
/// references, which are made once and kept in the folder. Writes report.md, report.csv, report.json, the
/// curves of error against time, the flicker along the path, a picture of each technique's errors, and
/// advice: the cheapest settings for a relMSE of 0.01, where noise is just seen, and of 0.001, where it
/// hardly is.
///
/// The light of the path (--gi cached) is worked out once, as for the whole sequence at its own size, and each
/// frame is charged its share: those seconds are right if all frames are rendered.
///
/// Exposure, bounces and the size that the advice is for are the scene's and the path's. The error is
/// relMSE: the mean of (x - r)^2 / (m^2 + 0.01), where x is a pixel, r is the reference's, and m the mean
/// of the reference's pixels around; 1 is display white. Run it on a machine that does nothing else.
///
/// Exit status: 0 the report is there, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct ReportArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    /// Folder for the report
    #[arg(short, long, value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Frames to measure, as in 0-99:50,120 [default: three, spread over the path]
    #[arg(short, long, value_name = "RANGES")]
    pub(super) frames: Option<FrameRanges>,
    /// Columns and rows of the frames that are measured [default: 128 columns]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,
    /// How often each technique renders each frame
    #[arg(long, value_name = "N", default_value = "5", value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub(super) seeds: u32,
    /// relMSE of the references: a tenth of the least error that matters to you
    #[arg(long, value_name = "X", default_value = "0.0001")]
    pub(super) reference_error: f64,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
    /// No progress bar and no summary
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct SettingsArguments {
    /// raytracing, supersampling, montecarlo or montecarlo-supersampling [default: raytracing]
    #[arg(short, long)]
    mode: Option<Mode>,
    /// Columns and rows, as in 1280x720 [default: 1280x720]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Camera samples spread over each pixel [default: 1 in its middle, or 4 in its corners in the
    /// supersampling modes]
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Mirror reflections, in the montecarlo modes all bounces [default: 4]
    #[arg(long, value_name = "N")]
    bounces: Option<u32>,
    /// Paths that go on from each diffuse bounce in the montecarlo modes [default: 32,1,1,1]
    #[arg(long, value_name = "N,N,...", value_delimiter = ',')]
    splits: Option<Vec<u32>>,
    /// Chooses the random numbers [default: 0]
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// The same random numbers in all frames: noise stands still where the camera does [default: new ones
    /// in each frame]
    #[arg(long)]
    lock_seed: bool,
    /// Exposure in stops: +1 doubles the light of PNG frames; EXR keeps it as it is [default: 0]
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    exposure: Option<f32>,
    /// Add samples to each frame of the montecarlo modes, where it needs them, until the frame's own
    /// estimate of its error is below this with its whole interval. The error is relMSE, the mean
    /// squared error relative to the light: noise is just seen at 0.01, and hardly at 0.001
    /// [default: the samples given]
    #[arg(long, value_name = "X")]
    target_error: Option<f64>,
    /// How the montecarlo modes know the light that is gathered at what the camera sees: exact, at every
    /// camera sample, or path, worked out once for the whole path and looked up: many times as fast, and off by
    /// a few thousandths on average [default: path for sequences, unless splits are set; exact for stills]
    #[arg(long, value_name = "HOW")]
    gi: Option<GlobalIllumination>,
}

impl SettingsArguments {
    pub(super) fn settings(&self) -> Settings {
        Settings {
            mode: self.mode,
            size: self.size,
            samples: self.samples,
            bounces: self.bounces,
            splits: self.splits.clone(),
            seed: self.seed,
            lock_seed: self.lock_seed.then_some(true),
            exposure: self.exposure,
            target_error: self.target_error,
            gi: self.gi,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn definitions_are_consistent() {
        Arguments::command().debug_assert();
    }
}
