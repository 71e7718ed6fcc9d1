//! What a process knows of the files of a frame that it has verified or stored.

use crate::render::EncodedFrame;

/// A hash of all bytes of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FileHash(blake3::Hash);

impl FileHash {
    /// The hash of a file with these bytes.
    pub(super) fn of(bytes: &[u8]) -> FileHash {
        FileHash(blake3::hash(bytes))
    }
}

/// The hashes of the files of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameProof {
    pub(super) image: FileHash,
    /// None if the sequence has no error maps.
    pub(super) error_map: Option<FileHash>,
}

impl FrameProof {
    /// The hashes of these files.
    pub(super) fn of(files: &EncodedFrame) -> FrameProof {
        FrameProof {
            image: FileHash::of(&files.image),
            error_map: files.error_map.as_deref().map(FileHash::of),
        }
    }
}
