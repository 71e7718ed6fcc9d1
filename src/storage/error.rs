//! Why a file cannot be read or written.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file or a folder that cannot be accessed.
#[derive(Debug, Error)]
#[error("{file}: cannot be {access}: {source}", file = .file.display())]
pub struct FileError {
    /// The file or the folder.
    pub file: PathBuf,
    /// What was tried.
    pub access: Access,
    /// What the system says.
    pub source: io::Error,
}

/// What is done to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// It is read.
    Read,
    /// It is made, written, renamed or removed.
    Written,
}

impl fmt::Display for Access {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Access::Read => "read",
            Access::Written => "written",
        })
    }
}

impl FileError {
    /// A file that cannot be read.
    pub fn reading(file: &Path, source: impl Into<io::Error>) -> FileError {
        FileError {
            file: file.to_owned(),
            access: Access::Read,
            source: source.into(),
        }
    }

    /// A file that cannot be written.
    pub fn writing(file: &Path, source: impl Into<io::Error>) -> FileError {
        FileError {
            file: file.to_owned(),
            access: Access::Written,
            source: source.into(),
        }
    }

    /// The kind of the system's error.
    pub fn kind(&self) -> io::ErrorKind {
        self.source.kind()
    }

    /// Whether there is no such file.
    pub fn is_missing(&self) -> bool {
        self.kind() == io::ErrorKind::NotFound
    }
}
