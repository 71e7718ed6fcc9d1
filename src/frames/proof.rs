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
#[derive(Clone, Debug)]
pub(super) struct FrameProof {
    pub(super) image: FileHash,
    /// Of its maps, in the order of the sequence's.
    pub(super) maps: Vec<FileHash>,
}

impl FrameProof {
    /// The hashes of these files.
    pub(super) fn of(files: &EncodedFrame) -> FrameProof {
        FrameProof {
            image: FileHash::of(&files.image),
            maps: files.maps.iter().map(|map| FileHash::of(map)).collect(),
        }
    }
}
