//! The frame store: a folder of numbered frames in which a file is a whole, verified frame or none, with what the
//! frames are made from (`sequence.ron`) and what they say of themselves (`manifest.ron`).

#[cfg(feature = "plots")]
mod contact_sheet;
mod exr;
mod folder;
mod format;
mod manifest;
mod picture;
mod png_file;
mod record;
mod sequence;
#[cfg(test)]
mod tests;
mod verify;

#[cfg(feature = "plots")]
pub use contact_sheet::write_contact_sheet;
pub use exr::{decode as decode_exr, encode as encode_exr, note as note_of_exr};
pub use folder::{FolderError, FrameFolder, Slot};
pub use format::{FrameFormat, write_png};
pub use manifest::Manifest;
pub use record::{FrameError, FrameRecord};
pub use sequence::SequenceRecord;
pub use verify::VerifyError;
