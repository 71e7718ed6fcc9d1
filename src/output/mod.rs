//! Finished films to files: names, encodings, a folder that never holds half a frame, and sheets of many frames;
//! and files of light that camera paths share.

mod contact_sheet;
mod exr_file;
mod fault;
mod folder;
mod format;
mod light_file;
mod manifest;
mod part_file;
mod picture;
mod plan;
mod png_file;
mod record;
#[cfg(test)]
mod tests;

pub use contact_sheet::ContactSheet;
pub use exr_file::{decode as decode_exr, encode as encode_exr, note as note_of_exr};
pub use fault::Fault;
pub use folder::{FolderError, FrameFolder, Place};
pub use format::FrameFormat;
pub use light_file::{LightFile, LightFileError};
pub use manifest::Manifest;
pub use part_file::{PartFile, try_out, write_whole};
pub use plan::{Plan, PlanCommand};
pub use record::{FrameError, FrameRecord};
