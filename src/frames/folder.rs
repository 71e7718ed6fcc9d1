//! A folder of numbered frames, shared safely by processes: each frame is claimed by a lock, written beside its name
//! and renamed, so that a file under a frame's name is a whole frame or was changed from outside.

use super::encoded_pixels::EncodedPixels;
use super::file_names::{
    CACHE_FILE, CAMERAS_FILE, MAX_TEXT, SEQUENCE_FILE, SHEET_FILE, error_map_name, frame_name,
    is_own, is_written,
};
use super::format::FrameFormat;
use super::proof::{FileHash, FrameProof};
use super::record::FrameRecord;
use super::sequence_record::SequenceRecord;
use super::verify::{Expected, VerifyError};
use crate::render::{Claim, EncodedFrame, FrameSink, RenderedFrame, SinkError};
use crate::storage::{FileError, FileIdentity, FileLock, Folder, PartFile};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock};
use thiserror::Error;

/// Why a folder cannot be used.
#[derive(Debug, Error)]
pub enum FolderError {
    /// A file of it cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Its `sequence.ron` is missing or cannot be understood.
    #[error(
        "{file}: {message}: not a folder of frames, or the file is lost or damaged; render the sequence (again): \
         verified frames are kept",
        file = .file.display()
    )]
    NoSequence {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// It has finished frames of another sequence.
    #[error(
        "{folder}: finished frames of {sequence} are there, {count} in number, {first} the first: use another folder, \
         or --replace to render in their place{accept}",
        folder = .folder.display(),
        sequence = match .other_build {
            Some(_) => "another build of the program",
            None => "another scene or path",
        },
        accept = match .other_build {
            Some(build) => format!(", or --accept-build {build} to keep them"),
            None => String::new(),
        }
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
        /// How many.
        count: usize,
        /// The name of the first.
        first: String,
        /// The build of the first, if nothing else differs.
        other_build: Option<String>,
    },
    /// It has the irradiance cache of another sequence, whose frames are not there yet.
    #[error(
        "{file}: is the irradiance cache of another scene or path: use another folder, or --replace to bake over it",
        file = .file.display()
    )]
    OthersCache {
        /// The file.
        file: PathBuf,
    },
    /// It has a file under the name of one of its own that the program did not write.
    #[error(
        "{file}: is there already, and flythrough did not write it: use another folder, or --replace to write over it",
        file = .file.display()
    )]
    Foreign {
        /// The file.
        file: PathBuf,
    },
}

/// A folder of the numbered frames of a sequence.
#[derive(Debug)]
pub struct FrameFolder {
    path: PathBuf,
    sequence: SequenceRecord,
    /// Whether verified frames are rendered again all the same.
    force: bool,
    /// The folder, since it was first there.
    opened: OnceLock<Folder>,
    /// Which `sequence.ron` was there when the folder was prepared.
    prepared_file: Mutex<Option<FileIdentity>>,
    /// What was verified or stored by this process.
    proofs: Mutex<HashMap<u32, FrameProof>>,
}

/// The lock on a frame, with the right to write its files.
#[derive(Debug)]
pub struct FrameLock {
    image: PartFile,
    error_map: Option<PartFile>,
    _lock: Option<FileLock>,
}

impl FrameFolder {
    /// A folder that exists or will, of the frames of a sequence.
    pub fn new(path: &Path, sequence: SequenceRecord, force: bool) -> FrameFolder {
        FrameFolder {
            path: path.to_owned(),
            sequence,
            force,
            opened: OnceLock::new(),
            prepared_file: Mutex::default(),
            proofs: Mutex::default(),
        }
    }

    /// A folder that exists, of the frames that its `sequence.ron` records.
    pub fn open(path: &Path) -> Result<FrameFolder, FolderError> {
        let text = Folder::open(path).and_then(|folder| folder.read_text(SEQUENCE_FILE, MAX_TEXT));
        let no_sequence = |message| FolderError::NoSequence {
            file: path.join(SEQUENCE_FILE),
            message,
        };
        let text = text.map_err(|error| match error.is_missing() {
            true => no_sequence(error.source.to_string()),
            false => error.into(),
        })?;
        let sequence = SequenceRecord::from_text(&text).map_err(no_sequence)?;
        Ok(FrameFolder::new(path, sequence, false))
    }

