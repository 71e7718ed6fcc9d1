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
