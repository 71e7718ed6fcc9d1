//! Pixels as a file stores them, and the metadata beside them.

/// The keyword of the PNG text chunk, and the name of the EXR attribute, that holds a file's metadata.
pub(super) const METADATA_KEY: &str = "flythrough";

/// The metadata of a frame stands within so many bytes from the beginning of its file.
pub(super) const METADATA_WITHIN: u64 = 1 << 20;

/// The pixels of an image as a file stores them.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct EncodedPixels {
    /// Columns.
    pub(super) width: u32,
    /// Rows.
    pub(super) height: u32,
    /// R, G, B by pixel, row by row from the top left, in the order of bytes of the file.
    pub(super) samples: Vec<u8>,
}

impl EncodedPixels {
    /// A hash of size and samples.
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
    /// The text under [`METADATA_KEY`]; none if there is none.
    pub(super) metadata: Option<String>,
    /// None if its size or its kind is not the one expected.
    pub(super) pixels: Option<EncodedPixels>,
}
