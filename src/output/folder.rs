use super::format::FrameFormat;
use crate::film::Film;
use crate::render::{FrameSink, SinkError};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The file beside the frames that says what they are.
const INFO_FILE: &str = "sequence.ron";

/// What all frames of a folder have in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Sequence")]
pub struct SequenceInfo {
    /// Frames per second of the video.
    pub fps: f64,
    /// How many frames the whole path has.
    pub frames: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The ending of the frames' names.
    pub extension: String,
    /// A hash of all that decides the frames: input files, settings, format, program version.
    pub fingerprint: String,
}

/// Why a folder cannot take frames.
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
    /// There are frames of something else.
    #[error(
        "{folder}: holds frames of another scene, path or settings; use another folder, or --force \
         to render over them",
        folder = .folder.display()
    )]
    OtherFrames {
        /// The folder.
        folder: PathBuf,
    },
}

/// A folder of numbered frames. A file with a frame's name is a whole frame: it was written under
/// another name first.
#[derive(Debug)]
pub struct FrameFolder {
    folder: PathBuf,
    format: FrameFormat,
    exposure: f32,
}

impl FrameFolder {
    /// Makes the folder and proves that it can be written. Refuses one that holds frames of
    /// something else, unless `force`. `exposure` in stops is applied to the frames kept.
    pub fn open(
        folder: &Path,
        format: FrameFormat,
        exposure: f32,
        info: &SequenceInfo,
        force: bool,
    ) -> Result<FrameFolder, FolderError> {
        let unwritable = |source| FolderError::Unwritable {
            folder: folder.to_owned(),
            source,
        };
        fs::create_dir_all(folder).map_err(unwritable)?;
        let frames = FrameFolder {
            folder: folder.to_owned(),
            format,
            exposure,
        };
        let there = fs::read_to_string(folder.join(INFO_FILE)).ok();
        let same = there
            .as_deref()
            .and_then(|text| ron::from_str(text).ok())
            .as_ref()
            == Some(info);
        if !same {
            if !force && frames.holds_frames().map_err(unwritable)? {
                return Err(FolderError::OtherFrames {
                    folder: folder.to_owned(),
                });
            }
            let pretty = ron::ser::PrettyConfig::new().struct_names(true);
            let text = ron::ser::to_string_pretty(info, pretty).map_err(io::Error::other);
            let write = text.and_then(|text| write_whole(&folder.join(INFO_FILE), text.as_bytes()));
            write.map_err(unwritable)?;
        }
        Ok(frames)
    }

    /// The file of a frame.
    pub fn file_of(&self, frame: u32) -> PathBuf {
        let extension = self.format.extension();
        self.folder.join(format!("frame_{frame:05}.{extension}"))
    }

    /// Whether a frame is there.
    pub fn has(&self, frame: u32) -> bool {
        self.file_of(frame).is_file()
    }

    fn holds_frames(&self) -> io::Result<bool> {
        for entry in fs::read_dir(&self.folder)? {
            if entry?.file_name().to_string_lossy().starts_with("frame_") {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

impl FrameSink for FrameFolder {
    fn encode(&self, mut film: Film) -> Result<Vec<u8>, SinkError> {
        if self.format != FrameFormat::Exr {
            film.expose(self.exposure);
        }
        Ok(self.format.encode(&film)?)
    }

    fn keep(&self, frame: u32, bytes: &[u8]) -> Result<(), SinkError> {
        let file = self.file_of(frame);
        write_whole(&file, bytes).map_err(|error| format!("{}: {error}", file.display()))?;
        Ok(())
    }
}

/// Writes a file so that it is there whole or not at all, even if the machine stops in between.
fn write_whole(file: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    // The process number keeps two programs that write one folder apart.
    let temporary = file.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
    let written = (|| {
        let mut out = fs::File::create(&temporary)?;
        out.write_all(bytes)?;
        out.sync_all()?;
        fs::rename(&temporary, file)
    })();
    if written.is_err() {
        // Nothing more can be done about a leftover than to try.
        let _ = fs::remove_file(&temporary);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(fingerprint: &str) -> SequenceInfo {
        SequenceInfo {
            fps: 25.0,
            frames: 3,
            width: 4,
            height: 2,
            extension: "png".to_owned(),
            fingerprint: fingerprint.to_owned(),
        }
    }

    fn open(folder: &Path, fingerprint: &str, force: bool) -> Result<FrameFolder, FolderError> {
        FrameFolder::open(folder, FrameFormat::Png, 0.0, &info(fingerprint), force)
    }

    #[test]
    fn frames_are_numbered_and_nothing_else_is_left() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path().join("deep/er");
        let frames = open(&folder, "a", false).expect("new");
        assert!(!frames.has(7));
        frames.keep(7, b"frame").expect("kept");
        frames.keep(123_456, b"frame").expect("kept");
        assert!(frames.has(7));
        let entries = fs::read_dir(&folder)
            .expect("there")
            .map(|e| e.expect("entry").file_name());
        let mut names: Vec<_> = entries.collect();
        names.sort();
        assert_eq!(
            names,
            ["frame_00007.png", "frame_123456.png", "sequence.ron"]
        );
    }

    #[test]
    fn refuses_frames_of_something_else_unless_forced() {
        let root = tempfile::tempdir().expect("a folder");
        open(root.path(), "a", false).expect("new");
        open(root.path(), "b", false)
            .expect("no frames yet")
            .keep(0, b"frame")
            .expect("kept");
        open(root.path(), "b", false).expect("the same again");
        assert!(matches!(
            open(root.path(), "c", false),
            Err(FolderError::OtherFrames { .. })
        ));
        open(root.path(), "c", true).expect("forced");
        open(root.path(), "c", false).expect("now its own");
    }

    #[test]
    fn a_frame_that_cannot_be_written_names_its_file() {
        let root = tempfile::tempdir().expect("a folder");
        let frames = open(root.path(), "a", false).expect("new");
        fs::create_dir(root.path().join("frame_00001.png")).expect("made");
        let error = frames
            .keep(1, b"frame")
            .expect_err("in the way")
            .to_string();
        assert!(error.contains("frame_00001.png"), "{error}");
        assert_eq!(fs::read_dir(root.path()).expect("there").count(), 2);
    }
}
