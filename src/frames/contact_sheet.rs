use super::folder::FrameFolder;
use super::format::FrameFormat;
use super::picture::Picture;
use super::png_file;
use super::verify::VerifyError;
use crate::drawing::svg::{self, escaped};
use crate::film::Film;
use crate::storage::write_atomic;
use glam::Vec3;
use image::Rgb32FImage;
use image::imageops::{FilterType, resize};
use rayon::prelude::*;
use std::fs;
use std::io;
use std::path::{Component, Path};

/// A picture of frames side by side, small, each with its number and its time, to see a whole camera move at once.
///
/// A frame that is not proven leaves its place empty, but for what is wrong with it.
#[derive(Debug)]
pub struct ContactSheet<'a> {
    folder: &'a FrameFolder,
    frames: Vec<u32>,
    grid: Grid,
}

/// The most frames that are shown.
const MOST_FRAMES: usize = 30;

/// Columns of a frame, in pixels, as of all that follows.
const COLUMNS: u32 = 240;

/// The most rows of a frame: one that is higher has fewer columns.
const MOST_ROWS: u32 = 480;

/// Between frames, and around them.
const MARGIN: u32 = 10;

/// Rows for what stands above all frames.
const HEAD: u32 = 62;

/// Rows for what stands below each frame.
const LABEL: u32 = 22;

impl ContactSheet<'_> {
    /// A sheet of some frames of a folder, spread evenly over those that are listed: the first, the last, and at
    /// most 30 in all.
    pub fn new<'a>(folder: &'a FrameFolder, listed: &[u32]) -> ContactSheet<'a> {
        let count = listed.len().min(MOST_FRAMES);
        let sequence = folder.sequence();
        ContactSheet {
            folder,
            frames: spread(listed.len(), count).map(|at| listed[at]).collect(),
            grid: Grid::new(count as u32, (sequence.width, sequence.height)),
        }
    }

    /// Reads the frames, on all threads of the current pool, and writes the sheet as a PNG file, whole or not at
    /// all.
    pub fn write(&self, file: &Path) -> io::Result<()> {
        let sheet = png_file::encode(&self.draw()?, png::BitDepth::Eight, "contact sheet")?;
        write_atomic(file, &sheet)
    }

    fn draw(&self) -> io::Result<Picture> {
        let size = self.grid.frame;
        let frames = self.frames.par_iter();
        let frames: Vec<_> = frames.map(|&n| small(self.folder, n, size)).collect();
        let drawn = svg::pixels(&self.svg(&frames)).map_err(io::Error::other)?;
        let pixels = drawn.data().as_chunks::<4>().0.iter();
        let mut sheet = Picture {
            width: drawn.width(),
            height: drawn.height(),
            samples: pixels.flat_map(|&[r, g, b, _]| [r, g, b]).collect(),
        };
        for (number, frame) in (0..).zip(&frames) {
            if let Ok(frame) = frame {
                paste(frame, self.grid.place(number), &mut sheet);
            }
        }
        Ok(sheet)
    }

    /// All but the frames.
    fn svg(&self, frames: &[Result<Picture, VerifyError>]) -> String {
        let sequence = self.folder.sequence();
        let (width, height) = self.grid.size();
        let seconds = |frame: u32| format!("{:.2} s", f64::from(frame) / sequence.fps);
        let mut svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"
                font-family="sans-serif" font-size="13" fill="#dddddd">
            <rect width="{width}" height="{height}" fill="#202020"/>
            <text x="{MARGIN}" y="28" font-size="20">{}</text>
            <text x="{MARGIN}" y="50" fill="#999999">{} frames, {} fps, {}x{}, {}</text>"##,
            escaped(&title(self.folder)),
            sequence.frames,
            (sequence.fps * 1e3).round() / 1e3,
            sequence.width,
            sequence.height,
            seconds(sequence.frames.saturating_sub(1))
        );
        for ((number, frame), picture) in (0..).zip(&self.frames).zip(frames) {
            let (x, y) = self.grid.tile(number);
            let (right, below) = (x + COLUMNS, y + self.grid.frame.1 + 16);
            svg += &format!(
                r##"<text x="{x}" y="{below}">frame {frame}</text>
                <text x="{right}" y="{below}" text-anchor="end" fill="#999999">{}</text>"##,
                seconds(*frame)
            );
            if let Err(fault) = picture {
                let fault = fault.to_string();
                let (short, _) = fault.split_once(':').unwrap_or((&fault, ""));
                let (left, top) = self.grid.place(number);
                let (columns, rows) = self.grid.frame;
                let (center, middle) = (x + COLUMNS / 2, y + rows / 2 + 4);
                svg += &format!(
                    r##"<rect x="{left}" y="{top}" width="{columns}" height="{rows}" fill="#303030"/>
                    <text x="{center}" y="{middle}" text-anchor="middle" fill="#e69f00">{}</text>"##,
                    escaped(short)
                );
            }
        }
        svg + "</svg>"
    }
}

/// `count` numbers below `all`, evenly spread, the first and the last among them; `count` is at most `all`.
fn spread(all: usize, count: usize) -> impl Iterator<Item = usize> {
    let steps = count.saturating_sub(1).max(1);
    (0..count).map(move |step| (step * (all - 1) + steps / 2) / steps)
}

