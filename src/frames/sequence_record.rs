//! `sequence.ron`, the expected frames of a folder: format, size, input hashes.

use super::format::FrameFormat;
use super::record::{FrameError, FrameRecord};
use crate::film::Film;
use crate::render::{EncodedFrame, RenderedFrame, SinkError};
use ron::value::RawValue;
use serde::{Deserialize, Serialize};

/// What tells a frame of this sequence from any other. It is written beside the frames, as `sequence.ron`, before the
/// first of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Sequence", deny_unknown_fields)]
pub struct SequenceRecord {
    /// The build of the program that renders the frames.
    pub build: String,
    /// Builds whose frames count as this one's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accepted_builds: Vec<String>,
    /// The job spec as RON, for re-rendering. The frame store does not read it.
    pub job: Box<RawValue>,
    /// Frames per second of the video.
    pub fps: f64,
    /// Frames of the whole camera path.
    pub frames: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// File format of the frames.
    pub format: FrameFormat,
    /// Exposure in stops of PNG frames.
    pub exposure: f32,
    /// Whether the error of every pixel is stored beside the frames.
    pub error_maps: bool,
    /// Whether frames look indirect light up in an irradiance cache.
    pub irradiance_cache: bool,
    /// Of each frame, a hash of all inputs that decide its pixels.
    pub input_hashes: Vec<String>,
}

impl SequenceRecord {
    /// Whether both are of the same frames, by whichever job and from whichever builds.
    pub(super) fn has_the_frames_of(&self, other: &SequenceRecord) -> bool {
        let SequenceRecord {
            job,
            accepted_builds,
            ..
        } = other.clone();
        SequenceRecord {
            job,
            accepted_builds,
            ..self.clone()
        } == *other
    }

    /// Whether frames of a build count as frames of this sequence.
    pub fn accepts(&self, build: &str) -> bool {
        build == self.build
            || self
                .accepted_builds
                .iter()
                .any(|accepted| accepted == build)
    }

    /// The files of a frame, with the record by which it is verified.
    pub fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        let RenderedFrame {
            mut film,
            half_difference,
            error,
            ..
        } = rendered;
        if self.format != FrameFormat::Exr {
            film.expose(self.exposure);
        }
        let error = error.map(FrameError::from);
        let encode = |format: FrameFormat, film: &Film| -> Result<Vec<u8>, SinkError> {
            let pixels = format.encode_pixels(film);
            let record = FrameRecord {
                frame,
                build: self.build.clone(),
                input_hash: self.input_hashes[frame as usize].clone(),
                pixel_hash: pixels.hash().to_string(),
                error,
            };
            Ok(format.encode(&pixels, &record.to_text()?)?)
        };
        let image = encode(self.format, &film)?;
        let wanted = half_difference.filter(|_| self.error_maps);
        let error_map = wanted.map(|map| encode(FrameFormat::Exr, &magnitude(map)));
        Ok(EncodedFrame {
            image,
            error_map: error_map.transpose()?,
        })
    }

    pub(super) fn to_text(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::new().struct_names(true);
        ron::ser::to_string_pretty(self, pretty)
    }

    /// Reads a file's text; an error if it is no record of a sequence or contradicts itself.
    pub(super) fn from_text(text: &str) -> Result<SequenceRecord, String> {
        let sequence: SequenceRecord = ron::from_str(text).map_err(|error| error.to_string())?;
        match sequence.input_hashes.len() as u64 == u64::from(sequence.frames) {
            true => Ok(sequence),
            false => Err("input_hashes has not one entry for each frame".to_owned()),
        }
    }
}

fn magnitude(mut film: Film) -> Film {
    for pixel in film.pixels_mut() {
        *pixel = pixel.abs();
    }
    film
}
