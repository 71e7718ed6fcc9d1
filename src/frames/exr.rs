//! OpenEXR files: linear light in 32-bit floats, with metadata in an attribute.

use super::encoded_pixels::{Contents, EncodedPixels, METADATA_KEY, METADATA_WITHIN};
use crate::film::Film;
use exr::meta::MetaData;
use exr::prelude::*;
use glam::Vec3;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read as _};

/// The bytes of a file that holds a film, with `metadata` in its `flythrough` attribute.
pub fn encode(film: &Film, metadata: &str) -> io::Result<Vec<u8>> {
    let (width, height) = (film.width() as usize, film.height() as usize);
    let pixel = |at: Vec2<usize>| {
        let [r, g, b] = film.pixels()[at.y() * width + at.x()].to_array();
        (r, g, b)
    };
    let mut image = Image::from_channels((width, height), SpecificChannels::rgb(pixel));
    let metadata =
        Text::new_or_none(metadata).ok_or_else(|| io::Error::other("metadata that is no text"))?;
    let attributes = &mut image.layer_data.attributes.other;
    attributes.insert(Text::from(METADATA_KEY), AttributeValue::Text(metadata));
    let mut bytes = Cursor::new(Vec::new());
    let written = image.write().non_parallel().to_buffered(&mut bytes);
    written.map_err(io::Error::other)?;
    Ok(bytes.into_inner())
}

/// The `flythrough` attribute of a file; none if it has none.
pub(super) fn read_metadata(file: File) -> io::Result<Option<String>> {
    let meta = MetaData::read_from_buffered(BufReader::new(file.take(METADATA_WITHIN)), false)
        .map_err(io::Error::other)?;
    Ok(metadata_in(&meta))
}

fn metadata_in(meta: &MetaData) -> Option<String> {
    let header = meta.headers.first();
    let value =
        header.and_then(|header| header.own_attributes.other.get(&Text::from(METADATA_KEY)));
    match value {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    }
}

/// The samples that a file of a film stores.
pub(super) fn samples(film: &Film) -> Vec<u8> {
    let channels = film.pixels().iter().flat_map(|pixel| pixel.to_array());
    channels.flat_map(f32::to_le_bytes).collect()
}

/// The film of such samples.
pub(super) fn film(encoded: &EncodedPixels) -> Film {
    let channels = encoded.samples.as_chunks().0.iter();
    let channels: Vec<f32> = channels.map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let pixels = channels.chunks_exact(3).map(Vec3::from_slice).collect();
    Film::from_pixels(encoded.width, encoded.height, pixels)
}

/// What a file's bytes hold; the pixels only if the image has that size.
pub(super) fn contents(bytes: &[u8], size: (u32, u32)) -> std::result::Result<Contents, String> {
    let wrong = |error: Error| error.to_string();
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(wrong)?;
    let metadata = metadata_in(&meta);
    let header = meta.headers.first().ok_or("a file without an image")?;
    let found = header.layer_size;
    let found = (found.width() as u32, found.height() as u32);
    let film = match found == size {
        true => Some(decode(bytes).map_err(|error| error.to_string())?),
        false => None,
    };
    let pixels = film.map(|film| EncodedPixels {
        width: film.width(),
        height: film.height(),
        samples: samples(&film),
    });
    Ok(Contents { metadata, pixels })
}

/// The metadata and the film that a file's bytes hold.
pub fn decode_with_metadata(bytes: &[u8]) -> io::Result<(Option<String>, Film)> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(io::Error::other)?;
    Ok((metadata_in(&meta), decode(bytes)?))
}

/// The film that a file's bytes hold.
pub(super) fn decode(bytes: &[u8]) -> io::Result<Film> {
    let read = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Film::new(size.width() as u32, size.height() as u32),
            |film: &mut Film, at, (r, g, b): (f32, f32, f32)| {
                let number = at.y() * film.width() as usize + at.x();
                film.pixels_mut()[number] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes));
    let image = read.map_err(io::Error::other)?;
    Ok(image.layer_data.channel_data.pixels)
}
