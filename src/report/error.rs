//! Why there is no report.

use crate::drawing::DrawingError;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A file of it cannot be written.
    #[error("{file}: cannot be written: {source}", file = .file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A chart cannot be drawn.
    #[error(transparent)]
    Chart(#[from] DrawingError),
    /// A picture or a table cannot be encoded.
    #[error("a part of the report cannot be encoded: {0}")]
    Encoding(io::Error),
}

impl ReportError {
    pub(super) fn file(file: &Path, source: io::Error) -> ReportError {
        ReportError::Unwritable {
            file: file.to_owned(),
            source,
        }
    }
}
