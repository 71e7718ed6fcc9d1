//! Blocks of 8 x 8 pixels, fewer at the right and the lower end of a film.

use std::ops::Range;

/// Rows and columns of a block.
const SIDE: usize = 8;

/// The pixels of a block.
#[derive(Clone, Debug)]
pub(super) struct Block {
    columns: Range<usize>,
    rows: Range<usize>,
    /// Of the film.
    width: usize,
}

impl Block {
    /// All blocks of a film.
    pub(super) fn all(width: usize, height: usize) -> impl Iterator<Item = Block> {
        let rows = (0..height).step_by(SIDE);
        rows.flat_map(move |row| {
            let columns = (0..width).step_by(SIDE);
            columns.map(move |column| Block::of(row * width + column, width, height))
        })
    }

    /// The block of a pixel.
    pub(super) fn of(pixel: usize, width: usize, height: usize) -> Block {
        let range = |at: usize, size: usize| {
            let first = at / SIDE * SIDE;
            first..(first + SIDE).min(size)
        };
        Block {
            columns: range(pixel % width, width),
            rows: range(pixel / width, height),
            width,
        }
    }

    /// How many pixels it has.
    pub(super) fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// The indices of its pixels, row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = self.rows.clone();
        rows.flat_map(|row| {
            let first = row * self.width;
            first + self.columns.start..first + self.columns.end
        })
    }

    /// Another pixel of the block than `pixel`, by a number in 0..1; `pixel` itself if there is no other.
    pub(super) fn other(&self, pixel: usize, random: f32) -> usize {
        let number = self.pixels().position(|other| other == pixel);
        let more = (random * (self.len() - 1) as f32) as usize;
        let more = 1 + more.min(self.len().saturating_sub(2));
        self.pixel((number.unwrap_or(0) + more) % self.len())
    }

    fn pixel(&self, number: usize) -> usize {
        let (row, column) = (number / self.columns.len(), number % self.columns.len());
        (self.rows.start + row) * self.width + self.columns.start + column
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_pixel_is_in_one_block_of_its_own() {
        let (width, height) = (21, 10);
        let mut seen = BTreeSet::new();
        for block in Block::all(width, height) {
            for pixel in block.pixels() {
                assert!(seen.insert(pixel));
                let own = Block::of(pixel, width, height);
                assert!(own.pixels().eq(block.pixels()));
            }
        }
        assert!(seen.into_iter().eq(0..width * height));
    }

    #[test]
    fn the_others_are_all_others() {
        for pixel in [0, 37, 84, 209] {
            let block = Block::of(pixel, 21, 10);
            let count = block.len() - 1;
            let numbers = (0..count).map(|i| (i as f32 + 0.5) / count as f32);
            let others: BTreeSet<usize> = numbers.map(|u| block.other(pixel, u)).collect();
            assert_eq!(others.len(), count);
            assert!(!others.contains(&pixel));
            assert!(
                others
                    .into_iter()
                    .all(|other| block.pixels().any(|p| p == other))
            );
        }
        assert_eq!(Block::of(0, 1, 1).other(0, 0.999), 0);
    }
}
