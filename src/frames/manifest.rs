//! `manifest.ron`: the records of all frames of a folder, with a table and a chart of their errors.

use super::folder::{FrameFolder, remove};
use super::record::FrameRecord;
use crate::storage::{PartFile, write_atomic};
use serde::Serialize;
use std::fs;
use std::io;
use std::time::Duration;

const FILE: &str = "manifest.ron";

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
        let there = fs::read_to_string(folder.path().join(FILE)).ok();
        there.is_some() && there == Manifest::of(folder).to_text().ok()
    }

    /// Writes `manifest.ron` and, if any frame has an error, `errors.csv` and `errors.svg`: the text that `chart`
    /// makes of the records, in the order of their frames. Otherwise, or without a text, there are no such files.
    ///
    /// Processes that do so at the same time take turns, each after its own frames: the last one has seen all of them.
    pub fn update(
        folder: &FrameFolder,
        chart: impl FnOnce(&[FrameRecord]) -> io::Result<Option<String>>,
    ) -> io::Result<()> {
        let file = folder.path().join(FILE);
        let _lock = PartFile::lock_with_timeout(&file, LOCK_TIMEOUT)?;
        Manifest::of(folder).write(folder, chart)
    }

    fn to_text(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::new()
            .struct_names(true)
            .depth_limit(2);
        ron::ser::to_string_pretty(self, pretty)
    }

    fn write(
        &self,
        folder: &FrameFolder,
        chart: impl FnOnce(&[FrameRecord]) -> io::Result<Option<String>>,
    ) -> io::Result<()> {
        let text = self.to_text().map_err(io::Error::other)?;
        write_atomic(&folder.path().join(FILE), text.as_bytes())?;
        let has_errors = self.frames.iter().any(|record| record.error.is_some());
        let table = has_errors.then(|| self.table());
        let drawn = if has_errors {
            chart(&self.frames)?
        } else {
            None
        };
        for (name, text) in [("errors.csv", table), ("errors.svg", drawn)] {
            let file = folder.path().join(name);
            match text {
                Some(text) => write_atomic(&file, text.as_bytes())?,
                None => remove(&file)?,
            }
        }
        Ok(())
    }

    /// The errors as comma-separated values, a row for each frame that has one.
    fn table(&self) -> String {
        let mut table = "frame,relMSE,low,high\n".to_owned();
        for record in &self.frames {
            if let Some(error) = record.error {
                let (y, low, high) = (error.rel_mse, error.low, error.high);
                table += &format!("{},{y:e},{low:e},{high:e}\n", record.frame);
            }
        }
        table
    }
}
