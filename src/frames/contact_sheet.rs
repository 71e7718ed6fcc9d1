//! The contact sheet of a folder of frames.

use super::encoded_pixels::EncodedPixels;
use super::file_names::SHEET_METADATA;
use super::folder::FrameFolder;
use super::format::FrameFormat;
use super::png_file;
use crate::drawing::contact_sheet::ContactSheet;
use crate::film::Film;
use crate::storage::{FileError, write_atomic};
use std::fs;
use std::io;
use std::path::{Component, Path};

/// The most frames that are shown.
const MAX_FRAMES: usize = 30;

/// Writes a contact sheet of some frames of a folder as a PNG file, whole or not at all. The frames are spread evenly
/// over those that are `listed`: the first, the last, and at most 30 in all. A frame that fails verification is
/// replaced by the reason.
///
/// Reads the frames on all threads of the current pool.
pub fn write_contact_sheet(
    folder: &FrameFolder,
    listed: &[u32],
    file: &Path,
) -> Result<(), FileError> {
    let sequence = folder.sequence();
    let count = listed.len().min(MAX_FRAMES);
    let frames: Vec<u32> = spread(listed.len(), count).map(|at| listed[at]).collect();
    let seconds = |frame: u32| format!("{:.2} s", f64::from(frame) / sequence.fps);
    let sheet = ContactSheet {
        title: &title(folder),
        caption: format!(
            "{} frames, {} fps, {}x{}, {}",
            sequence.frames,
            (sequence.fps * 1e3).round() / 1e3,
            sequence.width,
            sequence.height,
            seconds(sequence.frames.saturating_sub(1))
        ),
        labels: frames
            .iter()
            .map(|&frame| [format!("frame {frame}"), seconds(frame)])
            .collect(),
        frame_size: (sequence.width, sequence.height),
    };
    let drawn = sheet
        .draw(|number| film(folder, frames[number]))
        .map_err(|error| FileError::writing(file, io::Error::other(error)))?;
    let pixels = EncodedPixels {
        width: drawn.width(),
        height: drawn.height(),
        samples: drawn.into_raw(),
    };
    let bytes = png_file::encode(&pixels, png::BitDepth::Eight, SHEET_METADATA);
    write_atomic(
        file,
        &bytes.map_err(|error| FileError::writing(file, error))?,
    )
}

/// `count` numbers below `all`, evenly spread, the first and the last among them; `count` is at most `all`.
fn spread(all: usize, count: usize) -> impl Iterator<Item = usize> {
    let steps = count.saturating_sub(1).max(1);
    (0..count).map(move |step| (step * (all - 1) + steps / 2) / steps)
}

/// The names of the folder and of its parent: "preview" alone says little.
fn title(folder: &FrameFolder) -> String {
    let path = fs::canonicalize(folder.path()).unwrap_or_else(|_| folder.path().to_owned());
    let names = path.components().filter_map(|component| match component {
        Component::Normal(name) => Some(name.to_string_lossy()),
        _ => None,
    });
    let names: Vec<_> = names.collect();
    names[names.len().saturating_sub(2)..].join("/")
}

/// A frame as a display shows it, or in short why it fails verification.
fn film(folder: &FrameFolder, frame: u32) -> Result<Film, String> {
    let (_, _, pixels) = folder.verified(frame).map_err(|error| {
        let message = error.to_string();
        let (short, _) = message.split_once(':').unwrap_or((&message, ""));
        short.to_owned()
    })?;
    let sequence = folder.sequence();
    let mut film = sequence.format.film(&pixels);
    if sequence.format == FrameFormat::Exr {
        film.expose(sequence.exposure);
    }
    Ok(film)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_from_the_first_to_the_last() {
        for (all, count) in [(0, 0), (1, 1), (2, 2), (29, 29), (31, 30), (433, 30)] {
            let chosen: Vec<usize> = spread(all, count).collect();
            assert_eq!(chosen.len(), count);
            for (i, &number) in chosen.iter().enumerate() {
                let even = (i * all.saturating_sub(1)) as f64 / (count.max(2) - 1) as f64;
                assert!((number as f64 - even).abs() <= 0.5, "{number} of {all}");
            }
        }
    }
}
