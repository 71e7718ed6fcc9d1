//! Import of cameras of other programs, whose formats are told apart by content.

use super::{gltf, json, nerfstudio};
use crate::camera::FrameCameras;
use crate::input::InputError;
use crate::input::InputFiles;
use crate::input::check::Checker;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;

/// The cameras of another program.
#[derive(Debug)]
pub struct CameraImport {
    /// The cameras of its frames.
    pub frames: FrameCameras,
    /// Columns and rows of its frames, if the file gives them.
    pub size: Option<(u32, u32)>,
}

/// The keys that tell the formats apart.
#[derive(Default, Deserialize)]
struct Keys {
    /// Of nerfstudio.
    camera_path: Option<IgnoredAny>,
    /// Of glTF.
    asset: Option<IgnoredAny>,
}

/// Frames per second of glTF files, which do not give any.
const FPS: f64 = 24.0;

/// Imports a camera path of nerfstudio or an animated camera of a glTF file. The coordinates are kept as they are.
///
/// `fps` and the name of the camera are for glTF files; those of nerfstudio give frames, and have one camera.
pub fn import_cameras(
    file: &Path,
    fps: Option<f64>,
    camera: Option<&str>,
) -> Result<CameraImport, InputError> {
    let check = Checker { file };
    let bytes = InputFiles::default().read(file)?;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let keys = match bytes.trim_ascii_start().first() {
        Some(b'{') => json::parse(file, bytes)?,
        _ => Keys::default(),
    };
    if keys.camera_path.is_some() {
        if fps.is_some() || camera.is_some() {
            let message = "has its own frames, and one camera: leave --fps and --camera out";
            return check.refuse("camera_path", message);
        }
        let (frames, size) = nerfstudio::parse(file, bytes)?;
        return Ok(CameraImport { frames, size });
    }
    if bytes.starts_with(gltf::MAGIC) || keys.asset.is_some() {
        let fps = check.positive("--fps", fps.unwrap_or(FPS))?;
        let frames = gltf::parse(file, bytes, fps, camera)?;
        return Ok(CameraImport { frames, size: None });
    }
    check.refuse(
        "file",
        "neither a camera_path.json of nerfstudio nor a glTF file (.gltf, .glb)",
    )
}