/// The folder's name and that of the folder that it is in: "preview" alone says little.
fn title(folder: &FrameFolder) -> String {
    let path = fs::canonicalize(folder.path()).unwrap_or_else(|_| folder.path().to_owned());
    let names = path.components().filter_map(|component| match component {
        Component::Normal(name) => Some(name.to_string_lossy()),
        _ => None,
    });
    let names: Vec<_> = names.collect();
    names[names.len().saturating_sub(2)..].join("/")
}

/// A frame as a display shows it, so many columns and rows of it.
fn small(folder: &FrameFolder, frame: u32, size: (u32, u32)) -> Result<Picture, VerifyError> {
    let (_, picture) = folder.verified(frame)?;
    let sequence = folder.sequence();
    let mut film = sequence.format.film(&picture);
    if sequence.format == FrameFormat::Exr {
        film.expose(sequence.exposure);
    }
    Ok(FrameFormat::Png.picture(&scaled(&film, size)))
}

/// A film of another size, filtered in linear light, what is beyond white clipped first.
fn scaled(film: &Film, (width, height): (u32, u32)) -> Film {
    let pixels = film.pixels().iter();
    let channels = pixels.flat_map(|pixel| pixel.clamp(Vec3::ZERO, Vec3::ONE).to_array());
    let image = Rgb32FImage::from_raw(film.width(), film.height(), channels.collect())
        .expect("three channels of each pixel");
    let image = resize(&image, width, height, FilterType::Triangle);
    let pixels = image.pixels().map(|pixel| Vec3::from(pixel.0));
    Film::from_pixels(width, height, pixels.collect())
}

fn paste(picture: &Picture, (x, y): (u32, u32), onto: &mut Picture) {
    let start = 3 * (y * onto.width + x) as usize;
    let rows = onto.samples[start..].chunks_mut(3 * onto.width as usize);
    let columns = 3 * picture.width as usize;
    for (row, from) in rows.zip(picture.samples.chunks_exact(columns)) {
        row[..columns].copy_from_slice(from);
    }
}

/// Where frames are on a sheet: rows from the top, each from the left.
#[derive(Debug)]
struct Grid {
    columns: u32,
    rows: u32,
    /// Columns and rows of a frame, in pixels.
    frame: (u32, u32),
}

impl Grid {
    /// A grid of about as many frames across as down; of two at least, as the head needs room.
    fn new(count: u32, (width, height): (u32, u32)) -> Grid {
        let columns = f64::from(count).sqrt().ceil().max(2.0) as u32;
        let [width, height] = [width, height].map(f64::from);
        let scale = (f64::from(COLUMNS) / width).min(f64::from(MOST_ROWS) / height);
        let scaled = |length: f64| (scale * length).round().max(1.0) as u32;
        Grid {
            columns,
            rows: count.div_ceil(columns),
            frame: (scaled(width), scaled(height)),
        }
    }

    /// From one frame to the next.
    fn step(&self) -> (u32, u32) {
        (COLUMNS + MARGIN, self.frame.1 + LABEL + MARGIN)
    }

    /// Columns and rows of the sheet, in pixels.
    fn size(&self) -> (u32, u32) {
        let (x, y) = self.step();
        (self.columns * x + MARGIN, HEAD + self.rows * y)
    }

    /// Where a frame and its label are, from the left and from the top, by its number on the sheet.
    fn tile(&self, number: u32) -> (u32, u32) {
        let (x, y) = self.step();
        let (column, row) = (number % self.columns, number / self.columns);
        (MARGIN + column * x, HEAD + row * y)
    }

    /// The upper left pixel of a frame: it is in the middle of its tile.
    fn place(&self, number: u32) -> (u32, u32) {
        let (x, y) = self.tile(number);
        (x + (COLUMNS - self.frame.0) / 2, y)
    }
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

    #[test]
    fn frames_keep_their_shape_and_do_not_meet() {
        for (count, size) in [
            (0, (1280, 720)),
            (1, (7, 7)),
            (5, (720, 1280)),
            (30, (640, 360)),
            (30, (1, 32_768)),
            (9, (32_768, 1)),
        ] {
            let grid = Grid::new(count, size);
            let (columns, rows) = grid.frame;
            let error = f64::from(columns * size.1) - f64::from(rows * size.0);
            // Half a pixel of each, or one pixel where there has to be one.
            let rounding = f64::from(size.0.max(size.1));
            assert!(error.abs() <= rounding, "{size:?}: {:?}", grid.frame);
            let (width, height) = grid.size();
            let mut taken = vec![false; (width * height) as usize];
            for number in 0..count {
                let (left, top) = grid.place(number);
                assert!(left + columns <= width && top + rows + LABEL <= height);
                for y in top..top + rows + LABEL {
                    for x in left..left + columns {
                        let taken = &mut taken[(y * width + x) as usize];
                        assert!(!std::mem::replace(taken, true), "{size:?}: {number}");
                    }
                }
            }
        }
    }

    /// Stripes of black and white are grey of half the light, whatever their codes are.
    #[test]
    fn frames_are_made_small_in_linear_light() {
        let pixels = (0..64 * 8).map(|i| Vec3::splat(if i % 2 == 0 { 0.0 } else { 9.0 }));
        let small = scaled(&Film::from_pixels(64, 8, pixels.collect()), (8, 1));
        for pixel in &small.pixels()[1..7] {
            assert!((pixel - 0.5).abs().max_element() < 1e-3, "{pixel}");
        }
    }
}
