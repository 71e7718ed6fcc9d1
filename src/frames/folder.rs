//! A folder of numbered frames, shared safely by processes: each frame is claimed by a lock, written beside its name
//! and renamed, so that a file under a frame's name is a whole frame or was changed from outside.

use super::file_names::{
    CACHE_FILE, CAMERAS_FILE, MAX_TEXT, SEQUENCE_FILE, SHEET_FILE, frame_name, is_own, is_written,
    map_name,
};
use super::folder_error::FolderError;
use super::proof::FrameProof;
use super::record::FrameRecord;
use super::sequence_record::SequenceRecord;
use crate::storage::{FileError, FileIdentity, Folder};
use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock};

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
            let text = self.sequence.to_text().map_err(io::Error::other);
            let text = text.and_then(|text| match text.len() as u64 > MAX_TEXT {
                true => Err(io::Error::other(
                    "more frames than a folder can record: split the path",
                )),
                false => Ok(text),
            });
            let text = text.map_err(|error| FileError::writing(&self.sequence_file(), error))?;
            folder.write_atomic(SEQUENCE_FILE, text.as_bytes())?;
        }
        *self.prepared_file() = folder.identity_of(SEQUENCE_FILE);
        Ok(())
    }

    fn prepared_file(&self) -> MutexGuard<'_, Option<FileIdentity>> {
        self.prepared_file.lock().expect("no holder panics")
    }

    /// Whether `sequence.ron` was replaced since `prepare`, by one of other frames.
    pub(super) fn sequence_was_replaced(&self, folder: &Folder) -> bool {
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

    /// The files of a frame's maps.
    pub fn maps_of(&self, frame: u32) -> impl Iterator<Item = PathBuf> {
        let maps = self.sequence.maps();
        maps.map(move |aov| self.path.join(map_name(frame, aov)))
    }

    /// The names of a frame's files.
    pub(super) fn names_of(&self, frame: u32) -> impl Iterator<Item = String> {
        let maps = self.sequence.maps().map(move |aov| map_name(frame, aov));
        std::iter::once(frame_name(frame, self.sequence.format)).chain(maps)
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

    /// Remembers what this process knows of the files of a frame.
    pub(super) fn keep_proof(&self, frame: u32, proof: FrameProof) {
        self.proofs
            .lock()
            .expect("no holder panics")
            .insert(frame, proof);
    }

    /// What this process knows of the files of a frame; none if it has neither verified nor stored them.
    pub(super) fn proof(&self, frame: u32) -> Option<FrameProof> {
        let proofs = self.proofs.lock().expect("no holder panics");
        proofs.get(&frame).cloned()
    }

    /// Whether verified frames are rendered again all the same.
    pub(super) fn force(&self) -> bool {
        self.force
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
