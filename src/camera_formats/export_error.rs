//! Why cameras cannot be exported.

use std::path::PathBuf;
use thiserror::Error;

/// Why cameras cannot be exported.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The extension of the file is that of no format.
    #[error("{}: name it .json, .gltf, .glb or .jsonl", file.display())]
    UnknownFormat {
        /// The file.
        file: PathBuf,
    },
    /// The times of successive frames would be equal or uneven in single precision.
    #[error(
        "glTF keeps times in single precision, which cannot tell frames near {end} s apart: begin the path at 0 s, \
         or export .json or .jsonl"
    )]
    GltfTimes {
        /// When the last frame is shown, in seconds.
        end: f64,
    },
    /// A number cannot be written.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}
