//! Pixels as a file stores them, and the note beside them.

/// Under this name a file's note is found in it.
pub(super) const NOTE: &str = "flythrough";

/// A picture as a file stores it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Picture {
    /// Columns.
    pub(super) width: u32,
    /// Rows.
    pub(super) height: u32,
    /// R, G, B by pixel, row by row from the top left, in the order of bytes of the file.
    pub(super) samples: Vec<u8>,
}

impl Picture {
    /// A hash of its size and its samples.
    pub(super) fn hash(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.width.to_le_bytes());
        hasher.update(&self.height.to_le_bytes());
        hasher.update(&self.samples);
        hasher.finalize()
    }
}

/// What is in a file.
pub(super) struct Contents {
    /// What the file says; none if it says nothing.
    pub(super) note: Option<String>,
    /// None if its size or its kind is not the one expected.
    pub(super) picture: Option<Picture>,
}
