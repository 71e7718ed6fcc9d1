use super::format::FrameFormat;
use super::record::{FrameError, FrameRecord};
use crate::film::Film;
use crate::render::{EncodedFrame, RenderedFrame, SinkError};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What the frames of a folder are to be: all that tells a frame which belongs there from any other.
///
/// It is written down beside the frames, as `sequence.ron`, before the first of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Sequence")]
pub struct SequenceRecord {
    /// The program and its version.
    pub program: String,
    /// What was typed to render it, to be able to do it again.
    pub command: PlanCommand,
    /// Frames per second of the video.
    pub fps: f64,
    /// How many frames the whole path has.
    pub frames: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The format of the frames' files.
    pub format: FrameFormat,
    /// Stops that are applied to what is stored for display.
    pub exposure: f32,
    /// Whether the error of every pixel is kept beside the frames.
    pub error_maps: bool,
    /// Whether frames look up light that is worked out for the whole path.
    pub path_light: bool,
    /// Of each frame, a hash of all that decides its pixels.
    pub input_hash: Vec<String>,
}

/// A command line and where it was typed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Command")]
pub struct PlanCommand {
    /// The folder that relative names are relative to.
    pub folder: PathBuf,
    /// The arguments, the program's name first.
    pub arguments: Vec<String>,
}

impl SequenceRecord {
    /// This program and its version.
    pub fn program() -> String {
        format!("flythrough {}", env!("CARGO_PKG_VERSION"))
    }

    /// Whether the frames of both are the same, however they were asked for.
    pub(super) fn has_the_frames_of(&self, other: &SequenceRecord) -> bool {
        let command = other.command.clone();
        SequenceRecord {
            command,
            ..self.clone()
        } == *other
    }

    /// What is to be kept of a frame, with the record that proves it.
    pub fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        let RenderedFrame {
            mut film,
            deviation,
            error,
            ..
        } = rendered;
        if self.format != FrameFormat::Exr {
            film.expose(self.exposure);
        }
        let error = error.map(FrameError::from);
        let encode = |format: FrameFormat, film: &Film| -> Result<Vec<u8>, SinkError> {
            let picture = format.picture(film);
            let record = FrameRecord {
                frame,
                input_hash: self.input_hash[frame as usize].clone(),
                pixels: picture.hash().to_string(),
                error,
            };
            Ok(format.encode(&picture, &record.to_text()?)?)
        };
        let picture = encode(self.format, &film)?;
        let wanted = deviation.filter(|_| self.error_maps);
        let error_map = wanted.map(|map| encode(FrameFormat::Exr, &magnitude(map)));
        Ok(EncodedFrame {
            picture,
            error_map: error_map.transpose()?,
        })
    }

    pub(super) fn to_text(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::new().struct_names(true);
        ron::ser::to_string_pretty(self, pretty)
    }

    /// What a file says; an error if it is no plan or contradicts itself.
    pub(super) fn from_text(text: &str) -> Result<SequenceRecord, String> {
        let sequence: SequenceRecord = ron::from_str(text).map_err(|error| error.to_string())?;
        match sequence.input_hash.len() as u64 == u64::from(sequence.frames) {
            true => Ok(sequence),
            false => Err("it does not list as many frames as it says there are".to_owned()),
        }
    }
}

fn magnitude(mut film: Film) -> Film {
    for pixel in film.pixels_mut() {
        *pixel = pixel.abs();
    }
    film
}
