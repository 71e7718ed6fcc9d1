//! The arguments of `flythrough path`.

use super::job_args::{InputArguments, ThreadsArgument};
use super::values::parse_size;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Plot, import or export camera paths
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

/// Plot a camera path through a scene
///
/// A plan and an elevation, to scale, as sections of the scene at the camera: the path, its keys, view frustums, and
/// dots at equal times. Charts of speed, turn rate and zoom over time.
///
/// Exit status: 0 success, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct PlotArguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    /// File to write (SVG)
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Write over a file that is there already
    #[arg(long)]
    pub(super) replace: bool,
    /// Size of the frames, for the aspect of the view frustums [default: the path's or the scene's]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,
    #[command(flatten)]
    pub(super) threads: ThreadsArgument,
}

/// Import an animated camera of another program as a camera path file
///
/// Reads camera_path.json of nerfstudio and glTF files (.gltf, .glb), as Blender exports them: animations of the
/// camera, of its parent nodes and of its field of view (KHR_animation_pointer). The path has a key for each frame, so
/// that its frames are those of the other program. Coordinates are not converted: +Y is up in glTF, +Z in nerfstudio.
///
/// Exit status: 0 success, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct ImportArguments {
    /// File to import
    pub(super) file: PathBuf,
    /// Camera path file to write (RON)
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Frames per second, for glTF files [default: 24]
    #[arg(long, value_name = "FPS")]
    pub(super) fps: Option<f64>,
    /// Name of the camera, for glTF files [default: the only one, or the only animated one]
    #[arg(long, value_name = "NAME")]
    pub(super) camera: Option<String>,
    /// Write over a file that is there already
    #[arg(long, alias = "force")]
    pub(super) replace: bool,
}

/// Export the cameras of all frames for another program
///
/// The extension gives the format: camera_path.json of nerfstudio (.json), an animated camera for Blender and others
/// (.gltf, .glb; single precision), or a table with a line for each frame (.jsonl: number, time, position, quaternion,
/// fov), as render writes beside its frames.
///
/// Exit status: 0 success, 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    /// The camera path file (RON)
    pub(super) path: PathBuf,
    /// File to write: .json, .gltf, .glb or .jsonl
    #[arg(short, long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Write over a file that is there already
    #[arg(long, alias = "force")]
    pub(super) replace: bool,
    /// Size of the frames, for formats that contain it [default: the path's, or 1280x720]
    #[arg(short, long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,
}
