//! `missing`: the frames of a sequence that are not verified.

use super::frames::ranges;
use super::outcome::{Failure, Status};
use super::values::ListFormatArgument;
use super::verify::verify;
use crate::job::open_folder;
use clap::Args;
use std::io::Write;
use std::num::NonZeroU32;
use std::path::PathBuf;

/// List the frames of a sequence that are not verified, to be rendered again
///
/// Prints nothing if all are. Frames are verified against what the last render has recorded in the folder; after a
/// change render --prepare sequence records it anew.
///
/// Exit status: 0 success, 2 not a folder of frames.
#[derive(Debug, Args)]
pub(super) struct MissingArguments {
    /// Folder of the frames
    folder: PathBuf,
    /// How they are listed
    #[arg(long, value_enum, default_value = "list")]
    format: ListFormatArgument,
    /// Frames of each task of a Slurm array: task N renders frames N x CHUNK to (N + 1) x CHUNK - 1
    #[arg(long, value_name = "CHUNK", default_value = "1")]
    chunk: NonZeroU32,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &MissingArguments) -> Result<Status, Failure> {
    let folder = open_folder(&arguments.folder, &[])?;
    let frames: Vec<u32> = (0..folder.sequence().frames).collect();
    let proofs = verify(&folder, &frames, arguments.quiet).into_iter();
    let missing = proofs.filter_map(|(frame, proof)| proof.is_err().then_some(frame));
    let listed = match arguments.format {
        ListFormatArgument::List => missing.map(|frame| format!("{frame}\n")).collect(),
        ListFormatArgument::Openjd => line(missing.collect()),
        ListFormatArgument::Slurm => {
            let mut tasks: Vec<u32> = missing.map(|frame| frame / arguments.chunk).collect();
            tasks.dedup();
            line(tasks)
        }
    };
    write!(std::io::stdout(), "{listed}")?;
    Ok(Status::Done)
}

/// Ranges and a line's end; nothing of nothing.
fn line(numbers: Vec<u32>) -> String {
    match numbers.is_empty() {
        true => String::new(),
        false => ranges(&numbers) + "\n",
    }
}
