//! Animated cameras of glTF 2.0 files, as Blender exports them: `.gltf` and `.glb`.
//!
//! Everything but nodes, cameras and their animations is ignored, whatever extensions it requires.

mod buffers;
mod nodes;
mod reader;
mod sampler;
mod writer;

pub(super) use nodes::MAGIC;
pub(super) use reader::parse;
pub(super) use writer::{GltfContainer, to_gltf};
