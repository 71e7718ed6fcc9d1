//! What a glTF file contains of nodes, cameras and animations, reduced to the core of glTF 2.0.

use super::super::json;
use crate::input::InputError;
use crate::input::check::Checker;
use serde_json::{Map, Value};
use std::path::Path;

/// The first bytes of a binary file.
pub(in super::super) const MAGIC: &[u8] = b"glTF";

/// The keys that are kept of a file, and of each of its nodes.
const OF_FILE: [&str; 7] = [
    "asset",
    "nodes",
    "cameras",
    "animations",
    "accessors",
    "bufferViews",
    "buffers",
];
const OF_NODE: [&str; 7] = [
    "name",
    "children",
    "camera",
    "matrix",
    "translation",
    "rotation",
    "scale",
];

/// The nodes, cameras and animations of a glTF file.
pub(super) struct GltfNodes {
    /// JSON in the core of glTF, without extensions.
    pub(super) text: Vec<u8>,
    /// The binary chunk of a `.glb` file.
    pub(super) blob: Option<Vec<u8>>,
    /// The animations of fields of view, which the core of glTF does not have.
    pub(super) fov_animations: Vec<FovAnimation>,
}

/// An animation of a camera's field of view (KHR_animation_pointer), by indices.
pub(super) struct FovAnimation {
    pub(super) animation: usize,
    pub(super) sampler: usize,
    pub(super) camera: usize,
}

/// Reduces a file's bytes to nodes, cameras and animations, and refuses animations that the gltf crate does not check.
pub(super) fn gltf_nodes(file: &Path, bytes: &[u8]) -> Result<GltfNodes, InputError> {
    let check = Checker { file };
    let (text, blob) = match bytes.starts_with(MAGIC) {
        true => match chunks(bytes) {
            Some((text, blob)) => (text, blob.map(<[u8]>::to_vec)),
            None => return check.refuse("glTF", "is no binary glTF 2.0 file, or is cut short"),
        },
        false => (bytes, None),
    };
    let mut all: Map<String, Value> = json::parse(file, text)?;
    all.retain(|key, _| OF_FILE.contains(&key.as_str()));
    for node in entries(all.get_mut("nodes")) {
        node.retain(|key, _| OF_NODE.contains(&key.as_str()));
    }
    let nodes = all
        .get("nodes")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    let mut fov_animations = Vec::new();
    for (animation, entry) in entries(all.get_mut("animations")).enumerate() {
        let Some(Value::Array(channels)) = entry.get_mut("channels") else {
            continue;
        };
        channels.retain_mut(|channel| match target_of(channel) {
            Target::Node => true,
            Target::FieldOfView { sampler, camera } => {
                fov_animations.push(FovAnimation {
                    animation,
                    sampler,
                    camera,
                });
                false
            }
            Target::Other => false,
        });
        if let Some(key) = invalid_key(entry, nodes) {
            let name = format!("animations[{animation}].{key}");
            return check.refuse(&name, "is not a valid value");
        }
    }
    Ok(GltfNodes {
        text: Value::Object(all).to_string().into_bytes(),
        blob,
        fov_animations,
    })
}

/// The first key of an animation whose value is invalid, of those that the gltf crate does not check.
fn invalid_key(animation: &Map<String, Value>, nodes: usize) -> Option<String> {
    let list = |key: &str| animation.get(key)?.as_array();
    let channels = list("channels").into_iter().flatten().enumerate();
    for (i, channel) in channels {
        let target = &channel["target"];
        if target["node"]
            .as_u64()
            .is_none_or(|node| node >= nodes as u64)
        {
            return Some(format!("channels[{i}].target.node"));
        }
        let path = target["path"].as_str().unwrap_or_default();
        if !["translation", "rotation", "scale"].contains(&path) {
            return Some(format!("channels[{i}].target.path"));
        }
    }
    let samplers = list("samplers").into_iter().flatten().enumerate();
    for (i, sampler) in samplers {
        let interpolation = sampler.get("interpolation").map(|kind| kind.as_str());
        if !matches!(
            interpolation,
            None | Some(Some("LINEAR" | "STEP" | "CUBICSPLINE"))
        ) {
            return Some(format!("samplers[{i}].interpolation"));
        }
    }
    None
}

/// The objects of a list.
fn entries(list: Option<&mut Value>) -> impl Iterator<Item = &mut Map<String, Value>> {
    let entries = list.and_then(Value::as_array_mut).into_iter().flatten();
    entries.filter_map(Value::as_object_mut)
}

/// The target of a channel.
enum Target {
    /// A node.
    Node,
    FieldOfView {
        sampler: usize,
        camera: usize,
    },
    /// Anything that does not move a camera.
    Other,
}

/// The target of a channel. A pointer to a property of a node is rewritten to the core of glTF.
fn target_of(channel: &mut Value) -> Target {
    let kind = &channel["target"]["path"];
    if kind == "weights" {
        return Target::Other;
    }
    if kind != "pointer" {
        return Target::Node;
    }
    let pointer = &channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"];
    let pointer = pointer.as_str().unwrap_or_default().to_owned();
    let parts: Vec<&str> = pointer.split('/').skip(1).collect();
    let sampler = channel["sampler"].as_u64().map(|sampler| sampler as usize);
    match (parts.as_slice(), sampler) {
        (["cameras", camera, "perspective", "yfov"], Some(sampler)) => match camera.parse() {
            Ok(camera) => Target::FieldOfView { sampler, camera },
            Err(_) => Target::Other,
        },
        (["nodes", node, part @ ("translation" | "rotation" | "scale")], _) => {
            let Ok(node) = node.parse::<u32>() else {
                return Target::Other;
            };
            channel["target"] = serde_json::json!({"node": node, "path": part});
            Target::Node
        }
        _ => Target::Other,
    }
}

/// The JSON of a binary glTF file and, if there is one, its buffer (glTF 2.0 specification, section 4.4).
fn chunks(bytes: &[u8]) -> Option<(&[u8], Option<&[u8]>)> {
    const VERSION: [u8; 4] = 2_u32.to_le_bytes();
    // Magic, version and the length of the file come first.
    let (text, rest) = chunk(bytes.get(12..)?, b"JSON")?;
    let blob = match rest {
        [] => None,
        rest => Some(chunk(rest, b"BIN\0")?.0),
    };
    (bytes[4..8] == VERSION).then_some((text, blob))
}

/// The content of a chunk of a kind, and the bytes after it.
fn chunk<'a>(bytes: &'a [u8], kind: &[u8; 4]) -> Option<(&'a [u8], &'a [u8])> {
    let length = u32::from_le_bytes(*bytes.first_chunk()?);
    let content = bytes.get(4..)?.strip_prefix(kind)?;
    content.split_at_checked(length as usize)
}
