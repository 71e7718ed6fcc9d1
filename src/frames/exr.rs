//! OpenEXR files: linear light in 32-bit floats, with a text beside it.

use super::picture::{Contents, NOTE, Picture};
use crate::film::Film;
use exr::meta::MetaData;
use exr::prelude::*;
use glam::Vec3;
use std::io::{self, Cursor};
use std::path::Path;

/// The bytes of a file that holds a film and says `note`.
pub fn encode(film: &Film, note: &str) -> io::Result<Vec<u8>> {
    let (width, height) = (film.width() as usize, film.height() as usize);
    let pixel = |at: Vec2<usize>| {
        let [r, g, b] = film.pixels()[at.y() * width + at.x()].to_array();
        (r, g, b)
    };
    let mut image = Image::from_channels((width, height), SpecificChannels::rgb(pixel));
    let note = Text::new_or_none(note).ok_or_else(|| io::Error::other("a note that is no text"))?;
    let attributes = &mut image.layer_data.attributes.other;
    attributes.insert(Text::from(NOTE), AttributeValue::Text(note));
    let mut bytes = Cursor::new(Vec::new());
    let written = image.write().non_parallel().to_buffered(&mut bytes);
    written.map_err(io::Error::other)?;
    Ok(bytes.into_inner())
}

/// What a file says; none if it says nothing.
pub fn note(file: &Path) -> io::Result<Option<String>> {
    let meta = MetaData::read_from_file(file, false).map_err(io::Error::other)?;
    Ok(note_in(&meta))
}

fn note_in(meta: &MetaData) -> Option<String> {
    let header = meta.headers.first();
    let value = header.and_then(|header| header.own_attributes.other.get(&Text::from(NOTE)));
    match value {
        Some(AttributeValue::Text(note)) => Some(note.to_string()),
        _ => None,
    }
}

/// The samples that a file of a film stores.
pub(super) fn samples(film: &Film) -> Vec<u8> {
    let channels = film.pixels().iter().flat_map(|pixel| pixel.to_array());
    channels.flat_map(f32::to_le_bytes).collect()
}

/// The film that a picture of such samples is of.
pub(super) fn film(picture: &Picture) -> Film {
    let channels = picture.samples.as_chunks().0.iter();
    let channels: Vec<f32> = channels.map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let pixels = channels.chunks_exact(3).map(Vec3::from_slice).collect();
    Film::from_pixels(picture.width, picture.height, pixels)
}

/// What a file's bytes hold; the picture only if it has that size.
pub(super) fn contents(bytes: &[u8], size: (u32, u32)) -> std::result::Result<Contents, String> {
    let wrong = |error: Error| error.to_string();
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(wrong)?;
    let note = note_in(&meta);
    let header = meta.headers.first().ok_or("a file without a picture")?;
    let found = header.layer_size;
    let found = (found.width() as u32, found.height() as u32);
    let film = match found == size {
        true => Some(decode(bytes).map_err(|error| error.to_string())?),
        false => None,
    };
    let picture = film.map(|film| Picture {
        width: film.width(),
        height: film.height(),
        samples: samples(&film),
    });
    Ok(Contents { note, picture })
}

/// The film that a file's bytes hold.
pub fn decode(bytes: &[u8]) -> io::Result<Film> {
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
