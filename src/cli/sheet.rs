use super::args::SheetArguments;
use super::{Failure, Status, written};
use crate::frames::ContactSheet;
use crate::frames::FrameFolder;
use std::io::Write;
use std::path::Path;

pub(super) fn run(arguments: &SheetArguments) -> Result<Status, Failure> {
    let folder = FrameFolder::open(&arguments.folder)?;
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
    draw(&folder, &frames, &file)?;
    if !arguments.quiet {
        writeln!(std::io::stdout(), "{}", file.display())?;
    }
    Ok(Status::Done)
}

/// Makes a contact sheet of some frames of a folder.
pub(super) fn draw(folder: &FrameFolder, frames: &[u32], file: &Path) -> Result<(), Failure> {
    written(file, ContactSheet::new(folder, frames).write(file))
}
