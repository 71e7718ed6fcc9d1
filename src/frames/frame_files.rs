//! The files of the frames of a folder: read, verified, and proven to be those that they were.

use super::encoded_pixels::EncodedPixels;
use super::file_names::{error_map_name, frame_name};
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
        let error_map = self.of_error_map(|| {
            let (hash, ..) = self.verify_file(&error_map_name(frame), frame, FrameFormat::Exr)?;
            Ok(hash)
        })?;
        self.keep_proof(frame, FrameProof { image, error_map });
        Ok(record)
    }

    /// The hash of a frame's file, its record and its pixels, verified; its error map is not looked at.
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

    /// The bytes of the file of a frame or an error map.
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
        } else if now.error_map != proof.error_map {
            Err(VerifyError::ErrorMap(Box::new(VerifyError::Altered)))
        } else {
            Ok(())
        }
    }

    /// The bytes of the files of a frame, and of its error map if the sequence has one.
    pub fn files(&self, frame: u32) -> Result<EncodedFrame, VerifyError> {
        let format = self.sequence().format;
        let image = self.read(&frame_name(frame, format), format)?;
        let error_map =
            self.of_error_map(|| self.read(&error_map_name(frame), FrameFormat::Exr))?;
        Ok(EncodedFrame { image, error_map })
    }

    /// What is done to a frame's error map; none if the sequence has none.
    fn of_error_map<T>(
        &self,
        done: impl FnOnce() -> Result<T, VerifyError>,
    ) -> Result<Option<T>, VerifyError> {
        let done = self.sequence().error_maps.then(done).transpose();
        done.map_err(|error| VerifyError::ErrorMap(Box::new(error)))
    }

    /// About the most bytes of memory that verifying a frame takes: its file, its pixels, and both made anew.
    pub fn memory_to_verify(&self) -> u64 {
        let largest = match self.sequence().error_maps {
            true => FrameFormat::Exr,
            false => self.sequence().format,
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
