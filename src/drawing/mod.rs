//! Pictures for people: charts, the plot of a camera path; as SVG, or as pixels of it.

pub mod chart;
pub mod path_plot;
pub mod svg;
