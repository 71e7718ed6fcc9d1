//! The layout of the sheet.

use super::region::Region;
use super::view::View;

/// Columns and rows of the sheet, in pixels.
pub(super) const SIZE: (u32, u32) = (1200, 1000);

/// Units of the sheet in a pixel: plotters rounds to whole units.
const UNITS: u32 = 4;

/// A length in pixels as one in units of the sheet.
pub(super) fn px(pixels: u32) -> u32 {
    UNITS * pixels
}

/// A rectangle of the sheet, in pixels from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

/// The cells of the sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) plan: Cell,
    pub(super) elevation: Cell,
    pub(super) charts: Cell,
}

/// The title and the legend, in all layouts.
pub(super) const HEAD: Cell = cell(0, 0, 1200, 60);

/// For paths that are long, square and wide, seen from above.
const LAYOUTS: [Layout; 3] = [
    Layout {
        plan: cell(0, 60, 500, 940),
        elevation: cell(500, 60, 700, 380),
        charts: cell(500, 440, 700, 560),
    },
    Layout {
        plan: cell(0, 60, 600, 550),
        elevation: cell(600, 60, 600, 550),
        charts: cell(0, 610, 1200, 390),
    },
    Layout {
        plan: cell(0, 60, 1200, 370),
        elevation: cell(0, 430, 1200, 230),
        charts: cell(0, 660, 1200, 340),
    },
];

const fn cell(x: u32, y: u32, width: u32, height: u32) -> Cell {
    Cell {
        x,
        y,
        width,
        height,
    }
}

impl Cell {
    /// The cell without margins.
    pub(super) fn inside(&self, left: u32, top: u32, right: u32, bottom: u32) -> Cell {
        Cell {
            x: self.x + left,
            y: self.y + top,
            width: self.width - left - right,
            height: self.height - top - bottom,
        }
    }

    /// Equal parts of the cell, one below the other.
    pub(super) fn rows(&self, count: u32) -> impl Iterator<Item = Cell> {
        let (all, height) = (*self, self.height / count);
        (0..count).map(move |row| Cell {
            y: all.y + row * height,
            height,
            ..all
        })
    }
}

impl Layout {
    /// The layout that shows plan and elevation of a region largest.
    pub(super) fn of(region: &Region) -> Layout {
        let size = region.shown.size();
        let scale = |view: &View, cell: &Cell| {
            let size = view.flat(size);
            (f64::from(cell.width) / size.x).min(f64::from(cell.height) / size.y)
        };
        let both = |layout: &Layout| {
            scale(&View::PLAN, &layout.plan) * scale(&region.elevation, &layout.elevation)
        };
        let mut best = LAYOUTS[0];
        for layout in &LAYOUTS[1..] {
            if both(layout) > both(&best) {
                best = *layout;
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_fill_the_sheet_and_do_not_overlap() {
        for layout in LAYOUTS {
            let all = [HEAD, layout.plan, layout.elevation, layout.charts];
            let area = |cell: &Cell| cell.width * cell.height;
            assert_eq!(all.iter().map(area).sum::<u32>(), SIZE.0 * SIZE.1);
            for (number, a) in all.iter().enumerate() {
                assert!(a.x + a.width <= SIZE.0 && a.y + a.height <= SIZE.1);
                for b in &all[..number] {
                    let apart = |a: u32, width: u32, b: u32| a + width <= b;
                    assert!(
                        apart(a.x, a.width, b.x)
                            || apart(b.x, b.width, a.x)
                            || apart(a.y, a.height, b.y)
                            || apart(b.y, b.height, a.y)
                    );
                }
            }
        }
    }
}
