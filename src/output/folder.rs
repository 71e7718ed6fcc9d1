use super::exr_file;
use super::format::FrameFormat;
use super::record::FrameRecord;
use crate::film::Film;
use crate::render::{EncodedFrame, FrameSink, RenderedFrame, SinkError};
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
    storage: FrameStorage,
}

/// How frames are kept.
#[derive(Clone, Copy, Debug)]
pub struct FrameStorage {
    /// The format of their files.
    pub format: FrameFormat,
    /// Stops that are applied to what is stored for display.
    pub exposure: f32,
    /// Whether the error of every pixel is kept beside the frame.
    pub error_maps: bool,
}

impl FrameFolder {
    /// Makes the folder and proves that it can be written. Refuses one that holds frames of
    /// something else, unless `force`.
    pub fn open(
        folder: &Path,
        storage: FrameStorage,
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
            storage,
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

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// The file of a frame.
    pub fn file_of(&self, frame: u32) -> PathBuf {
        let extension = self.storage.format.extension();
        self.folder.join(format!("frame_{frame:05}.{extension}"))
    }

    /// Whether all that is kept of a frame is there.
    pub fn has(&self, frame: u32) -> bool {
        let has_map = || self.map_of(frame).is_file();
        self.file_of(frame).is_file() && (!self.storage.error_maps || has_map())
    }

    /// The file of a frame's error map.
    fn map_of(&self, frame: u32) -> PathBuf {
        self.folder.join(format!("error_{frame:05}.exr"))
    }

    /// What the file of a frame says of it; none if it is not there, says nothing or is another frame.
    pub fn record(&self, frame: u32) -> Option<FrameRecord> {
        let note = self
            .storage
            .format
            .note(&self.file_of(frame))
            .ok()
            .flatten()?;
        FrameRecord::from_text(&note).filter(|record| record.frame == frame)
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
    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        let RenderedFrame {
            mut film,
            deviation,
            error,
            ..
        } = rendered;
        if self.storage.format != FrameFormat::Exr {
            film.expose(self.storage.exposure);
        }
        let note = FrameRecord::new(frame, error).to_text()?;
        let picture = self.storage.format.encode(&film, &note)?;
        let wanted = deviation.filter(|_| self.storage.error_maps);
        let error_map = wanted.map(|map| exr_file::encode(&magnitude(map), &note));
        Ok(EncodedFrame {
            picture,
            error_map: error_map.transpose()?,
        })
    }

    fn keep(&self, frame: u32, encoded: &EncodedFrame) -> Result<(), SinkError> {
        let keep = |file: PathBuf, bytes: &[u8]| {
            write_whole(&file, bytes).map_err(|error| format!("{}: {error}", file.display()))
        };
        // The frame comes last: where it is, all of it is.
        match &encoded.error_map {
            Some(map) => keep(self.map_of(frame), map)?,
            None => remove(&self.map_of(frame))?,
        }
        keep(self.file_of(frame), &encoded.picture)?;
        Ok(())
    }
}

fn magnitude(mut film: Film) -> Film {
    for pixel in film.pixels_mut() {
        *pixel = pixel.abs();
    }
    film
}

/// Removes a file that would no longer be true, if it is there.
pub(super) fn remove(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Proves that a file can be written, by one of another name in its folder that is there for a moment: before
/// the work, not after.
pub fn try_out(trial: &Path) -> io::Result<()> {
    fs::write(trial, []).and_then(|()| fs::remove_file(trial))
}

/// Writes a file so that it is there whole or not at all, even if the machine stops in between.
pub fn write_whole(file: &Path, bytes: &[u8]) -> io::Result<()> {
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

    fn picture() -> EncodedFrame {
        EncodedFrame {
            picture: b"frame".to_vec(),
            error_map: None,
        }
    }

    fn open(folder: &Path, fingerprint: &str, force: bool) -> Result<FrameFolder, FolderError> {
        let storage = FrameStorage {
            format: FrameFormat::Png,
            exposure: 0.0,
            error_maps: false,
        };
        FrameFolder::open(folder, storage, &info(fingerprint), force)
    }

    #[test]
    fn frames_are_numbered_and_nothing_else_is_left() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path().join("deep/er");
        let frames = open(&folder, "a", false).expect("new");
        assert!(!frames.has(7));
        frames.keep(7, &picture()).expect("kept");
        frames.keep(123_456, &picture()).expect("kept");
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
            .keep(0, &picture())
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
            .keep(1, &picture())
            .expect_err("in the way")
            .to_string();
        assert!(error.contains("frame_00001.png"), "{error}");
        assert_eq!(fs::read_dir(root.path()).expect("there").count(), 2);
    }
}
