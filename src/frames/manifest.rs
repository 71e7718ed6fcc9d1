//! `manifest.ron`: the records of all frames of a folder, with a table and a chart of their errors.

use super::file_names::{
    ERROR_CHART, ERROR_TABLE, ERROR_TABLE_HEADER, MANIFEST_FILE, MAX_TEXT, is_own,
};
use super::folder::FrameFolder;
use super::record::{FrameError, FrameRecord};
use crate::storage::{FileError, Folder, WaitListener};
use serde::Serialize;
use std::io;
use std::time::Duration;

/// How long to wait for another process that writes the manifest.
const LOCK_TIMEOUT: Duration = Duration::from_secs(60);

/// The records of the frames of a folder, by number.
#[derive(Debug, Serialize)]
pub struct Manifest {
    frames: Vec<FrameRecord>,
}

impl Manifest {
    /// Reads the record of each frame that is there. The manifest is made of the frames alone: it does not
    /// depend on which processes rendered them, and can be lost.
    fn of(folder: &FrameFolder) -> Manifest {
        let frames = (0..folder.sequence().frames).filter_map(|frame| folder.record(frame));
        Manifest {
            frames: frames.collect(),
        }
    }

    /// Whether the manifest is there and agrees with the frames.
    pub fn is_current(folder: &FrameFolder) -> bool {
        let there = folder
            .folder()
            .and_then(|folder| folder.read_text(MANIFEST_FILE, MAX_TEXT))
            .ok();
        there.is_some() && there == Manifest::of(folder).to_text().ok()
    }

    /// Writes `manifest.ron` and, if there are frames, `errors.csv` and `errors.svg`: the text that `chart` makes of the
    /// records, in the order of their frames. Without a text there is no such file.
    ///
    /// Processes that do so at the same time take turns, each after its own frames: the last one has seen all of them.
    /// The listener hears of a process that is waited for.
    pub fn update(
        folder: &FrameFolder,
        chart: impl FnOnce(&[FrameRecord]) -> io::Result<Option<String>>,
        listener: WaitListener,
    ) -> Result<(), FileError> {
        let there = folder.folder()?;
        let _lock = there.lock_with_timeout(MANIFEST_FILE, LOCK_TIMEOUT, listener)?;
        Manifest::of(folder).write(there, chart)
    }

    fn to_text(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::new()
            .struct_names(true)
            .depth_limit(2);
        ron::ser::to_string_pretty(self, pretty)
    }

    fn write(
        &self,
        folder: &Folder,
        chart: impl FnOnce(&[FrameRecord]) -> io::Result<Option<String>>,
    ) -> Result<(), FileError> {
        let text = self.to_text().map_err(io::Error::other);
        let text = text.map_err(|error| FileError::writing(&folder.file(MANIFEST_FILE), error))?;
        folder.write_atomic(MANIFEST_FILE, text.as_bytes())?;
        if self.frames.is_empty() {
            return Ok(());
        }
        folder.write_atomic(ERROR_TABLE, self.table().as_bytes())?;
        let drawn = chart(&self.frames)
            .map_err(|error| FileError::writing(&folder.file(ERROR_CHART), error))?;
        match drawn {
            Some(text) => folder.write_atomic(ERROR_CHART, text.as_bytes()),
            // Of another build than this, which draws none.
            None if is_own(folder, ERROR_CHART) => folder.remove(ERROR_CHART),
            None => Ok(()),
        }
    }

    /// The errors as comma-separated values, a row for each frame.
    fn table(&self) -> String {
        let mut table = ERROR_TABLE_HEADER.to_owned();
        for record in &self.frames {
            let FrameError {
                rel_mse,
                low,
                high,
                worst_block,
                blurred,
            } = record.error;
            table += &format!(
                "{},{rel_mse:e},{low:e},{high:e},{worst_block:e},{blurred:e}\n",
                record.frame
            );
        }
        table
    }
}
