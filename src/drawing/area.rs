//! What plotters draws on, and a drawing that it cannot make.

use plotters::coord::Shift;
use plotters::drawing::DrawingArea;
use plotters::prelude::{IntoDrawingArea, SVGBackend};
use std::error::Error;

/// A drawing area of plotters, in units of the SVG file.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Whether plotters has drawn.
pub(super) type Drawn = Result<(), Box<dyn Error>>;

/// A drawing that cannot be made.
#[derive(Debug, thiserror::Error)]
#[error("{what}: {reason}")]
pub struct DrawingError {
    what: String,
    reason: String,
}

impl DrawingError {
    pub(super) fn new(what: impl Into<String>, reason: impl ToString) -> DrawingError {
        DrawingError {
            what: what.into(),
            reason: reason.to_string(),
        }
    }
}

/// The text of an SVG file of `size` columns and rows.
pub(super) fn svg_of(
    size: (u32, u32),
    draw: impl FnOnce(&Area) -> Drawn,
) -> Result<String, Box<dyn Error>> {
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    draw(&area)?;
    area.present()?;
    drop(area);
    Ok(svg)
}
