//! Why a frame could not be stored.

/// Why a frame could not be stored.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;
