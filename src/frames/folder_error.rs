//! Why a folder of frames cannot be used.

use crate::storage::FileError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a folder cannot be used.
#[derive(Debug, Error)]
pub enum FolderError {
    /// A file of it cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Its `sequence.ron` is missing or cannot be understood.
    #[error(
        "{file}: {message}: not a folder of frames, or the file is lost or damaged; render the sequence (again): \
         verified frames are kept",
        file = .file.display()
    )]
    NoSequence {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// It has finished frames of another sequence.
    #[error(
        "{folder}: finished frames of {sequence} are there, {count} in number, {first} the first: use another folder, \
         or --replace to render in their place{accept}",
        folder = .folder.display(),
        sequence = match .other_build {
            Some(_) => "another build of the program",
            None => "another scene or path",
        },
        accept = match .other_build {
            Some(build) => format!(", or --accept-build {build} to keep them"),
            None => String::new(),
        }
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
        /// How many.
        count: usize,
        /// The name of the first.
        first: String,
        /// The build of the first, if nothing else differs.
        other_build: Option<String>,
    },
    /// It has the irradiance cache of another sequence, whose frames are not there yet.
    #[error(
        "{file}: is the irradiance cache of another scene or path: use another folder, or --replace to bake over it",
        file = .file.display()
    )]
    OthersCache {
        /// The file.
        file: PathBuf,
    },
    /// It has a file under the name of one of its own that the program did not write.
    #[error(
        "{file}: is there already, and flythrough did not write it: use another folder, or --replace to write over it",
        file = .file.display()
    )]
    Foreign {
        /// The file.
        file: PathBuf,
    },
}
