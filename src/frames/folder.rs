//! A folder of numbered frames, shared safely by processes: each frame is claimed by a lock, written beside its name
//! and renamed, so that a file under a frame's name is a whole frame or was changed from outside.

use super::encoded_pixels::EncodedPixels;
use super::format::FrameFormat;
use super::record::FrameRecord;
use super::sequence_record::SequenceRecord;
use super::verify::{Expected, VerifyError};
use crate::render::{Claim, EncodedFrame, FrameSink, RenderedFrame, SinkError};
use crate::storage::{PartFile, check_writable, remove_leftovers, write_atomic};
use std::collections::HashSet;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::SystemTime;
use thiserror::Error;

/// The file beside the frames that records the expected ones: format, size, input hashes.
const SEQUENCE_FILE: &str = "sequence.ron";

/// The contact sheet beside the frames.
const SHEET_FILE: &str = "sheet.png";

/// The table beside the frames that lists their cameras.
const CAMERAS_FILE: &str = "cameras.jsonl";

/// How the names of all files begin that are written to a folder.
const OWN_FILES: [&str; 9] = [
    "frame_",
    "error_",
    SEQUENCE_FILE,
    CAMERAS_FILE,
    "manifest.ron",
    "errors.",
    "estimate.ron",
    "irradiance.cache",
    SHEET_FILE,
];

