//! Writes an animated camera as a glTF file.

use super::super::export_error::ExportError;
use crate::camera::FrameCameras;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::DQuat;
use serde_json::{Value, json};

/// Where a glTF file holds its buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum GltfContainer {
    /// In the JSON, in base64: `.gltf`.
    Text,
    /// In a binary chunk: `.glb`.
    Binary,
}

/// The greatest rounding of times, in frames.
const MAX_ROUNDING: f64 = 0.02;

/// The bytes of a glTF file with an animated camera that has a linear key for each frame; `aspect` is width over
/// height. Numbers are in single precision, as always in glTF. A field of view that changes is animated by
/// KHR_animation_pointer; programs without this extension use that of the first frame.
pub(in super::super) fn to_gltf(
    cameras: &FrameCameras,
    aspect: f64,
    container: GltfContainer,
) -> Result<Vec<u8>, ExportError> {
    let mut data = Data::default();
    let count = cameras.cameras.len();
    let end = cameras.time_of(count - 1);
    let rounding = 0.5 * f64::from(f32::EPSILON) * end.abs().max(cameras.start.abs());
    if count > 1 && rounding * cameras.fps > MAX_ROUNDING {
        return Err(ExportError::GltfTimes { end });
    }
    let times = (0..count).map(|frame| cameras.time_of(frame) as f32);
    let times: Vec<f32> = times.collect();
    let range = json!({"min": [times[0]], "max": [times[count - 1]]});
    let input = data.add("SCALAR", count, times.into_iter(), range);

    let of_each = cameras.cameras.iter();
    let positions: Vec<[f64; 3]> = of_each.clone().map(|c| c.position.to_array()).collect();
    let mut rotations: Vec<DQuat> = Vec::new();
    for camera in &cameras.cameras {
        let rotation = camera.quaternion();
        // The sign that is nearer to the last: not every reader takes the shorter way.
        let flips = rotations
            .last()
            .is_some_and(|last| last.dot(rotation) < 0.0);
        rotations.push(if flips { -rotation } else { rotation });
    }
    let fovs: Vec<f64> = of_each.map(|camera| camera.field_of_view()).collect();
    let single = |number: f64| number as f32;
    let translation = positions.iter().flatten().map(|&number| single(number));
    let translation = data.add("VEC3", count, translation, json!({}));
    let rotation = rotations.iter().flat_map(DQuat::to_array).map(single);
    let rotation = data.add("VEC4", count, rotation, json!({}));
    let mut samplers = vec![
        json!({"input": input, "output": translation, "interpolation": "LINEAR"}),
        json!({"input": input, "output": rotation, "interpolation": "LINEAR"}),
    ];
    let mut channels = vec![
        json!({"sampler": 0, "target": {"node": 0, "path": "translation"}}),
        json!({"sampler": 1, "target": {"node": 0, "path": "rotation"}}),
    ];
    let mut gltf = json!({
        "asset": {"version": "2.0", "generator": concat!("flythrough ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{
            "name": "Camera",
            "camera": 0,
            "translation": positions[0],
            "rotation": rotations[0].to_array(),
        }],
        "cameras": [{
            "name": "Camera",
            "type": "perspective",
            "perspective": {"yfov": fovs[0], "aspectRatio": aspect, "znear": 0.01},
        }],
    });
    if fovs.iter().any(|fov| *fov != fovs[0]) {
        let output = data.add("SCALAR", count, fovs.into_iter().map(single), json!({}));
        samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
        let pointer = json!({"KHR_animation_pointer": {"pointer": "/cameras/0/perspective/yfov"}});
        channels.push(json!({"sampler": 2, "target": {"path": "pointer", "extensions": pointer}}));
        gltf["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    }
    gltf["animations"] = json!([{"name": "Camera", "channels": channels, "samplers": samplers}]);
    gltf["accessors"] = Value::Array(data.accessors);
    gltf["bufferViews"] = Value::Array(data.views);
    gltf["buffers"] = json!([{"byteLength": data.bytes.len()}]);
    match container {
        GltfContainer::Text => {
            let encoded = BASE64_STANDARD.encode(&data.bytes);
            let uri = format!("data:application/octet-stream;base64,{encoded}");
            gltf["buffers"][0]["uri"] = uri.into();
            Ok(serde_json::to_vec_pretty(&gltf)?)
        }
        GltfContainer::Binary => Ok(binary(serde_json::to_vec(&gltf)?, data.bytes)),
    }
}

/// The buffer, its views and their accessors.
#[derive(Default)]
struct Data {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Data {
    /// Adds `count` elements and returns the index of their accessor, which gets `more` properties.
    fn add(
        &mut self,
        kind: &str,
        count: usize,
        numbers: impl Iterator<Item = f32>,
        more: Value,
    ) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(numbers.flat_map(f32::to_le_bytes));
        let length = self.bytes.len() - offset;
        let index = self.views.len();
        self.views
            .push(json!({"buffer": 0, "byteOffset": offset, "byteLength": length}));
        const FLOAT: u32 = 5126;
        let mut accessor =
            json!({"bufferView": index, "componentType": FLOAT, "count": count, "type": kind});
        if let (Some(accessor), Value::Object(more)) = (accessor.as_object_mut(), more) {
            accessor.extend(more);
        }
        self.accessors.push(accessor);
        index
    }
}

/// A binary glTF file: a header and two chunks, each padded to a multiple of 4 bytes (glTF 2.0 specification, section
/// 4.4).
fn binary(mut text: Vec<u8>, data: Vec<u8>) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + data.len();
    let mut bytes = Vec::with_capacity(length);
    let word = |number: usize| (number as u32).to_le_bytes();
    bytes.extend(b"glTF");
    bytes.extend(word(2));
    bytes.extend(word(length));
    for (kind, chunk) in [(b"JSON", text), (b"BIN\0", data)] {
        bytes.extend(word(chunk.len()));
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}
