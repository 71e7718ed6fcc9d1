//! The file layer: whatever is read from a file or written to one goes through it.
//!
//! Files of a folder that the program shares with others are opened relative to the open [`Folder`], without following
//! links, and only if they are regular files of bounded size: nothing that is planted there is read for ever or written
//! through. A file is written under another, unpredictable name, synced to disk, then renamed: it exists whole or not at
//! all.

mod error;
#[cfg(test)]
pub(crate) mod fixtures;
mod folder;
mod input_file;
mod lock;
mod part_file;
mod temporary_file;
mod unfinished;

pub use error::{Access, FileError};
pub(crate) use folder::FileIdentity;
pub use folder::Folder;
pub use input_file::read_input;
pub use lock::{FileLock, WaitListener};
pub use part_file::{PartFile, write_atomic};
pub use unfinished::remove_unfinished;