/// Why a folder cannot be used.
#[derive(Debug, Error)]
pub enum FolderError {
    /// The folder cannot be made or written.
    #[error("{folder}: cannot be written: {source}", folder = .folder.display())]
    Unwritable {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The folder cannot be read.
    #[error("{folder}: cannot be read: {source}", folder = .folder.display())]
    Unreadable {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Its `sequence.ron` is missing or cannot be read.
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
}

/// A folder of the numbered frames of a sequence.
#[derive(Debug)]
pub struct FrameFolder {
    folder: PathBuf,
    sequence: SequenceRecord,
    /// Whether verified frames are rendered again all the same.
    force: bool,
    /// Which `sequence.ron` was there when the folder was prepared.
    prepared_file: OnceLock<Option<FileIdentity>>,
}

/// Tells a file from one that is put in its place: inode and time of the last change.
type FileIdentity = (u64, SystemTime);

/// The lock on a frame, with the right to write its files.
#[derive(Debug)]
pub struct FrameLock {
    image: PartFile,
    error_map: Option<PartFile>,
}

impl FrameFolder {
    /// A folder that exists or will, of the frames of a sequence.
    pub fn new(folder: &Path, sequence: SequenceRecord, force: bool) -> FrameFolder {
        FrameFolder {
            folder: folder.to_owned(),
            sequence,
            force,
            prepared_file: OnceLock::new(),
        }
    }

    /// A folder that exists, of the frames that its `sequence.ron` records.
    pub fn open(folder: &Path) -> Result<FrameFolder, FolderError> {
        let file = folder.join(SEQUENCE_FILE);
        let text = fs::read_to_string(&file).map_err(|error| error.to_string());
        let sequence = text.and_then(|text| SequenceRecord::from_text(&text));
        let sequence = sequence.map_err(|message| FolderError::NoSequence { file, message })?;
        Ok(FrameFolder::new(folder, sequence, false))
    }

    /// Makes the folder, checks that it can be written, writes `sequence.ron`, and removes what killed processes
    /// have left.
    pub fn prepare(&self) -> Result<(), FolderError> {
        let prepare = || {
            fs::create_dir_all(&self.folder)?;
            remove_leftovers(&self.folder, &OWN_FILES)?;
            let file = self.folder.join(SEQUENCE_FILE);
            if self.recorded().as_ref() == Some(&self.sequence) {
                return check_writable(&file);
            }
            let text = self.sequence.to_text().map_err(io::Error::other)?;
            write_atomic(&file, text.as_bytes())
        };
        prepare().map_err(|source| FolderError::Unwritable {
            folder: self.folder.clone(),
            source,
        })?;
        self.prepared_file.get_or_init(|| self.sequence_file());
        Ok(())
    }

    fn sequence_file(&self) -> Option<FileIdentity> {
        let file = fs::metadata(self.folder.join(SEQUENCE_FILE)).ok()?;
        Some((file.ino(), file.modified().ok()?))
    }

    /// Whether `sequence.ron` was replaced since `prepare`, by one of other frames.
    fn sequence_was_replaced(&self) -> bool {
        let prepared = self.prepared_file.get();
        prepared.is_some_and(|file| *file != self.sequence_file()) && self.has_another_sequence()
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

    fn recorded(&self) -> Option<SequenceRecord> {
        let text = fs::read_to_string(self.folder.join(SEQUENCE_FILE)).ok()?;
        SequenceRecord::from_text(&text).ok()
    }

    /// Writes the table of the frames' cameras beside them, if it is not there.
    pub fn write_camera_table(&self, table: &str) -> io::Result<()> {
        let file = self.folder.join(CAMERAS_FILE);
        match fs::read(&file) {
            Ok(there) if there == table.as_bytes() => Ok(()),
            _ => write_atomic(&file, table.as_bytes()),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// The expected frames: format, size, input hashes.
    pub fn sequence(&self) -> &SequenceRecord {
        &self.sequence
    }

    /// The file of a frame.
    pub fn file_of(&self, frame: u32) -> PathBuf {
        let extension = self.sequence.format.extension();
        self.folder.join(format!("frame_{frame:05}.{extension}"))
    }

    /// The file of a frame's error map.
    pub fn map_of(&self, frame: u32) -> PathBuf {
        self.folder.join(format!("error_{frame:05}.exr"))
    }

    /// The file of the contact sheet.
    pub fn sheet(&self) -> PathBuf {
        self.folder.join(SHEET_FILE)
    }

    /// Whether a file has a name that the folder keeps for its own files, other than the contact sheet.
    pub fn is_reserved(&self, file: &Path) -> bool {
        let parent = file.parent().filter(|parent| *parent != Path::new(""));
        let parent = fs::canonicalize(parent.unwrap_or(Path::new(".")));
        let is_here = parent.is_ok_and(|p| fs::canonicalize(&self.folder).is_ok_and(|f| f == p));
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let is_own = OWN_FILES.iter().any(|own| name.starts_with(own));
        is_here && is_own && name != SHEET_FILE
    }

    /// Verifies that all files of a frame are there, whole, unchanged, and made from the inputs of the sequence.
    pub fn verify(&self, frame: u32) -> Result<FrameRecord, VerifyError> {
        let (record, _) = self.verified(frame)?;
        if self.sequence.error_maps {
            let map = self.verify_file(&self.map_of(frame), frame, FrameFormat::Exr);
            map.map_err(|error| VerifyError::ErrorMap(Box::new(error)))?;
        }
        Ok(record)
    }

    /// The record and the pixels of a frame, verified; its error map is not looked at.
    pub(super) fn verified(&self, frame: u32) -> Result<(FrameRecord, EncodedPixels), VerifyError> {
        self.verify_file(&self.file_of(frame), frame, self.sequence.format)
    }

    fn verify_file(
        &self,
        file: &Path,
        frame: u32,
        format: FrameFormat,
    ) -> Result<(FrameRecord, EncodedPixels), VerifyError> {
        let bytes = fs::read(file).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => VerifyError::Missing,
            _ => VerifyError::Unreadable(error),
        })?;
        let expected = Expected {
            frame,
            format,
            sequence: &self.sequence,
        };
        expected.verify(&bytes)
    }

    /// The record in the metadata of a frame's file, not verified; none if there is no such file, or it has no record
    /// or that of another frame.
    pub fn record(&self, frame: u32) -> Option<FrameRecord> {
        let file = self.file_of(frame);
        let metadata = self.sequence.format.read_metadata(&file).ok().flatten()?;
        FrameRecord::from_text(&metadata).filter(|record| record.frame == frame)
    }

    /// As [`FrameFolder::record`]; none if the record has other inputs or another build. Only the record is read:
    /// [`FrameFolder::verify`] reads the pixels, too.
    pub fn current_record(&self, frame: u32) -> Option<FrameRecord> {
        self.record(frame).filter(|record| {
            record.input_hash == self.sequence.input_hashes[frame as usize]
                && self.sequence.accepts(&record.build)
        })
    }

    /// The names in the folder that look like frames but are none of the sequence, in order.
    pub fn strays(&self) -> Result<Vec<String>, FolderError> {
        let files = (0..self.sequence.frames).map(|frame| self.file_of(frame));
        let own: HashSet<PathBuf> = files.collect();
        let strays = || -> io::Result<Vec<String>> {
            let mut strays = Vec::new();
            for entry in fs::read_dir(&self.folder)? {
                let entry = entry?;
                let name = entry.file_name().to_string_lossy().into_owned();
                if name.starts_with("frame_") && !own.contains(&entry.path()) {
                    strays.push(name);
                }
            }
            strays.sort();
            Ok(strays)
        };
        strays().map_err(|source| FolderError::Unreadable {
            folder: self.folder.clone(),
            source,
        })
    }

    /// Brings the names of all files to the disk, where the file system knows how. What is in them was brought there
    /// before they had their names.
    pub fn sync(&self) {
        // A name that is lost is a missing frame: it is found and rendered again.
        let _ = File::open(&self.folder).and_then(|folder| folder.sync_all());
    }

    /// The most bytes that a file of this format may take.
    fn max_file_bytes(&self, format: FrameFormat) -> u64 {
        let pixels = u64::from(self.sequence.width) * u64::from(self.sequence.height);
        let samples = 3 * format.bytes_per_channel() as u64 * pixels;
        samples + samples / 8 + (1 << 12)
    }
}

impl FrameSink for FrameFolder {
    type Lock = FrameLock;

    fn claim(&self, frame: u32, ignore_lock: bool) -> Result<Claim<FrameLock>, SinkError> {
        if self.sequence_was_replaced() {
            let folder = self.folder.display();
            return Err(format!(
                "{folder}: another process renders another sequence here; use two folders"
            )
            .into());
        }
        let named = |file: &Path, error| format!("{}: cannot be written: {error}", file.display());
        // A frame that does not fit on the disk need not be rendered.
        let with_room =
            |part: PartFile, format| part.reserve(self.max_file_bytes(format)).map(|()| part);
        let file = self.file_of(frame);
        let part = match ignore_lock {
            true => PartFile::create_unique(&file).map(Some),
            false => PartFile::claim(&file),
        };
        let Some(part) = part.map_err(|error| named(&file, error))? else {
            return Ok(Claim::Busy);
        };
        let image = with_room(part, self.sequence.format).map_err(|error| named(&file, error))?;
        if !self.force && self.verify(frame).is_ok() {
            return Ok(Claim::AlreadyStored);
        }
        let mut error_map = None;
        if self.sequence.error_maps {
            let file = self.map_of(frame);
            // The lock of the frame covers its map.
            let part =
                PartFile::create_unique(&file).and_then(|part| with_room(part, FrameFormat::Exr));
            error_map = Some(part.map_err(|error| named(&file, error))?);
        }
        Ok(Claim::Granted(FrameLock { image, error_map }))
    }

    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        self.sequence.encode(frame, rendered)
    }

    fn store(&self, frame: u32, lock: FrameLock, encoded: &EncodedFrame) -> Result<(), SinkError> {
        let store = |file: PathBuf, part: PartFile, bytes: &[u8]| {
            let written = part.finish(bytes);
            written.map_err(|error| format!("{}: cannot be written: {error}", file.display()))
        };
        // The frame comes last: where it is, its map is.
        match (&encoded.error_map, lock.error_map) {
            (Some(map), Some(part)) => store(self.map_of(frame), part, map)?,
            _ => remove(&self.map_of(frame))?,
        }
        Ok(store(self.file_of(frame), lock.image, &encoded.image)?)
    }
}

/// Removes a file, if it is there.
pub(super) fn remove(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
