//! Export of cameras to the formats of other programs.

use super::export_error::ExportError;
use super::gltf::{GltfContainer, to_gltf};
use super::{camera_table, nerfstudio};
use crate::camera::{Camera, FrameCameras};
use std::path::Path;

/// A format that cameras can be exported to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraFormat {
    /// `camera_path.json` of nerfstudio: `.json`.
    Nerfstudio,
    /// An animated camera in glTF 2.0, as text: `.gltf`.
    Gltf,
    /// An animated camera in glTF 2.0, binary: `.glb`.
    GltfBinary,
    /// A line of JSON for each frame: `.jsonl`.
    Table,
}

impl CameraFormat {
    /// The format of a file, by its extension.
    pub fn of_file(file: &Path) -> Result<CameraFormat, ExportError> {
        let extension = file.extension().unwrap_or_default();
        match extension.to_string_lossy().to_lowercase().as_str() {
            "json" => Ok(CameraFormat::Nerfstudio),
            "gltf" => Ok(CameraFormat::Gltf),
            "glb" => Ok(CameraFormat::GltfBinary),
            "jsonl" => Ok(CameraFormat::Table),
            _ => Err(ExportError::UnknownFormat {
                file: file.to_owned(),
            }),
        }
    }
}

/// The bytes of a file with the cameras of all frames, which have `size` columns and rows. `keys`, the cameras at the
/// keys with their times in seconds, are for nerfstudio, whose editor shows them.
pub fn export_cameras(
    format: CameraFormat,
    frames: &FrameCameras,
    keys: &[(f64, Camera)],
    size: (u32, u32),
) -> Result<Vec<u8>, ExportError> {
    let aspect = f64::from(size.0) / f64::from(size.1);
    match format {
        CameraFormat::Nerfstudio => Ok(nerfstudio::to_json(frames, keys, size)?.into_bytes()),
        CameraFormat::Gltf => to_gltf(frames, aspect, GltfContainer::Text),
        CameraFormat::GltfBinary => to_gltf(frames, aspect, GltfContainer::Binary),
        CameraFormat::Table => Ok(camera_table(frames)?.into_bytes()),
    }
}
