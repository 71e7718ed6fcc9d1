//! The plot of a camera path through a scene: a plan, an elevation, and charts of speed, turn rate and zoom.
//!
//! Knows nothing of files or terminals.

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

use super::area::DrawingError;
use crate::camera::CameraPath;
use crate::scene::Scene;
use crate::text::visible;
use motion::Motion;
use region::Region;
use sheet::Sheet;

/// The text of an SVG file that plots a camera path through a scene.
///
/// The plan is a section just above the highest position of the camera, seen from above. The elevation is a section
/// just in front of the path, seen from the side, across the longer horizontal axis of the path and of what it looks
/// at. Both show the path and its surroundings, up to a few times its own extent. `aspect` is the width of a frame over
/// its height. `title` stands above.
pub fn plot(
    scene: &Scene,
    path: &CameraPath,
    aspect: f64,
    title: &str,
) -> Result<String, DrawingError> {
    let title = visible(title);
    let motion = Motion::of(path, aspect);
    let region = Region::of(scene, &motion);
    let sheet = Sheet::new(&motion, &region, &title);
    sheet
        .to_svg(scene)
        .map_err(|error| DrawingError::new("the plot of a camera path", error))
}
