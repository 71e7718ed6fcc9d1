//! The file formats of frames: 8 and 16 bit PNG, OpenEXR.

use super::encoded_pixels::{Contents, EncodedPixels};
use super::{exr, png_file};
use crate::film::Film;
#[cfg(any(test, feature = "plots"))]
use crate::math::color::srgb_to_linear;
use crate::storage::{FileError, write_atomic};
#[cfg(any(test, feature = "plots"))]
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::File;
use std::io;
use std::path::Path;

/// How a frame is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FrameFormat {
    /// 8 bits for each channel, sRGB.
    #[default]
    Png,
    /// 16 bits for each channel, sRGB.
    Png16,
    /// 32-bit floats, linear light, OpenEXR.
    Exr,
}

impl fmt::Display for FrameFormat {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            FrameFormat::Png => "png",
            FrameFormat::Png16 => "png16",
            FrameFormat::Exr => "exr",
        })
    }
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

    /// The pixels of a film as a file stores them; those of 8 bits dithered, which depends on the number of the frame.
    pub(super) fn encode_pixels(self, film: &Film, frame: u32) -> EncodedPixels {
        let samples = match self {
            FrameFormat::Png => film.to_srgb8_dithered(frame),
            FrameFormat::Png16 => film.to_srgb16_be(),
            FrameFormat::Exr => exr::samples(film),
        };
        EncodedPixels {
            width: film.width(),
            height: film.height(),
            samples,
        }
    }

    /// The film of such pixels, as far as their precision tells.
    #[cfg(any(test, feature = "plots"))]
    pub(super) fn film(self, encoded: &EncodedPixels) -> Film {
        let samples = &encoded.samples;
        let channels: Vec<f32> = match self {
            FrameFormat::Png => {
                let linear = linear_codes(u8::MAX.into());
                samples.iter().map(|&code| linear[code as usize]).collect()
            }
            FrameFormat::Png16 => {
                let linear = linear_codes(u16::MAX);
                let codes = samples.as_chunks().0.iter();
                let codes = codes.map(|bytes| u16::from_be_bytes(*bytes));
                codes.map(|code| linear[code as usize]).collect()
            }
            FrameFormat::Exr => return exr::film(encoded),
        };
        let pixels = channels.chunks_exact(3).map(Vec3::from_slice).collect();
        Film::from_pixels(encoded.width, encoded.height, pixels)
    }

    /// The bytes of a file that holds `pixels` and `metadata`, a text of printable ASCII; the same for the same pixels
    /// and metadata.
    pub(super) fn encode(self, pixels: &EncodedPixels, metadata: &str) -> io::Result<Vec<u8>> {
        match self {
            FrameFormat::Png => png_file::encode(pixels, png::BitDepth::Eight, metadata),
            FrameFormat::Png16 => png_file::encode(pixels, png::BitDepth::Sixteen, metadata),
            FrameFormat::Exr => exr::encode(&exr::film(pixels), metadata),
        }
    }

    /// What a file's bytes hold, or why they are no file of this format whose image is whole.
    pub(super) fn decode(self, bytes: &[u8], size: (u32, u32)) -> Result<Contents, String> {
        match self {
            FrameFormat::Png => png_file::decode(bytes, png::BitDepth::Eight, size),
            FrameFormat::Png16 => png_file::decode(bytes, png::BitDepth::Sixteen, size),
            FrameFormat::Exr => exr::contents(bytes, size),
        }
    }

    /// The metadata of a file of this format; none if it has none.
    pub(super) fn read_metadata(self, file: File) -> io::Result<Option<String>> {
        match self {
            FrameFormat::Png | FrameFormat::Png16 => png_file::read_metadata(file),
            FrameFormat::Exr => exr::read_metadata(file),
        }
    }
}

/// The linear value of each sRGB code up to the one that is 1.
#[cfg(any(test, feature = "plots"))]
fn linear_codes(most: u16) -> Vec<f32> {
    let linear = |code| srgb_to_linear(f32::from(code) / f32::from(most));
    (0..=most).map(linear).collect()
}

/// Writes a film as a PNG file of 8 bits for each channel, sRGB, whole or not at all. Radiance of 1 is white; what is
/// brighter is clipped: see [`Film::expose`]. Codes are dithered, differently for each number of a frame: see
/// [`Film::to_srgb8_dithered`].
pub fn write_png(film: &Film, frame: u32, file: &Path) -> Result<(), FileError> {
    let pixels = FrameFormat::Png.encode_pixels(film, frame);
    let bytes = FrameFormat::Png.encode(&pixels, "");
    write_atomic(
        file,
        &bytes.map_err(|error| FileError::writing(file, error))?,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    const FRAME: u32 = 7;
    const METADATA: &str = "Frame(frame:7,error:None)";
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
            .encode(&format.encode_pixels(&film(), FRAME), METADATA)
            .expect("encodes")
    }

    #[test]
    fn png_files_hold_the_codes_and_say_srgb() {
        for (format, codes) in [
            (FrameFormat::Png, film().to_srgb8_dithered(FRAME)),
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
        assert_eq!(exr::decode(&bytes).expect("an EXR"), film());
    }

    #[test]
    fn files_give_back_their_metadata_and_their_pixels() {
        let folder = tempfile::tempdir().expect("a folder");
        for format in FORMATS {
            let stored = folder.path().join("frame");
            std::fs::write(&stored, file(format)).expect("written");
            assert_eq!(
                format
                    .read_metadata(File::open(&stored).expect("there"))
                    .expect("whole")
                    .as_deref(),
                Some(METADATA)
            );
            let contents = format.decode(&file(format), (3, 2)).expect("whole");
            assert_eq!(contents.metadata.as_deref(), Some(METADATA));
            let pixels = format.encode_pixels(&film(), FRAME);
            assert_eq!(pixels.samples.len(), 18 * format.bytes_per_channel());
            assert!(contents.pixels == Some(pixels));
            let other = format.decode(&file(format), (2, 3)).expect("whole");
            assert!(other.pixels.is_none() && other.metadata.is_some());
        }
    }

    #[test]
    fn encoded_pixels_give_back_the_film() {
        let precisions = [(1.0, 255.0), (0.5, 65535.0), (0.0, 1.0)];
        for (format, (codes, steps)) in FORMATS.into_iter().zip(precisions) {
            let encoded = format.encode_pixels(&film(), FRAME);
            let told = format.film(&encoded);
            assert_eq!((told.width(), told.height()), (3, 2));
            let shown = |pixel: &Vec3| match format {
                FrameFormat::Exr => *pixel,
                _ => pixel.min(Vec3::ONE),
            };
            for (told, pixel) in told.pixels().iter().zip(film().pixels()) {
                // Nowhere is the curve steeper in linear light than 2.3 codes to a code. Dithered codes are less than one
                // off, rounded ones half of one.
                let error = (told - shown(pixel)).abs().max_element();
                assert!(
                    error <= codes * 2.3 / steps,
                    "{format:?}: {told} of {pixel}"
                );
            }
            assert!(format.encode_pixels(&told, 0) == encoded);
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
