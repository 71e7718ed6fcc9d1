//! Atomic file writes: a file is written under another name, synced to disk, then renamed, so it exists whole or not at
//! all.

#[cfg(test)]
pub(crate) mod fixtures;
mod part_file;

pub(crate) use part_file::remove_leftovers;
pub use part_file::{PartFile, check_writable, write_atomic};
