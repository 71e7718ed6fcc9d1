//! The files of the frames of a folder: read, verified, and proven to be those that they were.

use super::encoded_pixels::EncodedPixels;
use super::file_names::{frame_name, map_name};
use super::folder::FrameFolder;
use super::format::FrameFormat;
use super::proof::{FileHash, FrameProof};
use super::record::FrameRecord;
use super::verify::{Expected, VerifyError};
use crate::render::EncodedFrame;

impl FrameFolder {
    /// Verifies that all files of a frame are there, whole, unchanged, and made from the inputs of the sequence.
    pub fn verify(&self, frame: u32) -> Result<FrameRecord, VerifyError> {
        let (image, record, _) = self.verified(frame)?;
        let maps = self.of_maps(frame, |name| {
            let (hash, ..) = self.verify_file(name, frame, FrameFormat::Exr)?;
            Ok(hash)
        })?;
        self.keep_proof(frame, FrameProof { image, maps });
        Ok(record)
    }

    /// The hash of a frame's file, its record and its pixels, verified; its maps are not looked at.
    pub(super) fn verified(
        &self,
        frame: u32,
    ) -> Result<(FileHash, FrameRecord, EncodedPixels), VerifyError> {
        let format = self.sequence().format;
        self.verify_file(&frame_name(frame, format), frame, format)
    }

    fn verify_file(
        &self,
        name: &str,
        frame: u32,
        format: FrameFormat,
    ) -> Result<(FileHash, FrameRecord, EncodedPixels), VerifyError> {
        let bytes = self.read(name, format)?;
        let expected = Expected {
            frame,
            format,
            sequence: self.sequence(),
        };
        let (record, pixels) = expected.verify(&bytes)?;
        Ok((FileHash::of(&bytes), record, pixels))
    }

    /// The bytes of the file of a frame or a map.
    fn read(&self, name: &str, format: FrameFormat) -> Result<Vec<u8>, VerifyError> {
        let folder = self.folder().map_err(VerifyError::unreadable)?;
        folder
            .read(name, self.max_file_bytes(format))
            .map_err(VerifyError::unreadable)
    }

    /// Proves that the files of a frame are, under their names and byte for byte, those that this process has verified
    /// or stored before; a frame that it has not is verified. So what changed or removed them meanwhile is found.
    pub fn prove(&self, frame: u32) -> Result<(), VerifyError> {
        let folder = self.folder().map_err(VerifyError::unreadable)?;
        folder.check_in_place().map_err(VerifyError::unreadable)?;
        let Some(proof) = self.proof(frame) else {
            return self.verify(frame).map(drop);
        };
        let now = FrameProof::of(&self.files(frame)?);
        if now.image != proof.image {
            Err(VerifyError::Altered)
        } else if now.maps != proof.maps {
            Err(VerifyError::ErrorMap(Box::new(VerifyError::Altered)))
        } else {
            Ok(())
        }
    }

    /// The bytes of the files of a frame and of its maps.
    pub fn files(&self, frame: u32) -> Result<EncodedFrame, VerifyError> {
        let format = self.sequence().format;
        let image = self.read(&frame_name(frame, format), format)?;
        let maps = self.of_maps(frame, |name| self.read(name, FrameFormat::Exr))?;
        Ok(EncodedFrame { image, maps })
    }

    /// What is done to the files of a frame's maps.
    fn of_maps<T>(
        &self,
        frame: u32,
        done: impl Fn(&str) -> Result<T, VerifyError>,
    ) -> Result<Vec<T>, VerifyError> {
        let maps = self.sequence().maps();
        let done = maps.map(|aov| done(&map_name(frame, aov)));
        let done: Result<_, _> = done.collect();
        done.map_err(|error| VerifyError::ErrorMap(Box::new(error)))
    }

    /// About the most bytes of memory that verifying a frame takes: its file, its pixels, and both made anew.
    pub fn memory_to_verify(&self) -> u64 {
        let largest = match self.sequence().maps().next() {
            Some(_) => FrameFormat::Exr,
            None => self.sequence().format,
        };
        4 * self.max_file_bytes(largest)
    }

    /// The most bytes that a file of this format may take.
    pub(super) fn max_file_bytes(&self, format: FrameFormat) -> u64 {
        let pixels = u64::from(self.sequence().width) * u64::from(self.sequence().height);
        let samples = 3 * format.bytes_per_channel() as u64 * pixels;
        samples + samples / 8 + (1 << 12)
    }
}
