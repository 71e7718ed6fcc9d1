//! Contact sheets: small frames side by side, each with its number and its time, to see a whole camera move at once.

use super::area::DrawingError;
use super::svg::{self, escaped};
use crate::film::Film;
use glam::Vec3;
use image::imageops::{FilterType, replace, resize};
use image::{Rgb, Rgb32FImage, RgbImage};
use rayon::prelude::*;
use std::fmt::Write;

/// What a contact sheet shows beside the pixels of its frames.
#[derive(Clone, Debug)]
pub struct ContactSheet<'a> {
    /// The heading.
    pub title: &'a str,
    /// The line below the heading.
    pub caption: String,
    /// The label below each frame, at its left and at its right end.
    pub labels: Vec<[String; 2]>,
    /// Columns and rows of the frames before they are scaled down.
    pub frame_size: (u32, u32),
}

/// The width of a tile in pixels, as all that follows.
const COLUMNS: u32 = 240;

/// The greatest height of a frame: a taller one is narrower than its tile.
const MAX_ROWS: u32 = 480;

/// Space between tiles, and around them.
const MARGIN: u32 = 10;

/// The height of the heading.
const HEAD: u32 = 62;

/// The height of the label below each frame.
const LABEL: u32 = 22;

impl ContactSheet<'_> {
    /// Draws the sheet. `frame` gives the frame of a label by its index, or a short text to stand in its place; it is
    /// called on all threads of the current pool.
    pub fn draw(
        &self,
        frame: impl Fn(usize) -> Result<Film, String> + Sync,
    ) -> Result<RgbImage, DrawingError> {
        let grid = Grid::new(self.labels.len() as u32, self.frame_size);
        let numbers = (0..self.labels.len()).into_par_iter();
        let tiles: Vec<_> = numbers
            .map(|number| Ok(encoded(&scaled(&frame(number)?, grid.frame))))
            .collect();
        let drawn = svg::pixels(&self.svg(&grid, &tiles))
            .map_err(|error| DrawingError::new("contact sheet", error))?;
        let pixels = drawn.data().as_chunks::<4>().0;
        let mut sheet = RgbImage::from_fn(drawn.width(), drawn.height(), |x, y| {
            let [r, g, b, _] = pixels[(y * drawn.width() + x) as usize];
            Rgb([r, g, b])
        });
        for (number, tile) in (0..).zip(&tiles) {
            if let Ok(tile) = tile {
                let (x, y) = grid.frame_corner(number);
                replace(&mut sheet, tile, x.into(), y.into());
            }
        }
        Ok(sheet)
    }

    /// All but the frames.
    fn svg(&self, grid: &Grid, tiles: &[Result<RgbImage, String>]) -> String {
        let (width, height) = grid.size();
        let mut svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"
                font-family="sans-serif" font-size="13" fill="#dddddd">
            <rect width="{width}" height="{height}" fill="#202020"/>
            <text x="{MARGIN}" y="28" font-size="20">{}</text>
            <text x="{MARGIN}" y="50" fill="#999999">{}</text>"##,
            escaped(self.title),
            escaped(&self.caption),
        );
        for ((number, [left, right]), tile) in (0..).zip(&self.labels).zip(tiles) {
            let (x, y) = grid.tile_corner(number);
            let (end, below) = (x + COLUMNS, y + grid.frame.1 + 16);
            let _ = write!(
                svg,
                r##"<text x="{x}" y="{below}">{}</text>
                <text x="{end}" y="{below}" text-anchor="end" fill="#999999">{}</text>"##,
                escaped(left),
                escaped(right),
            );
            if let Err(text) = tile {
                let (left, top) = grid.frame_corner(number);
                let (columns, rows) = grid.frame;
                let (center, middle) = (x + COLUMNS / 2, y + rows / 2 + 4);
                let _ = write!(
                    svg,
                    r##"<rect x="{left}" y="{top}" width="{columns}" height="{rows}" fill="#303030"/>
                    <text x="{center}" y="{middle}" text-anchor="middle" fill="#e69f00">{}</text>"##,
                    escaped(text)
                );
            }
        }
        svg + "</svg>"
    }
}

/// A film of another size, filtered in linear light, clipped to display white first.
fn scaled(film: &Film, (width, height): (u32, u32)) -> Film {
    let pixels = film.pixels().iter();
    let channels = pixels.flat_map(|pixel| pixel.clamp(Vec3::ZERO, Vec3::ONE).to_array());
    let image = Rgb32FImage::from_raw(film.width(), film.height(), channels.collect())
        .expect("three channels of each pixel");
    let image = resize(&image, width, height, FilterType::Triangle);
    let pixels = image.pixels().map(|pixel| Vec3::from(pixel.0));
    Film::from_pixels(width, height, pixels.collect())
}

/// The sRGB codes of a film.
fn encoded(film: &Film) -> RgbImage {
    RgbImage::from_raw(film.width(), film.height(), film.to_srgb8())
        .expect("three channels of each pixel")
}

/// The layout of a sheet: rows of tiles from the top, each from the left.
#[derive(Debug)]
struct Grid {
    columns: u32,
    rows: u32,
    /// Columns and rows of a scaled frame, in pixels.
    frame: (u32, u32),
}

impl Grid {
    /// A grid of about as many tiles across as down; at least two across, as the heading needs room.
    fn new(count: u32, (width, height): (u32, u32)) -> Grid {
        let columns = f64::from(count).sqrt().ceil().max(2.0) as u32;
        let [width, height] = [width, height].map(f64::from);
        let scale = (f64::from(COLUMNS) / width).min(f64::from(MAX_ROWS) / height);
        let scaled = |length: f64| (scale * length).round().max(1.0) as u32;
        Grid {
            columns,
            rows: count.div_ceil(columns),
            frame: (scaled(width), scaled(height)),
        }
    }

    /// The distance from a tile to the next one, across and down.
    fn step(&self) -> (u32, u32) {
        (COLUMNS + MARGIN, self.frame.1 + LABEL + MARGIN)
    }

    /// Columns and rows of the sheet, in pixels.
    fn size(&self) -> (u32, u32) {
        let (x, y) = self.step();
        (self.columns * x + MARGIN, HEAD + self.rows * y)
    }

    /// The upper left pixel of a tile, by its number on the sheet.
    fn tile_corner(&self, number: u32) -> (u32, u32) {
        let (x, y) = self.step();
        let (column, row) = (number % self.columns, number / self.columns);
        (MARGIN + column * x, HEAD + row * y)
    }

    /// The upper left pixel of a frame, which is centred in its tile.
    fn frame_corner(&self, number: u32) -> (u32, u32) {
        let (x, y) = self.tile_corner(number);
        (x + (COLUMNS - self.frame.0) / 2, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_keep_their_aspect_and_do_not_overlap() {
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
                let (left, top) = grid.frame_corner(number);
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

    /// Stripes of black and white become half the light, whatever their codes are.
    #[test]
    fn frames_are_scaled_in_linear_light() {
        let pixels = (0..64 * 8).map(|i| Vec3::splat(if i % 2 == 0 { 0.0 } else { 9.0 }));
        let small = scaled(&Film::from_pixels(64, 8, pixels.collect()), (8, 1));
        for pixel in &small.pixels()[1..7] {
            assert!((pixel - 0.5).abs().max_element() < 1e-3, "{pixel}");
        }
    }
}
