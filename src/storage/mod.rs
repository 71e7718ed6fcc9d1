//! Files that are there whole or not at all: written beside their name, brought to the disk, then renamed.

mod part_file;

pub(crate) use part_file::remove_leftovers;
pub use part_file::{PartFile, check_writable, write_atomic};
