//! `flythrough path export`: the cameras of all frames for another program.

use super::outcome::{Failure, Status, keep};
use super::path_args::ExportArguments;
use crate::camera::FrameCameras;
use crate::camera_formats::{CameraFormat, export_cameras, load_camera_path};
use crate::input::{InputFiles, Settings};
use crate::storage::write_atomic;

pub(super) fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    keep(&arguments.out, arguments.replace)?;
    let format = CameraFormat::of_file(&arguments.out)?;
    let input = load_camera_path(&arguments.path, &mut InputFiles::default())?;
    let flags = Settings {
        size: arguments.size,
        ..Settings::default()
    };
    flags.check().map_err(|error| error.of_flag())?;
    let settings = flags.or(input.settings).resolve(1);
    let frames = FrameCameras::of(&input.path);
    let size = (settings.width, settings.height);
    let bytes = export_cameras(format, &frames, &input.path.key_cameras(), size)?;
    write_atomic(&arguments.out, &bytes)?;
    Ok(Status::Done)
}
