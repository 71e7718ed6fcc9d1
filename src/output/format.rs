use super::picture::{Contents, Picture};
use super::{exr_file, png_file};
use crate::film::Film;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// How a frame is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FrameFormat {
    /// 8 bits for each channel, sRGB.
    Png,
    /// 16 bits for each channel, sRGB.
    Png16,
    /// 32-bit floats, linear light, OpenEXR.
    Exr,
}

impl FrameFormat {
    /// The ending of a file's name, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            FrameFormat::Png | FrameFormat::Png16 => "png",
            FrameFormat::Exr => "exr",
        }
    }

    /// Bytes of a channel of a pixel.
    pub(super) fn bytes_per_channel(self) -> usize {
        match self {
            FrameFormat::Png => 1,
            FrameFormat::Png16 => 2,
            FrameFormat::Exr => 4,
        }
    }

    /// A film as it is stored.
    pub(super) fn picture(self, film: &Film) -> Picture {
        let samples = match self {
            FrameFormat::Png => film.to_srgb8(),
            FrameFormat::Png16 => film.to_srgb16_be(),
            FrameFormat::Exr => exr_file::samples(film),
        };
        Picture {
            width: film.width(),
            height: film.height(),
            samples,
        }
    }

    /// The bytes of a file that holds `picture` and says `note`, a text of printable ASCII; the same for the
    /// same picture and note.
    pub(super) fn encode(self, picture: &Picture, note: &str) -> io::Result<Vec<u8>> {
        match self {
            FrameFormat::Png => png_file::encode(picture, png::BitDepth::Eight, note),
            FrameFormat::Png16 => png_file::encode(picture, png::BitDepth::Sixteen, note),
            FrameFormat::Exr => exr_file::encode(&exr_file::film(picture), note),
        }
    }

    /// What a file's bytes hold, or why they are no file of this format that has its picture whole.
    pub(super) fn decode(self, bytes: &[u8], size: (u32, u32)) -> Result<Contents, String> {
        match self {
            FrameFormat::Png => png_file::decode(bytes, png::BitDepth::Eight, size),
            FrameFormat::Png16 => png_file::decode(bytes, png::BitDepth::Sixteen, size),
            FrameFormat::Exr => exr_file::contents(bytes, size),
        }
    }

    /// What a file of this format says; none if it says nothing.
    pub(super) fn note(self, file: &Path) -> io::Result<Option<String>> {
        match self {
            FrameFormat::Png | FrameFormat::Png16 => png_file::note(file),
            FrameFormat::Exr => exr_file::note(file),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::io::Cursor;

    const SAID: &str = "Frame(frame:7,error:None)";
    const FORMATS: [FrameFormat; 3] = [FrameFormat::Png, FrameFormat::Png16, FrameFormat::Exr];

    fn film() -> Film {
        let mut film = Film::new(3, 2);
        for (i, pixel) in film.pixels_mut().iter_mut().enumerate() {
            *pixel = Vec3::new(0.1 * i as f32, 0.5, 1.5);
        }
        film
    }

    fn file(format: FrameFormat) -> Vec<u8> {
        format
            .encode(&format.picture(&film()), SAID)
            .expect("encodes")
    }

    #[test]
    fn png_files_hold_the_codes_and_say_srgb() {
        for (format, codes) in [
            (FrameFormat::Png, film().to_srgb8()),
            (FrameFormat::Png16, film().to_srgb16_be()),
        ] {
            let mut reader = png::Decoder::new(Cursor::new(file(format)))
                .read_info()
                .expect("a PNG");
            assert!(reader.info().srgb.is_some());
            let mut samples = vec![0; codes.len()];
            let info = reader.next_frame(&mut samples).expect("whole");
            assert_eq!((info.width, info.height), (3, 2));
            assert_eq!(samples, codes);
        }
    }

    #[test]
    fn exr_files_hold_the_floats() {
        let bytes = file(FrameFormat::Exr);
        let image = image::load_from_memory(&bytes)
            .expect("an EXR")
            .into_rgb32f();
        let channels: Vec<f32> = film().pixels().iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(image.into_raw(), channels);
        assert_eq!(exr_file::decode(&bytes).expect("an EXR"), film());
    }

    #[test]
    fn files_say_their_notes_and_give_back_what_was_stored() {
        let folder = tempfile::tempdir().expect("a folder");
        for format in FORMATS {
            let stored = folder.path().join("frame");
            std::fs::write(&stored, file(format)).expect("written");
            assert_eq!(format.note(&stored).expect("whole").as_deref(), Some(SAID));
            let contents = format.decode(&file(format), (3, 2)).expect("whole");
            assert_eq!(contents.note.as_deref(), Some(SAID));
            let picture = format.picture(&film());
            assert_eq!(picture.samples.len(), 18 * format.bytes_per_channel());
            assert!(contents.picture == Some(picture));
            let other = format.decode(&file(format), (2, 3)).expect("whole");
            assert!(other.picture.is_none() && other.note.is_some());
        }
    }

    /// Whatever is cut off.
    #[test]
    fn no_part_of_a_file_is_a_file() {
        for format in FORMATS {
            let file = file(format);
            for length in 0..file.len() {
                let decoded = format.decode(&file[..length], (3, 2));
                assert!(decoded.is_err(), "{format:?}: {length} of {}", file.len());
            }
        }
    }
}
