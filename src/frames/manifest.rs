//! `manifest.ron`: what the frames of a folder say of themselves, with a table and a picture of their errors.

use super::folder::{FrameFolder, remove};
use super::record::FrameRecord;
use crate::storage::{PartFile, write_atomic};
use serde::Serialize;
use std::fs;
use std::io;
use std::time::Duration;

const FILE: &str = "manifest.ron";

/// How long to wait for a turn.
const PATIENCE: Duration = Duration::from_secs(60);

/// What the frames of a folder say of themselves, by number.
#[derive(Debug, Serialize)]
pub struct Manifest {
    frames: Vec<FrameRecord>,
}

impl Manifest {
    /// Reads the record of each frame that is there. The manifest is made of the frames alone: it is right whichever
    /// processes rendered them, and can be lost.
    fn of(folder: &FrameFolder) -> Manifest {
        let frames = (0..folder.sequence().frames).filter_map(|frame| folder.record(frame));
        Manifest {
            frames: frames.collect(),
        }
    }

    /// Whether the manifest is there and agrees with the frames.
    pub fn is_right(folder: &FrameFolder) -> bool {
        let there = fs::read_to_string(folder.path().join(FILE)).ok();
        there.is_some() && there == Manifest::of(folder).to_text().ok()
    }

    /// Writes `manifest.ron` and, if any frame has an error, `errors.csv` and `errors.svg`: the text that `picture`
    /// makes of the records, in the order of their frames. Otherwise, or without a text, there are no such files.
    ///
    /// Processes that do so at the same time take turns, each after its own frames: the last one has seen all of them.
    pub fn update(
        folder: &FrameFolder,
        picture: impl FnOnce(&[FrameRecord]) -> io::Result<Option<String>>,
    ) -> io::Result<()> {
        let file = folder.path().join(FILE);
        let _turn = PartFile::claim_in_turn(&file, PATIENCE)?;
        Manifest::of(folder).write(folder, picture)
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
        picture: impl FnOnce(&[FrameRecord]) -> io::Result<Option<String>>,
    ) -> io::Result<()> {
        let text = self.to_text().map_err(io::Error::other)?;
        write_atomic(&folder.path().join(FILE), text.as_bytes())?;
        let has_errors = self.frames.iter().any(|record| record.error.is_some());
        let table = has_errors.then(|| self.table());
        let drawn = if has_errors {
            picture(&self.frames)?
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
                let (y, low, high) = (error.relative_square_error, error.low, error.high);
                table += &format!("{},{y:e},{low:e},{high:e}\n", record.frame);
            }
        }
        table
    }
}
