//! Finished films to files: names, encodings, a folder that never holds half a frame, and sheets of many frames;
//! files of light that camera paths share; and cameras to files of other programs.

mod camera_path_file;
mod camera_table;
mod contact_sheet;
mod exr_file;
mod fault;
mod folder;
mod format;
mod gltf_file;
mod light_file;
mod manifest;
mod nerfstudio;
mod part_file;
mod picture;
mod plan;
mod png_file;
mod record;
#[cfg(test)]
mod tests;

pub use camera_path_file::camera_path_file;
pub use camera_table::camera_table;
pub use contact_sheet::ContactSheet;
pub use exr_file::{decode as decode_exr, encode as encode_exr, note as note_of_exr};
pub use fault::Fault;
pub use folder::{FolderError, FrameFolder, Place};
pub use format::FrameFormat;
pub use gltf_file::{GltfContainer, GltfError, gltf_file};
pub use light_file::{LightFile, LightFileError};
pub use manifest::Manifest;
pub use nerfstudio::nerfstudio_json;
pub use part_file::{PartFile, try_out, write_whole};
pub use plan::{Plan, PlanCommand};
pub use record::{FrameError, FrameRecord};
