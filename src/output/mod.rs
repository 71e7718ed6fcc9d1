//! Finished films to files: names, encodings, and a folder that never holds half a frame.

mod folder;
mod format;

pub use folder::{FolderError, FrameFolder, SequenceInfo};
pub use format::FrameFormat;
