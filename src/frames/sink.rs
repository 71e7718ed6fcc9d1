//! Stores rendered frames in a folder that processes share: each frame is locked, reserved, written and renamed.

use super::file_names::{frame_name, map_name};
use super::folder::FrameFolder;
use super::format::FrameFormat;
use super::proof::FrameProof;
use crate::render::{Claim, EncodedFrame, FrameSink, RenderedFrame, SinkError};
use crate::storage::{FileError, FileLock, PartFile};

/// The lock on a frame, with the right to write its files.
#[derive(Debug)]
pub struct FrameLock {
    image: PartFile,
    maps: Vec<PartFile>,
    _lock: Option<FileLock>,
}

impl FrameSink for FrameFolder {
    type Lock = FrameLock;

    fn claim(&self, frame: u32, ignore_lock: bool) -> Result<Claim<FrameLock>, SinkError> {
        let name = frame_name(frame, self.sequence().format);
        let folder = self.folder()?;
        folder
            .check_in_place()
            .map_err(|error| FileError::writing(&folder.file(&name), error.source))?;
        if self.sequence_was_replaced(folder) {
            let folder = self.path().display();
            return Err(format!(
                "{folder}: another process renders another sequence here; use two folders"
            )
            .into());
        }
        let lock = match ignore_lock {
            true => None,
            false => match folder.lock(&name)? {
                None => return Ok(Claim::Busy),
                lock => lock,
            },
        };
        if !self.force() && self.verify(frame).is_ok() {
            return Ok(Claim::AlreadyStored);
        }
        // A frame that does not fit on the disk need not be rendered.
        let with_room = |name: &str, format| {
            let part = folder.part_file(name)?;
            part.reserve(self.max_file_bytes(format))?;
            Ok::<_, FileError>(part)
        };
        let maps = self.sequence().maps();
        let maps = maps.map(|aov| with_room(&map_name(frame, aov), FrameFormat::Exr));
        Ok(Claim::Granted(FrameLock {
            image: with_room(&name, self.sequence().format)?,
            maps: maps.collect::<Result<_, _>>()?,
            _lock: lock,
        }))
    }

    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        self.sequence().encode(frame, rendered)
    }

    fn store(&self, frame: u32, lock: FrameLock, encoded: &EncodedFrame) -> Result<(), SinkError> {
        // The frame comes last: where it is, its maps are.
        for (map, part) in encoded.maps.iter().zip(lock.maps) {
            part.finish(map)?;
        }
        lock.image.finish(&encoded.image)?;
        self.keep_proof(frame, FrameProof::of(encoded));
        Ok(())
    }
}
