//! The part of a sheet that is drawn on.

use plotters::coord::Shift;
use plotters::drawing::DrawingArea;
use plotters::prelude::SVGBackend;
use std::error::Error;

/// A drawing area of plotters, in units of the sheet.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Whether plotters has drawn.
pub(super) type Drawn = Result<(), Box<dyn Error>>;
