//! A picture of a scene and of a camera path through it, to be read at a glance: a plan, an elevation, and how fast
//! the camera goes, turns and zooms.
//!
//! Knows the scene and the path, never files or terminals.

mod axis;
mod charts;
mod cutaway;
mod labels;
mod layout;
mod motion;
mod overlay;
mod panel;
mod region;
mod sheet;
mod view;

use crate::camera::CameraPath;
use crate::scene::Scene;
use motion::Motion;
use plotters::coord::Shift;
use plotters::drawing::DrawingArea;
use plotters::prelude::SVGBackend;
use region::Region;
use sheet::Sheet;
use std::error::Error;
use thiserror::Error;

/// A picture that cannot be drawn.
#[derive(Debug, Error)]
#[error("the plot of a camera path: {0}")]
pub struct PlotError(Box<dyn Error + Send + Sync>);

/// Where plotters draws, in units of the sheet.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

type Drawn = Result<(), Box<dyn Error>>;

/// The text of an SVG file that shows where the path leads through the scene, and how.
///
/// The plan is seen from above, cut open just above the highest position of the camera: what is higher is not
/// there. The elevation is seen from the side, across the longer horizontal axis of the path and of what it looks
/// at, cut open just in front of the path. Both show the path and what is around it, up to a few times its own
/// extent. `aspect` is the width of a frame over its height: how wide the camera sees. `title` stands above.
pub fn plot(
    scene: &Scene,
    path: &CameraPath,
    aspect: f64,
    title: &str,
) -> Result<String, PlotError> {
    // No SVG file can have them.
    let title = title.replace(char::is_control, " ");
    let motion = Motion::of(path, aspect);
    let region = Region::of(scene, &motion);
    let sheet = Sheet::new(&motion, &region, &title);
    sheet
        .to_svg(scene)
        .map_err(|error| PlotError(error.to_string().into()))
}
