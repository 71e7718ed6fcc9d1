//! What is in a folder beside the frames of the sequence: files of somebody else, which are not replaced unasked, and
//! frames that are none of the sequence.

use super::file_names::{BESIDE_FRAMES, CACHE_FILE, SEQUENCE_FILE, frame_in, is_own};
use super::folder::FrameFolder;
use super::folder_error::FolderError;
use super::format::FrameFormat;
use super::record::FrameRecord;
use crate::storage::{FileError, Folder};
use std::collections::BTreeSet;

/// A file that is named like a frame and is none of the sequence.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Stray {
    /// The name of the file.
    pub name: String,
    /// Whether this program wrote it, by its metadata.
    pub is_own: bool,
}

impl FrameFolder {
    /// Refuses a folder with finished frames of another sequence, or with files of somebody else under the names of its
    /// own. Frames of this sequence that are damaged do not count: they are this program's to repair.
    pub fn check_unoccupied(&self) -> Result<(), FolderError> {
        let folder = match self.folder() {
            Err(error) if error.is_missing() => return Ok(()),
            folder => folder?,
        };
        // Whoever wrote it was allowed to.
        if self.has_its_sequence() {
            return Ok(());
        }
        let names: BTreeSet<String> = names(folder)?.into_iter().collect();
        let mut is_ours = false;
        let mut others = Vec::new();
        let mut foreign = Vec::new();
        for name in names.iter().filter(|name| frame_in(name).is_some()) {
            match record(folder, name) {
                Some(record) if self.is_current(&record) => is_ours = true,
                Some(record) => others.push((name, record)),
                None if folder.is_folder(name) => {}
                None if self.is_expected(name) => foreign.push(name),
                None => {}
            }
        }
        if let [(first, record), ..] = &others[..] {
            return Err(FolderError::Occupied {
                folder: self.path().to_owned(),
                count: others.len(),
                first: (*first).clone(),
                other_build: self
                    .differs_only_by_build(record)
                    .then(|| record.build.clone()),
            });
        }
        if folder.contains(CACHE_FILE) && self.has_another_sequence() {
            return Err(FolderError::OthersCache {
                file: folder.file(CACHE_FILE),
            });
        }
        let beside = BESIDE_FRAMES.iter().chain([&SEQUENCE_FILE]);
        let beside = beside.filter_map(|name| names.get(*name));
        foreign.extend(beside.filter(|name| !is_own(folder, name)));
        match foreign[..] {
            [first, ..] if !is_ours => Err(FolderError::Foreign {
                file: folder.file(first),
            }),
            _ => Ok(()),
        }
    }

    /// Whether a name is that of a file of the sequence's frames.
    fn is_expected(&self, name: &str) -> bool {
        let frame = frame_in(name).filter(|frame| *frame < self.sequence().frames);
        frame.is_some_and(|frame| self.names_of(frame).any(|own| own == name))
    }

    /// The files in the folder that look like frames or error maps but are none of the sequence, by name.
    pub fn strays(&self) -> Result<Vec<Stray>, FileError> {
        let folder = self.folder()?;
        let names = names(folder)?.into_iter();
        let strays = names.filter(|name| frame_in(name).is_some() && !self.is_expected(name));
        let mut strays: Vec<Stray> = strays
            .map(|name| Stray {
                is_own: record(folder, &name).is_some(),
                name,
            })
            .collect();
        strays.sort();
        Ok(strays)
    }

    /// Removes the strays that this program wrote, and returns their names.
    pub fn clean(&self) -> Result<Vec<String>, FileError> {
        let own = self.strays()?.into_iter().filter(|stray| stray.is_own);
        let removed = own.map(|Stray { name, .. }| self.folder()?.remove(&name).map(|()| name));
        removed.collect()
    }
}

/// The names in a folder; what of one is not UTF-8 is replaced, so that it is none of the program's own.
fn names(folder: &Folder) -> Result<Vec<String>, FileError> {
    let names = folder.names()?.into_iter();
    Ok(names
        .map(|name| name.to_string_lossy().into_owned())
        .collect())
}

/// The record in the metadata of a frame of any format; none if it is no frame.
fn record(folder: &Folder, name: &str) -> Option<FrameRecord> {
    let format = match name.rsplit_once('.')?.1 {
        "png" => FrameFormat::Png,
        "exr" => FrameFormat::Exr,
        _ => return None,
    };
    let metadata = format.read_metadata(folder.open_file(name).ok()?).ok()??;
    FrameRecord::from_text(&metadata)
}
