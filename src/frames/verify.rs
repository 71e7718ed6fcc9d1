use super::format::FrameFormat;
use super::picture::{Contents, Picture};
use super::record::FrameRecord;
use std::io;
use thiserror::Error;

/// Why a frame is not proven.
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
    /// It says nothing of what it is of.
    #[error("holds no whole record of flythrough")]
    Foreign,
    /// It is another frame.
    #[error("is frame {0} under another name")]
    OtherFrame(u32),
    /// It is not what was written.
    #[error("altered after it was written")]
    Altered,
    /// It was made from something else.
    #[error("stale: made from another scene, path or settings, or by another version")]
    Stale,
    /// The same of the map of its error.
    #[error("its error map is not right: {0}")]
    ErrorMap(Box<VerifyError>),
}

/// What a frame's file has to be.
pub(super) struct Expected<'a> {
    pub(super) frame: u32,
    pub(super) format: FrameFormat,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    pub(super) input_hash: &'a str,
}

impl Expected<'_> {
    /// Proves that the bytes of a file are what this program wrote for the frame, to the last of them: its pixels
    /// are those that it says it has, and encoded anew they are the same bytes.
    pub(super) fn verify(&self, bytes: &[u8]) -> Result<(FrameRecord, Picture), VerifyError> {
        if bytes.is_empty() {
            return Err(VerifyError::Empty);
        }
        let decoded = self.format.decode(bytes, self.size);
        let Contents { note, picture } = decoded.map_err(VerifyError::Damaged)?;
        let note = note.ok_or(VerifyError::Foreign)?;
        let record = FrameRecord::from_text(&note).ok_or(VerifyError::Foreign)?;
        if record.frame != self.frame {
            return Err(VerifyError::OtherFrame(record.frame));
        }
        let is_stale = record.input_hash != self.input_hash;
        let Some(picture) = picture else {
            return Err(if is_stale {
                VerifyError::Stale
            } else {
                VerifyError::Altered
            });
        };
        let again = self.format.encode(&picture, &note);
        if record.pixels != picture.hash().to_string() || again.ok().as_deref() != Some(bytes) {
            return Err(VerifyError::Altered);
        }
        if is_stale {
            Err(VerifyError::Stale)
        } else {
            Ok((record, picture))
        }
    }
}
