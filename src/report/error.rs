//! Why there is no report.

use crate::drawing::DrawingError;
use crate::storage::FileError;
use std::io;
use thiserror::Error;

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A file of it cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A chart cannot be drawn.
    #[error(transparent)]
    Chart(#[from] DrawingError),
    /// A picture or a table cannot be encoded.
    #[error("a part of the report cannot be encoded: {0}")]
    Encoding(io::Error),
}
