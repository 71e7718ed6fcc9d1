use super::exr_file;
use crate::film::Film;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

/// Under this name a file's note is found in it.
pub(super) const NOTE: &str = "flythrough";

/// How a frame is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

    /// The bytes of a file that holds `film` and says `note`, a text of printable ASCII; the same for the
    /// same film and note.
    pub fn encode(self, film: &Film, note: &str) -> io::Result<Vec<u8>> {
        match self {
            FrameFormat::Png => png_file(film, png::BitDepth::Eight, &film.to_srgb8(), note),
            FrameFormat::Png16 => {
                png_file(film, png::BitDepth::Sixteen, &film.to_srgb16_be(), note)
            }
            FrameFormat::Exr => exr_file::encode(film, note),
        }
    }

    /// What a file of this format says; none if it says nothing.
    pub fn note(self, file: &Path) -> io::Result<Option<String>> {
        match self {
            FrameFormat::Png | FrameFormat::Png16 => png_note(file),
            FrameFormat::Exr => exr_file::note(file),
        }
    }
}

fn png_file(film: &Film, depth: png::BitDepth, samples: &[u8], note: &str) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, film.width(), film.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(depth);
    // Without a tag, programs guess the colour space, and guess differently.
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_text_chunk(NOTE.to_owned(), note.to_owned())?;
    // Stronger settings cost many times the encoding time for a few per cent of size.
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()?;
    Ok(bytes)
}

fn png_note(file: &Path) -> io::Result<Option<String>> {
    let decoder = png::Decoder::new(BufReader::new(File::open(file)?));
    let reader = decoder.read_info()?;
    let texts = &reader.info().uncompressed_latin1_text;
    let note = texts.iter().find(|text| text.keyword == NOTE);
    Ok(note.map(|note| note.text.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::io::Cursor;

    const SAID: &str = "Frame(frame:7,error:None)";

    fn film() -> Film {
        let mut film = Film::new(3, 2);
        for (i, pixel) in film.pixels_mut().iter_mut().enumerate() {
            *pixel = Vec3::new(0.1 * i as f32, 0.5, 1.5);
        }
        film
    }

    #[test]
    fn png_files_hold_the_codes_and_say_srgb() {
        for (format, codes) in [
            (FrameFormat::Png, film().to_srgb8()),
            (FrameFormat::Png16, film().to_srgb16_be()),
        ] {
            let bytes = format.encode(&film(), SAID).expect("encodes");
            let mut reader = png::Decoder::new(Cursor::new(bytes))
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
        let bytes = FrameFormat::Exr.encode(&film(), SAID).expect("encodes");
        let image = image::load_from_memory(&bytes)
            .expect("an EXR")
            .into_rgb32f();
        let channels: Vec<f32> = film().pixels().iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(image.into_raw(), channels);
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("film.exr");
        std::fs::write(&file, bytes).expect("written");
        assert_eq!(exr_file::decode(&file).expect("an EXR"), film());
    }

    #[test]
    fn files_say_their_notes() {
        let folder = tempfile::tempdir().expect("a folder");
        for format in [FrameFormat::Png, FrameFormat::Png16, FrameFormat::Exr] {
            let file = folder.path().join("frame");
            std::fs::write(&file, format.encode(&film(), SAID).expect("encodes")).expect("written");
            assert_eq!(format.note(&file).expect("whole").as_deref(), Some(SAID));
        }
    }
}
