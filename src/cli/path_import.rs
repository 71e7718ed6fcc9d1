//! `flythrough path import`: a camera path file from an animated camera of another program.

use super::outcome::{Failure, Status, keep, say};
use super::path_args::ImportArguments;
use crate::camera_formats::{camera_path_to_ron, import_cameras, parse_camera_path};
use crate::storage::write_atomic;

pub(super) fn run(arguments: &ImportArguments) -> Result<Status, Failure> {
    let out = &arguments.out;
    keep(out, arguments.replace)?;
    let import = import_cameras(&arguments.file, arguments.fps, arguments.camera.as_deref())?;
    let name = arguments.file.file_name().unwrap_or_default();
    let comment = format!(
        "The camera of {}: a key for each frame.",
        name.to_string_lossy().escape_debug()
    );
    let text = camera_path_to_ron(&import.frames, import.size, &comment);
    let path = parse_camera_path(&arguments.file, text.as_bytes())?.path;
    write_atomic(out, text.as_bytes())?;
    let timeline = path.timeline();
    say(format_args!(
        "{}: {} frames at {} per second, {:.2} s",
        out.display(),
        timeline.frame_count(),
        timeline.fps,
        timeline.end - timeline.start
    ));
    Ok(Status::Done)
}