    /// The open folder; an error if it is not there yet.
    pub(super) fn folder(&self) -> Result<&Folder, FileError> {
        match self.opened.get() {
            Some(folder) => Ok(folder),
            None => {
                let folder = Folder::open(&self.path)?;
                Ok(self.opened.get_or_init(|| folder))
            }
        }
    }

    /// Makes the folder, checks that it can be written, writes `sequence.ron`, and removes what killed processes
    /// have left. Whatever is there may be written over: see [`FrameFolder::check_unoccupied`].
    pub fn prepare(&self) -> Result<(), FolderError> {
        let created = Folder::create(&self.path)?;
        let folder = self.opened.get_or_init(|| created);
        folder.remove_leftovers(is_written)?;
        if self.recorded().as_ref() == Some(&self.sequence) {
            drop(folder.part_file(SEQUENCE_FILE)?);
        } else {
            let text = self.sequence.to_text();
            let text = text.map_err(|error| {
                FileError::writing(&folder.file(SEQUENCE_FILE), std::io::Error::other(error))
            })?;
            if text.len() as u64 > MAX_TEXT {
                let why = "more frames than a folder can record: split the path";
                return Err(FileError::writing(
                    &folder.file(SEQUENCE_FILE),
                    std::io::Error::other(why),
                )
                .into());
            }
            folder.write_atomic(SEQUENCE_FILE, text.as_bytes())?;
        }
        *self.prepared_file() = folder.identity_of(SEQUENCE_FILE);
        Ok(())
    }

