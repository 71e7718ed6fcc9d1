//! Whether a file is a frame of the sequence, to the last byte what the program wrote for it.

use super::encoded_pixels::{Contents, EncodedPixels};
use super::format::FrameFormat;
use super::record::FrameRecord;
use super::sequence_record::SequenceRecord;
use crate::storage::FileError;
use std::io;
use thiserror::Error;

/// Why a frame is not verified.
#[derive(Debug, Error)]
pub enum VerifyError {
    /// There is no such file.
    #[error("missing")]
    Missing,
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(io::Error),
    /// It holds nothing.
    #[error("empty")]
    Empty,
    /// It cannot be decoded.
    #[error("cut short or damaged: {0}")]
    Damaged(String),
    /// Its metadata is not a valid record.
    #[error("no valid flythrough metadata")]
    Foreign,
    /// It is another frame.
    #[error("is frame {0} under another name")]
    OtherFrame(u32),
    /// It is not what was written.
    #[error("altered after it was written")]
    Altered,
    /// It was made from other inputs.
    #[error("stale: made from another scene, path or settings")]
    Stale,
    /// It was rendered by another build of the program, whose pixels may differ.
    #[error("rendered by build {0}: render it again, or accept it by --accept-build {0}")]
    OtherBuild(String),
    /// Its error map is not verified.
    #[error("error map: {0}")]
    ErrorMap(Box<VerifyError>),
}

impl VerifyError {
    /// Of a file that cannot be read.
    pub(super) fn unreadable(error: FileError) -> VerifyError {
        match error.is_missing() {
            true => VerifyError::Missing,
            false => VerifyError::Unreadable(error.source),
        }
    }
}

/// What the file of a frame has to be.
pub(super) struct Expected<'a> {
    pub(super) frame: u32,
    /// Of the file: a map has another one than the sequence.
    pub(super) format: FrameFormat,
    pub(super) sequence: &'a SequenceRecord,
}

impl Expected<'_> {
    /// Verifies that the bytes of a file are what this program wrote for the frame, to the last of them: its pixels
    /// have the hash that it states, and encoded anew they are the same bytes.
    pub(super) fn verify(&self, bytes: &[u8]) -> Result<(FrameRecord, EncodedPixels), VerifyError> {
        if bytes.is_empty() {
            return Err(VerifyError::Empty);
        }
        let sequence = self.sequence;
        let size = (sequence.width, sequence.height);
        let decoded = self.format.decode(bytes, size);
        let Contents { metadata, pixels } = decoded.map_err(VerifyError::Damaged)?;
        let metadata = metadata.ok_or(VerifyError::Foreign)?;
        let record = FrameRecord::from_text(&metadata).ok_or(VerifyError::Foreign)?;
        if record.frame != self.frame {
            return Err(VerifyError::OtherFrame(record.frame));
        }
        let is_stale = record.input_hash != sequence.input_hashes[self.frame as usize];
        let Some(pixels) = pixels else {
            return Err(if is_stale {
                VerifyError::Stale
            } else {
                VerifyError::Altered
            });
        };
        let again = self.format.encode(&pixels, &metadata);
        if record.pixel_hash != pixels.hash().to_string() || again.ok().as_deref() != Some(bytes) {
            return Err(VerifyError::Altered);
        }
        if is_stale {
            Err(VerifyError::Stale)
        } else if !sequence.accepts(&record.build) {
            Err(VerifyError::OtherBuild(record.build))
        } else {
            Ok((record, pixels))
        }
    }
}
