//! Drawings: line charts, the plot of a camera path, contact sheets; as SVG, or as pixels of it.
//!
//! The only user of plotters and resvg.

mod area;
pub mod chart;
pub mod contact_sheet;
pub mod path_plot;
mod svg;

pub use area::DrawingError;
