//! PNG files: sRGB codes, with metadata in a text chunk.

use super::encoded_pixels::{Contents, EncodedPixels, METADATA_KEY, METADATA_WITHIN};
use png::{BitDepth, ColorType, DecodeOptions, Decoder, Info, Limits};
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};

/// The most memory for what is in a file beside pixels: a profile of a few bytes may claim gigabytes.
const LIMITS: Limits = Limits { bytes: 64 << 20 };

/// The bytes of a file that holds an image, with `metadata`, unless that is empty, in its `flythrough` text chunk.
pub(super) fn encode(
    pixels: &EncodedPixels,
    depth: BitDepth,
    metadata: &str,
) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width, pixels.height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(depth);
    // Without a tag, programs guess the colour space, and guess differently.
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    if !metadata.is_empty() {
        encoder.add_text_chunk(METADATA_KEY.to_owned(), metadata.to_owned())?;
    }
    // Stronger settings cost many times the encoding time for a few per cent of size.
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels.samples)?;
    writer.finish()?;
    Ok(bytes)
}

/// What a file's bytes hold; the pixels only if the image has that size.
pub(super) fn decode(bytes: &[u8], depth: BitDepth, size: (u32, u32)) -> Result<Contents, String> {
    let wrong = |error: png::DecodingError| error.to_string();
    let mut options = DecodeOptions::default();
    options.set_ignore_checksums(false);
    options.set_skip_ancillary_crc_failures(false);
    let mut decoder = Decoder::new_with_options(Cursor::new(bytes), options);
    decoder.set_limits(LIMITS);
    let mut reader = decoder.read_info().map_err(wrong)?;
    let found = reader.info().size();
    let metadata = metadata_in(reader.info());
    let is_rgb = reader.output_color_type() == (ColorType::Rgb, depth);
    if found != size || !is_rgb {
        return Ok(Contents {
            metadata,
            pixels: None,
        });
    }
    let length = reader
        .output_buffer_size()
        .ok_or("an image beyond all memory")?;
    let mut samples = vec![0; length];
    reader.next_frame(&mut samples).map_err(wrong)?;
    reader.finish().map_err(wrong)?;
    let pixels = EncodedPixels {
        width: size.0,
        height: size.1,
        samples,
    };
    Ok(Contents {
        metadata,
        pixels: Some(pixels),
    })
}

/// The `flythrough` text chunk of a file; none if it has none.
pub(super) fn read_metadata(file: File) -> io::Result<Option<String>> {
    let reader =
        Decoder::new_with_limits(BufReader::new(file.take(METADATA_WITHIN)), LIMITS).read_info()?;
    Ok(metadata_in(reader.info()))
}

fn metadata_in(info: &Info) -> Option<String> {
    let texts = &info.uncompressed_latin1_text;
    let found = texts.iter().find(|text| text.keyword == METADATA_KEY);
    found.map(|text| text.text.clone())
}
