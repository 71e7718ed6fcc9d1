//! Why there is no report.

use crate::drawing::DrawingError;
use crate::storage::FileError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A file of it cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file under the name of one of its own was not written by the program.
    #[error(
        "{file}: is there already, and flythrough did not write it: use another folder, or --replace to write over it",
        file = .file.display()
    )]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// A chart cannot be drawn.
    #[error(transparent)]
    Chart(#[from] DrawingError),
    /// A picture or a table cannot be encoded.
    #[error("a part of the report cannot be encoded: {0}")]
    Encoding(io::Error),
}
