//! Camera paths in files: RON, glTF, nerfstudio and a table of cameras. The reader of a format stands beside its
//! writer.

mod export;
mod export_error;
mod gltf;
mod import;
mod json;
mod nerfstudio;
mod ron;
mod table;

pub use self::ron::{CameraPathInput, camera_path_to_ron, load_camera_path, parse_camera_path};
pub use export::{CameraFormat, export_cameras};
pub use export_error::ExportError;
pub use import::{CameraImport, import_cameras};
pub use table::camera_table;

/// The most frames of a path: more than a video of a day has.
const MAX_FRAMES: u32 = 10_000_000;
