use super::job_args::{InputArguments, ThreadsArgument};
use super::values::parse_size;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// See a camera path, bring one along from another program, or take it there
#[derive(Debug, Args)]
pub(super) struct PathArguments {
    #[command(subcommand)]
    pub(super) command: PathCommand,
}

#[derive(Debug, Subcommand)]
pub(super) enum PathCommand {
    Plot(PlotArguments),
    Import(ImportArguments),
    Export(ExportArguments),
}

/// Draw where a camera path leads through a scene, and how fast, as one picture
///
/// A plan from above and an elevation from the side, both to scale and with the scene cut open at the camera:
/// the path, its keys, what the camera sees, and dots at equal times. Below or beside, over time: speed, turning
/// and zoom.
///
/// Exit status: 0 the picture is there, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct PlotArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    /// File for the picture (SVG)
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Columns and rows of the frames: how wide the camera sees [default: the path's or the scene's]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
}

/// Make a camera path file of an animated camera of another program
///
/// Reads camera_path.json of nerfstudio and glTF files (.gltf, .glb), as Blender exports them with the camera: what
/// moves the camera and what it hangs on, and its field of view (KHR_animation_pointer). The path has a key for
/// each frame, so that its frames are those of the other program. Coordinates are kept as they are: of glTF +Y is up, of
/// nerfstudio +Z.
///
/// Exit status: 0 the path is there, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct ImportArguments {
    /// File to import
    pub(super) file: PathBuf,
    /// File for the camera path (RON)
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Frames per second of a glTF file, which does not say [default: 24]
    #[arg(long, value_name = "FPS")]
    pub(super) fps: Option<f64>,
    /// Name of the camera in a glTF file [default: the only one, or the only one that is animated]
    #[arg(long, value_name = "NAME")]
    pub(super) camera: Option<String>,
    /// Replace a path file that is there already
    #[arg(long)]
    pub(super) force: bool,
}

/// Write the cameras of a path's frames for another program
///
/// By the name of the file: camera_path.json for nerfstudio (.json), an animated camera for Blender and others
/// (.gltf, .glb; single precision), or a table with a line for each frame (.jsonl: number, time, position,
/// quaternion, fov), as render leaves beside its frames.
///
/// Exit status: 0 the file is there, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    /// The camera path file (RON)
    pub(super) path: PathBuf,
    /// File to write: .json, .gltf, .glb or .jsonl
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Replace a file that is there already
    #[arg(long)]
    pub(super) force: bool,
    /// Columns and rows of the frames, for formats that say them [default: the path's, or 1280x720]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,
}
