//! The frame store: a folder of numbered frames in which a file is a whole, verified frame or none, with the
//! expected frames (`sequence.ron`) and the records of those that are there (`manifest.ron`).

#[cfg(feature = "plots")]
mod contact_sheet;
mod encoded_pixels;
mod exr;
mod folder;
mod format;
mod manifest;
mod png_file;
mod record;
mod sequence_record;
#[cfg(test)]
mod tests;
mod verify;

#[cfg(feature = "plots")]
pub use contact_sheet::write_contact_sheet;
pub use exr::{decode as decode_exr, encode as encode_exr, read_metadata as read_exr_metadata};
pub use folder::{FolderError, FrameFolder, FrameLock};
pub use format::{FrameFormat, write_png};
pub use manifest::Manifest;
pub use record::{FrameError, FrameRecord};
pub use sequence_record::SequenceRecord;
pub use verify::VerifyError;
