//! `sequence.ron`, the expected frames of a folder: format, size, input hashes.

use super::format::FrameFormat;
use super::record::{FrameError, FrameRecord};
use crate::film::Film;
use crate::render::{Aov, EncodedFrame, RenderedFrame, SinkError};
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
    /// Whether that which the irradiance cache makes is, too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub cache_error_maps: bool,
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
        let maps: Vec<Film> = self.maps().map(|aov| rendered.map(aov)).collect();
        let RenderedFrame {
            mut film, error, ..
        } = rendered;
        if self.format != FrameFormat::Exr {
            film.expose(self.exposure);
        }
        let error = FrameError::from(error);
        let encode = |format: FrameFormat, film: &Film| -> Result<Vec<u8>, SinkError> {
            let pixels = format.encode_pixels(film, frame);
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
        let maps = maps.iter().map(|map| encode(FrameFormat::Exr, map));
        Ok(EncodedFrame {
            image,
            maps: maps.collect::<Result<_, _>>()?,
        })
    }

    /// The maps beside each frame.
    pub fn maps(&self) -> impl Iterator<Item = Aov> + use<> {
        let error = self.error_maps.then_some(Aov::Error);
        let cache_error = self.cache_error_maps.then_some(Aov::CacheError);
        error.into_iter().chain(cache_error)
    }

    /// What a file's facts say that is not so, as "24 frames per second instead of 25"; empty if `self` is as
    /// recorded. The inputs of frames are not compared: each frame carries the hash of its own.
    pub fn contradictions(&self, recorded: &SequenceRecord) -> Vec<String> {
        let facts = |of: &SequenceRecord| {
            [
                format!("{} frames per second", of.fps),
                format!("{} frames", of.frames),
                format!("{}x{} pixels", of.width, of.height),
                format!("{} files", of.format),
                format!("an exposure of {} stops", of.exposure),
                (match (of.error_maps, of.cache_error_maps) {
                    (false, false) => "no error maps",
                    (true, false) => "error maps",
                    (false, true) => "maps of the cache error",
                    (true, true) => "maps of the error and the cache error",
                })
                .to_owned(),
            ]
        };
        let pairs = facts(recorded).into_iter().zip(facts(self));
        let differing = pairs.filter(|(recorded, now)| recorded != now);
        differing
            .map(|(recorded, now)| format!("{recorded} instead of {now}"))
            .collect()
    }

    /// The text of a file: the record, and a hash of it, so that no edit goes unseen.
    pub(super) fn to_text(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::new().struct_names(true);
        let text = ron::ser::to_string_pretty(self, pretty)?;
        let hash = blake3::hash(text.as_bytes());
        Ok(format!("{text}{HASH_COMMENT}{hash}\n"))
    }

    /// Reads a file's text; an error if it is no record of a sequence, was changed, or contradicts itself.
    pub(super) fn from_text(text: &str) -> Result<SequenceRecord, String> {
        let (text, hash) = text
            .rsplit_once(HASH_COMMENT)
            .ok_or("the hash in its last line is missing")?;
        if blake3::hash(text.as_bytes()).to_string() != hash.trim_end() {
            return Err("altered after it was written".to_owned());
        }
        let sequence: SequenceRecord = ron::from_str(text).map_err(|error| error.to_string())?;
        match sequence.input_hashes.len() as u64 == u64::from(sequence.frames) {
            true => Ok(sequence),
            false => Err("input_hashes has not one entry for each frame".to_owned()),
        }
    }
}

/// What stands between the record and its hash.
const HASH_COMMENT: &str = "\n// blake3 of the lines above: ";
