//! `sheet`: a contact sheet of a folder of frames.

use super::frames::FrameRanges;
use super::outcome::{Failure, Status, keep, say};
use crate::frames::write_contact_sheet;
use crate::job::open_folder;
use clap::Args;
use std::path::PathBuf;

/// Draw a contact sheet of a folder of frames
///
/// Shows at most 30 frames, spread evenly, the first and the last among them, each with its number and its time. A
/// frame that is not verified is replaced by what is wrong with it.
///
/// Exit status: 0 success; 2 not a folder of frames, or the sheet cannot be written.
#[derive(Debug, Args)]
pub(super) struct SheetArguments {
    /// Folder of the frames
    folder: PathBuf,
    /// File for the sheet, a PNG [default: sheet.png in the folder]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write over a file that is there already; the folder's own sheet.png is replaced in any case
    #[arg(long)]
    replace: bool,
    /// Frames to choose from, as in 0-99:2,120 [default: all]
    #[arg(short, long, value_name = "RANGES")]
    frames: Option<FrameRanges>,
    /// Do not name the sheet
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(arguments: &SheetArguments) -> Result<Status, Failure> {
    let folder = open_folder(&arguments.folder, &[])?;
    let count = folder.sequence().frames;
    let frames = match &arguments.frames {
        None => (0..count).collect(),
        Some(ranges) => ranges.of_path(count)?,
    };
    let file = arguments.out.clone().unwrap_or_else(|| folder.sheet());
    if folder.is_reserved(&file) {
        let file = file.display();
        return Err(format!("--out: {file} is a name of the frames' own; use another").into());
    }
    // A name that is given by mistake may be that of an input.
    if file.extension().is_none_or(|extension| extension != "png") {
        let file = file.display();
        return Err(format!("--out: {file}: the sheet is a PNG file: name it .png").into());
    }
    let is_own = folder.is_sheet(&file) && folder.has_its_sheet();
    keep(&file, arguments.replace || is_own)?;
    write_contact_sheet(&folder, &frames, &file)?;
    if !arguments.quiet {
        say(format_args!("{}", file.display()));
    }
    Ok(Status::Done)
}
