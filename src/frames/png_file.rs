//! PNG files: sRGB codes, with a text beside them.

use super::picture::{Contents, NOTE, Picture};
use png::{BitDepth, ColorType, DecodeOptions, Decoder, Info, Limits};
use std::fs::File;
use std::io::{self, BufReader, Cursor};
use std::path::Path;

/// The bytes of a file that holds a picture and says `note`, unless that is empty.
pub(super) fn encode(picture: &Picture, depth: BitDepth, note: &str) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(depth);
    // Without a tag, programs guess the colour space, and guess differently.
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    if !note.is_empty() {
        encoder.add_text_chunk(NOTE.to_owned(), note.to_owned())?;
    }
    // Stronger settings cost many times the encoding time for a few per cent of size.
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&picture.samples)?;
    writer.finish()?;
    Ok(bytes)
}

/// What a file's bytes hold; the picture only if it has that size.
pub(super) fn decode(bytes: &[u8], depth: BitDepth, size: (u32, u32)) -> Result<Contents, String> {
    let wrong = |error: png::DecodingError| error.to_string();
    let mut options = DecodeOptions::default();
    options.set_ignore_checksums(false);
    options.set_skip_ancillary_crc_failures(false);
    let mut decoder = Decoder::new_with_options(Cursor::new(bytes), options);
    decoder.set_limits(Limits { bytes: usize::MAX });
    let mut reader = decoder.read_info().map_err(wrong)?;
    let found = reader.info().size();
    let note = note_in(reader.info());
    let is_rgb = reader.output_color_type() == (ColorType::Rgb, depth);
    if found != size || !is_rgb {
        return Ok(Contents {
            note,
            picture: None,
        });
    }
    let length = reader
        .output_buffer_size()
        .ok_or("a picture beyond all memory")?;
    let mut samples = vec![0; length];
    reader.next_frame(&mut samples).map_err(wrong)?;
    reader.finish().map_err(wrong)?;
    let picture = Picture {
        width: size.0,
        height: size.1,
        samples,
    };
    Ok(Contents {
        note,
        picture: Some(picture),
    })
}

/// What a file says; none if it says nothing.
pub(super) fn note(file: &Path) -> io::Result<Option<String>> {
    let reader = Decoder::new(BufReader::new(File::open(file)?)).read_info()?;
    Ok(note_in(reader.info()))
}

fn note_in(info: &Info) -> Option<String> {
    let texts = &info.uncompressed_latin1_text;
    let note = texts.iter().find(|text| text.keyword == NOTE);
    note.map(|note| note.text.clone())
}