    fn prepared_file(&self) -> MutexGuard<'_, Option<FileIdentity>> {
        self.prepared_file.lock().expect("no holder panics")
    }

    /// Whether `sequence.ron` was replaced since `prepare`, by one of other frames.
    fn sequence_was_replaced(&self, folder: &Folder) -> bool {
        let now = folder.identity_of(SEQUENCE_FILE);
        let mut prepared = self.prepared_file();
        if prepared.is_none() || *prepared == now {
            return false;
        }
        if self.has_another_sequence() {
            return true;
        }
        // It need not be read again.
        *prepared = now.or(*prepared);
        false
    }

    /// Whether `sequence.ron` is of the frames of this sequence, from the same builds.
    pub fn has_its_sequence(&self) -> bool {
        self.recorded().is_some_and(|there| {
            there.has_the_frames_of(&self.sequence)
                && there.accepted_builds == self.sequence.accepted_builds
        })
    }

    /// Whether `sequence.ron` is of other frames.
    pub fn has_another_sequence(&self) -> bool {
        let there = self.recorded();
        there.is_some_and(|there| !there.has_the_frames_of(&self.sequence))
    }

    /// Whether `sequence.ron` is of these frames, from whichever builds.
    pub fn is_recorded(&self) -> bool {
        let there = self.recorded();
        there.is_some_and(|there| there.has_the_frames_of(&self.sequence))
    }

    fn recorded(&self) -> Option<SequenceRecord> {
        let text = self
            .folder()
            .ok()?
            .read_text(SEQUENCE_FILE, MAX_TEXT)
            .ok()?;
        SequenceRecord::from_text(&text).ok()
    }

    /// Writes the table of the frames' cameras beside them, if it is not there.
    pub fn write_camera_table(&self, table: &str) -> Result<(), FileError> {
        let folder = self.folder()?;
        match folder.read(CAMERAS_FILE, MAX_TEXT) {
            Ok(there) if there == table.as_bytes() => Ok(()),
            _ => folder.write_atomic(CAMERAS_FILE, table.as_bytes()),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The expected frames: format, size, input hashes.
    pub fn sequence(&self) -> &SequenceRecord {
        &self.sequence
    }

    /// The file that records the expected frames.
    pub fn sequence_file(&self) -> PathBuf {
        self.path.join(SEQUENCE_FILE)
    }

    /// The file of a frame.
    pub fn file_of(&self, frame: u32) -> PathBuf {
        self.path.join(frame_name(frame, self.sequence.format))
    }

    /// The file of a frame's error map.
    pub fn map_of(&self, frame: u32) -> PathBuf {
        self.path.join(error_map_name(frame))
    }

    /// The names of a frame's files.
    pub(super) fn names_of(&self, frame: u32) -> impl Iterator<Item = String> {
        let error_map = self.sequence.error_maps.then(|| error_map_name(frame));
        std::iter::once(frame_name(frame, self.sequence.format)).chain(error_map)
    }

    /// The file of the contact sheet.
    pub fn sheet(&self) -> PathBuf {
        self.path.join(SHEET_FILE)
    }

    /// Whether the file of the contact sheet is one that the program drew.
    pub fn has_its_sheet(&self) -> bool {
        let folder = self.folder();
        folder.is_ok_and(|folder| is_own(folder, SHEET_FILE))
    }

    /// Removes the contact sheet: it may show other frames.
    pub fn remove_sheet(&self) -> Result<(), FileError> {
        match self.has_its_sheet() {
            true => self.folder()?.remove(SHEET_FILE),
            false => Ok(()),
        }
    }

    /// Whether a file has a name that the folder keeps for its own files, other than the contact sheet.
    pub fn is_reserved(&self, file: &Path) -> bool {
        is_written_to(&self.path, file).is_some_and(|name| name != SHEET_FILE)
    }

    /// Whether a file is the contact sheet, however it is named.
    pub fn is_sheet(&self, file: &Path) -> bool {
        is_written_to(&self.path, file).is_some_and(|name| name == SHEET_FILE)
    }

    /// Verifies that all files of a frame are there, whole, unchanged, and made from the inputs of the sequence.
    pub fn verify(&self, frame: u32) -> Result<FrameRecord, VerifyError> {
        let (image, record, _) = self.verified(frame)?;
        let mut error_map = None;
        if self.sequence.error_maps {
            let map = self.verify_file(&error_map_name(frame), frame, FrameFormat::Exr);
            let (hash, ..) = map.map_err(|error| VerifyError::ErrorMap(Box::new(error)))?;
            error_map = Some(hash);
        }
        self.keep_proof(frame, FrameProof { image, error_map });
        Ok(record)
    }

    /// The hash of a frame's file, its record and its pixels, verified; its error map is not looked at.
    pub(super) fn verified(
        &self,
        frame: u32,
    ) -> Result<(FileHash, FrameRecord, EncodedPixels), VerifyError> {
        let format = self.sequence.format;
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
            sequence: &self.sequence,
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

    fn keep_proof(&self, frame: u32, proof: FrameProof) {
        self.proofs
            .lock()
            .expect("no holder panics")
            .insert(frame, proof);
    }

    /// Proves that the files of a frame are, under their names and byte for byte, those that this process has verified
    /// or stored before; a frame that it has not is verified. So what changed or removed them meanwhile is found.
    pub fn prove(&self, frame: u32) -> Result<(), VerifyError> {
        let folder = self.folder().map_err(VerifyError::unreadable)?;
        folder.check_in_place().map_err(VerifyError::unreadable)?;
        let proof = self
            .proofs
            .lock()
            .expect("no holder panics")
            .get(&frame)
            .copied();
        let Some(FrameProof { image, error_map }) = proof else {
            return self.verify(frame).map(drop);
        };
        let unchanged =
            |name: &str, format, hash| match FileHash::of(&self.read(name, format)?) == hash {
                true => Ok(()),
                false => Err(VerifyError::Altered),
            };
        unchanged(
            &frame_name(frame, self.sequence.format),
            self.sequence.format,
            image,
        )?;
        let error_map =
            error_map.map(|hash| unchanged(&error_map_name(frame), FrameFormat::Exr, hash));
        error_map
            .unwrap_or(Ok(()))
            .map_err(|error| VerifyError::ErrorMap(Box::new(error)))
    }

    /// The bytes of the files of a frame, and of its error map if the sequence has one.
    pub fn files(&self, frame: u32) -> Result<EncodedFrame, VerifyError> {
        let image = self.read(
            &frame_name(frame, self.sequence.format),
            self.sequence.format,
        )?;
        let error_map = self
            .sequence
            .error_maps
            .then(|| self.read(&error_map_name(frame), FrameFormat::Exr));
        Ok(EncodedFrame {
            image,
            error_map: error_map.transpose()?,
        })
    }

    /// The record in the metadata of a frame's file, not verified; none if there is no such file, or it has no record
    /// or that of another frame.
    pub fn record(&self, frame: u32) -> Option<FrameRecord> {
        let format = self.sequence.format;
        let file = self
            .folder()
            .ok()?
            .open_file(frame_name(frame, format))
            .ok()?;
        let metadata = format.read_metadata(file).ok().flatten()?;
        FrameRecord::from_text(&metadata).filter(|record| record.frame == frame)
    }

    /// As [`FrameFolder::record`]; none if the record has other inputs or another build. Only the record is read:
    /// [`FrameFolder::verify`] reads the pixels, too.
    pub fn current_record(&self, frame: u32) -> Option<FrameRecord> {
        self.record(frame).filter(|record| self.is_current(record))
    }

    /// Whether a record is of a frame of this sequence.
    pub(super) fn is_current(&self, record: &FrameRecord) -> bool {
        self.has_its_inputs(record) && self.sequence.accepts(&record.build)
    }

    /// Whether a frame was made from the inputs of this sequence, but by a build that is not accepted.
    pub(super) fn differs_only_by_build(&self, record: &FrameRecord) -> bool {
        self.has_its_inputs(record) && !self.sequence.accepts(&record.build)
    }

    fn has_its_inputs(&self, record: &FrameRecord) -> bool {
        let expected = self.sequence.input_hashes.get(record.frame as usize);
        expected == Some(&record.input_hash)
    }

    /// Brings the names of all files to the disk, where the file system knows how. What is in them was brought there
    /// before they had their names.
    pub fn sync(&self) {
        // A name that is lost is a missing frame: it is found and rendered again.
        let _ = self.folder().map(Folder::sync);
    }

    /// About the most bytes of memory that verifying a frame takes: its file, its pixels, and both made anew.
    pub fn memory_to_verify(&self) -> u64 {
        4 * self.max_file_bytes(self.sequence.format)
    }

    /// The most bytes that a file of this format may take.
    fn max_file_bytes(&self, format: FrameFormat) -> u64 {
        let pixels = u64::from(self.sequence.width) * u64::from(self.sequence.height);
        let samples = 3 * format.bytes_per_channel() as u64 * pixels;
        samples + samples / 8 + (1 << 12)
    }
}

/// Whether a file has a name that a folder of frames keeps for its own files, other than the irradiance cache.
pub fn is_name_of_frames(folder: &Path, file: &Path) -> bool {
    is_written_to(folder, file).is_some_and(|name| name != CACHE_FILE)
}

/// The name of a file that is written to a folder of frames; none of others.
fn is_written_to(folder: &Path, file: &Path) -> Option<String> {
    let parent = file.parent().filter(|parent| *parent != Path::new(""));
    let parent = fs::canonicalize(parent.unwrap_or(Path::new("."))).ok()?;
    let name = file.file_name()?.to_string_lossy().into_owned();
    (fs::canonicalize(folder).ok()? == parent && is_written(&name)).then_some(name)
}

impl FrameSink for FrameFolder {
    type Lock = FrameLock;

    fn claim(&self, frame: u32, ignore_lock: bool) -> Result<Claim<FrameLock>, SinkError> {
        let name = frame_name(frame, self.sequence.format);
        let folder = self.folder()?;
        folder
            .check_in_place()
            .map_err(|error| FileError::writing(&folder.file(&name), error.source))?;
        if self.sequence_was_replaced(folder) {
            let folder = self.path.display();
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
        if !self.force && self.verify(frame).is_ok() {
            return Ok(Claim::AlreadyStored);
        }
        // A frame that does not fit on the disk need not be rendered.
        let with_room = |name: &str, format| {
            let part = folder.part_file(name)?;
            part.reserve(self.max_file_bytes(format))?;
            Ok::<_, FileError>(part)
        };
        let error_map = self
            .sequence
            .error_maps
            .then(|| with_room(&error_map_name(frame), FrameFormat::Exr));
        Ok(Claim::Granted(FrameLock {
            image: with_room(&name, self.sequence.format)?,
            error_map: error_map.transpose()?,
            _lock: lock,
        }))
    }

    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        self.sequence.encode(frame, rendered)
    }

    fn store(&self, frame: u32, lock: FrameLock, encoded: &EncodedFrame) -> Result<(), SinkError> {
        // The frame comes last: where it is, its map is.
        let hash = |bytes: &Vec<u8>| FileHash::of(bytes);
        if let (Some(map), Some(part)) = (&encoded.error_map, lock.error_map) {
            part.finish(map)?;
        }
        lock.image.finish(&encoded.image)?;
        let proof = FrameProof {
            image: hash(&encoded.image),
            error_map: encoded.error_map.as_ref().map(hash),
        };
        self.keep_proof(frame, proof);
        Ok(())
    }
}
