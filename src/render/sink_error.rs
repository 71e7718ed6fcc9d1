//! Why a frame could not be kept.

/// Why a frame could not be kept.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;
