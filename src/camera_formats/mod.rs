//! Camera paths in files: RON, glTF, nerfstudio and a table of cameras, each read beside written.

mod gltf_buffers;
mod gltf_nodes;
mod gltf_reader;
mod gltf_sampler;
mod gltf_writer;
mod import;
mod json_file;
mod nerfstudio_reader;
mod nerfstudio_writer;
mod ron_reader;
mod ron_writer;
mod table;

pub use gltf_writer::{GltfContainer, GltfError, gltf_file};
pub use import::{CameraImport, import_cameras};
pub use nerfstudio_writer::nerfstudio_json;
pub use ron_reader::{CameraPathInput, load_camera_path, parse_camera_path};
pub use ron_writer::camera_path_file;
pub use table::camera_table;
