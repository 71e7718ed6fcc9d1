//! Finished films to files: names, encodings, and a folder that never holds half a frame; and files of light
//! that camera paths share.

mod exr_file;
mod folder;
mod format;
mod light_file;
mod manifest;
mod record;

pub use exr_file::{decode as decode_exr, encode as encode_exr, note as note_of_exr};
pub use folder::{FolderError, FrameFolder, FrameStorage, SequenceInfo, try_out, write_whole};
pub use format::FrameFormat;
pub use light_file::{LightFile, LightFileError};
pub use manifest::Manifest;
pub use record::{FrameError, FrameRecord};
