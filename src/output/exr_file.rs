//! OpenEXR files: linear light in 32-bit floats, with a text beside it.

use super::format::NOTE;
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
    let header = meta.headers.first();
    let value = header.and_then(|header| header.own_attributes.other.get(&Text::from(NOTE)));
    Ok(match value {
        Some(AttributeValue::Text(note)) => Some(note.to_string()),
        _ => None,
    })
}

/// The film of a file written by [`encode`].
pub fn decode(file: &Path) -> io::Result<Film> {
    let read = read_first_rgba_layer_from_file(
        file,
        |size, _| Film::new(size.width() as u32, size.height() as u32),
        |film: &mut Film, at, (r, g, b, _): (f32, f32, f32, f32)| {
            let number = at.y() * film.width() as usize + at.x();
            film.pixels_mut()[number] = Vec3::new(r, g, b);
        },
    );
    Ok(read
        .map_err(io::Error::other)?
        .layer_data
        .channel_data
        .pixels)
}
