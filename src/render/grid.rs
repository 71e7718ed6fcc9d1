//! The points of a film that are sampled, in tiles.

use super::{PixelSampling, RenderSettings};
use glam::Vec3;
use std::ops::Range;

/// Columns and rows of points in a tile: small enough that all threads are busy, large enough that neighbouring points
/// find their data in the processor's cache.
const TILE: u32 = 16;

/// The sampled points of a film: its pixels, or their corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Grid {
    pub(super) fn of(settings: &RenderSettings) -> Grid {
        let more = u32::from(settings.sampling == PixelSampling::Corners);
        Grid {
            width: settings.width + more,
            height: settings.height + more,
        }
    }

    pub(super) fn len(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The index of a point, row by row from the top left.
    pub(super) fn index(self, (x, y): (u32, u32)) -> usize {
        y as usize * self.width as usize + x as usize
    }

    pub(super) fn tiles(self) -> u64 {
        u64::from(self.width.div_ceil(TILE)) * u64::from(self.height.div_ceil(TILE))
    }

    /// The points of a row of tiles; fewer in the last one.
    pub(super) fn points_per_tile_row(self) -> usize {
        self.width as usize * TILE as usize
    }

    /// The tiles of a row of tiles.
    pub(super) fn tiles_of_row(self, row: usize) -> Range<u64> {
        let tiles = u64::from(self.width.div_ceil(TILE));
        row as u64 * tiles..(row as u64 + 1) * tiles
    }

    /// The points of a tile in Morton order, so that rays that are traced together are coherent.
    pub(super) fn tile_points(self, tile: u64) -> Vec<(u32, u32)> {
        let tiles_per_row = u64::from(self.width.div_ceil(TILE));
        let x0 = (tile % tiles_per_row) as u32 * TILE;
        let y0 = (tile / tiles_per_row) as u32 * TILE;
        (0..TILE * TILE)
            .map(|i| (x0 + every_second_bit(i), y0 + every_second_bit(i >> 1)))
            .filter(|(x, y)| *x < self.width && *y < self.height)
            .collect()
    }
}

/// Bits 0, 2, 4 and 6, side by side.
fn every_second_bit(bits: u32) -> u32 {
    (0..4).fold(0, |gathered, i| gathered | (bits >> (2 * i) & 1) << i)
}

/// Each pixel, of `width` in a row, becomes the mean of the four lattice points around it.
pub(super) fn average_corners(lattice: &[Vec3], width: u32, pixels: &mut [Vec3]) {
    let (width, stride) = (width as usize, width as usize + 1);
    for (y, row) in pixels.chunks_exact_mut(width).enumerate() {
        let (above, below) = lattice[y * stride..].split_at(stride);
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = 0.25 * ((above[x] + above[x + 1]) + (below[x] + below[x + 1]));
        }
    }
}
