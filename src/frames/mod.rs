//! The frame store: a folder of numbered frames in which a file is a whole, verified frame or none, with the
//! expected frames (`sequence.ron`) and the records of those that are there (`manifest.ron`).

#[cfg(feature = "plots")]
mod contact_sheet;
mod encoded_pixels;
mod exr;
mod file_names;
mod folder;
mod folder_error;
mod format;
mod frame_files;
mod manifest;
mod others;
mod png_file;
mod proof;
mod record;
mod sequence_record;
mod sink;
#[cfg(test)]
mod tests;
mod verify;

#[cfg(feature = "plots")]
pub use contact_sheet::write_contact_sheet;
pub use exr::{decode_with_metadata as decode_exr, encode as encode_exr};
pub use file_names::ERROR_CHART_TITLE;
pub use folder::{FrameFolder, is_name_of_frames};
pub use folder_error::FolderError;
pub use format::{FrameFormat, write_png};
pub use manifest::Manifest;
pub use others::Stray;
pub use record::{FrameError, FrameRecord};
pub use sequence_record::SequenceRecord;
pub use sink::FrameLock;
pub use verify::VerifyError;
