//! Camera path files.
//!
//! ```ron
#![doc = include_str!("../../../paths/zoom.ron")]
//! ```

mod reader;
mod schema;
mod writer;

pub use reader::{CameraPathInput, load_camera_path, parse_camera_path};
pub use writer::camera_path_to_ron;
