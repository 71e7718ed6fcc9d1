//! Animated cameras of glTF files, as Blender exports them: `.gltf` and `.glb`.
//!
//! Everything but nodes, cameras and what moves them is passed over, whatever extensions it needs.

use super::camera_path_file::MOST_FRAMES;
use super::check::Checker;
use super::error::InputError;
use super::gltf_buffers::GltfBuffers;
use super::gltf_sampler::GltfSampler;
use crate::camera::{Camera, FrameCameras, Timeline};
use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::animation::Property;
use gltf::camera::Projection;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// A node of the chain from the scene's root to the camera.
struct Link {
    /// Its place in its parent, where nothing moves it.
    rest: DMat4,
    /// Translation, rotation and scale at rest, and what moves them.
    parts: [(DVec4, Option<GltfSampler>); 3],
}

/// A pointer to a camera's field of view, and what moves it.
struct Pointed {
    animation: usize,
    sampler: usize,
    camera: usize,
}

/// How binary files begin.
pub(super) const MAGIC: &[u8] = b"glTF";

/// The cameras of a file's bytes, so many in a second, from the first key of what moves the camera to the last. Of
/// several cameras the one of that name, else the only one that is animated.
pub(super) fn parse(
    file: &Path,
    bytes: &[u8],
    fps: f64,
    name: Option<&str>,
) -> Result<FrameCameras, InputError> {
    let check = Checker { file };
    let (text, blob) = match bytes.starts_with(MAGIC) {
        true => match chunks(bytes) {
            Some((text, blob)) => (text, blob.map(<[u8]>::to_vec)),
            None => return check.refuse("glTF", "is no binary glTF 2.0 file, or is cut short"),
        },
        false => (bytes, None),
    };
    let (text, pointed) = essence(file, text)?;
    let document = match gltf::Gltf::from_slice(&text) {
        Ok(gltf) => gltf.document,
        Err(error) => return check.refuse("glTF", error.to_string()),
    };
    let (node, camera) = choose(check, &document, &pointed, name)?;
    let Projection::Perspective(perspective) = camera.projection() else {
        return check.refuse(
            "cameras",
            "is orthographic; only perspective can be rendered",
        );
    };
    let mut buffers = GltfBuffers::new(file, blob);
    let chain = chain(check, &document, &node)?;
    let mut links = Vec::new();
    for node in &chain {
        links.push(Link::read(&document, node, &mut buffers)?);
    }
    let mut zoom = None;
    for pointed in pointed.iter().filter(|p| p.camera == camera.index()) {
        let name = format!(
            "animations[{}].samplers[{}]",
            pointed.animation, pointed.sampler
        );
        let animation = document.animations().nth(pointed.animation);
        let sampler = animation.and_then(|animation| animation.samplers().nth(pointed.sampler));
        let Some(sampler) = sampler else {
            return check.refuse(&name, "is missing");
        };
        let read = GltfSampler::read(&sampler, &name, 1, &mut buffers)?;
        if zoom.replace(read).is_some() {
            return check.refuse(
                &name,
                "moves what another animation moves; keep one of them",
            );
        }
    }

    let moving = links.iter().flat_map(|link| &link.parts);
    let moving = moving.filter_map(|(_, sampler)| sampler.as_ref());
    let spans = moving.chain(&zoom).map(GltfSampler::span);
    let span = spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let [start, end] = span.unwrap_or([0.0, 0.0]);
    if (end - start) * fps > f64::from(MOST_FRAMES) {
        return check.refuse("animations", format!("give more than {MOST_FRAMES} frames"));
    }
    let timeline = Timeline::of_whole_frames(fps, start, end);
    let frame = |frame: u32| {
        let time = timeline.time_of(frame);
        let fov = match &zoom {
            Some(sampler) => sampler.at(time).x,
            None => perspective.yfov().into(),
        };
        let place = links
            .iter()
            .fold(DMat4::IDENTITY, |place, link| place * link.at(time));
        camera_of(check, place, fov, time)
    };
    Ok(FrameCameras {
        fps,
        start: timeline.start,
        cameras: (0..timeline.frame_count())
            .map(frame)
            .collect::<Result<_, _>>()?,
    })
}

/// The JSON of a binary glTF file and, if there is one, its buffer (glTF 2.0 specification, section 4.4).
fn chunks(bytes: &[u8]) -> Option<(&[u8], Option<&[u8]>)> {
    const VERSION: [u8; 4] = 2_u32.to_le_bytes();
    // The length that comes before is that of the file.
    let (text, rest) = chunk(bytes.get(12..)?, b"JSON")?;
    let blob = match rest {
        [] => None,
        rest => Some(chunk(rest, b"BIN\0")?.0),
    };
    (bytes[4..8] == VERSION).then_some((text, blob))
}

/// What is in a chunk of a kind, and what comes after it.
fn chunk<'a>(bytes: &'a [u8], kind: &[u8; 4]) -> Option<(&'a [u8], &'a [u8])> {
    let length = u32::from_le_bytes(*bytes.first_chunk()?);
    let content = bytes.get(4..)?.strip_prefix(kind)?;
    content.split_at_checked(length as usize)
}

/// What of a file is about nodes, cameras and their animations, in the core of glTF, and the fields of view that
/// animations point to (KHR_animation_pointer).
fn essence(file: &Path, text: &[u8]) -> Result<(Vec<u8>, Vec<Pointed>), InputError> {
    let fault = |error: serde_json::Error| InputError::Syntax {
        file: file.to_owned(),
        line: error.line(),
        column: error.column(),
        message: error.to_string(),
    };
    let mut all: Map<String, Value> = serde_json::from_slice(text).map_err(fault)?;
    all.retain(|key, _| {
        [
            "asset",
            "nodes",
            "cameras",
            "animations",
            "accessors",
            "bufferViews",
            "buffers",
        ]
        .contains(&key.as_str())
    });
    for node in entries(all.get_mut("nodes")) {
        node.retain(|key, _| {
            [
                "name",
                "children",
                "camera",
                "matrix",
                "translation",
                "rotation",
                "scale",
            ]
            .contains(&key.as_str())
        });
    }
    let nodes = all
        .get("nodes")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    let mut pointed = Vec::new();
    for (animation, entry) in entries(all.get_mut("animations")).enumerate() {
        let Some(Value::Array(channels)) = entry.get_mut("channels") else {
            continue;
        };
        channels.retain_mut(|channel| match target_of(channel) {
            Target::Kept => true,
            Target::FieldOfView { sampler, camera } => {
                pointed.push(Pointed {
                    animation,
                    sampler,
                    camera,
                });
                false
            }
            Target::Other => false,
        });
        if let Some(fault) = fault_of(entry, nodes) {
            let name = format!("animations[{animation}].{fault}");
            return Checker { file }.refuse(&name, "is not one of those there can be");
        }
    }
    Ok((serde_json::to_vec(&all).map_err(fault)?, pointed))
}

/// What is wrong in an animation, of what the library takes on trust.
fn fault_of(animation: &Map<String, Value>, nodes: usize) -> Option<String> {
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

enum Target {
    /// A node, in the core of glTF.
    Kept,
    FieldOfView {
        sampler: usize,
        camera: usize,
    },
    /// What does not move a camera.
    Other,
}

/// What a channel moves. One that points to what the core has a name for is given that.
fn target_of(channel: &mut Value) -> Target {
    let kind = &channel["target"]["path"];
    if kind == "weights" {
        return Target::Other;
    }
    if kind != "pointer" {
        return Target::Kept;
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
            Target::Kept
        }
        _ => Target::Other,
    }
}

/// The node of the camera to be imported.
fn choose<'a>(
    check: Checker,
    document: &'a gltf::Document,
    pointed: &[Pointed],
    name: Option<&str>,
) -> Result<(gltf::Node<'a>, gltf::Camera<'a>), InputError> {
    let cameras = document
        .nodes()
        .filter_map(|node| Some((node.clone(), node.camera()?)));
    let mut cameras: Vec<_> = cameras.collect();
    let named = |(node, camera): &(gltf::Node, gltf::Camera)| {
        let name = node.name().or(camera.name()).unwrap_or_default();
        format!("\"{name}\"")
    };
    let names: Vec<String> = cameras.iter().map(named).collect();
    let names = names.join(", ");
    if cameras.is_empty() {
        return check.refuse("cameras", "there is none; export the camera, too");
    }
    if let Some(wanted) = name {
        cameras.retain(|(node, camera)| [node.name(), camera.name()].contains(&Some(wanted)));
    } else if cameras.len() > 1 {
        let is_moved = |(node, camera): &(gltf::Node, gltf::Camera)| {
            let chain = chain(check, document, node).unwrap_or_default();
            let channels = document
                .animations()
                .flat_map(|animation| animation.channels());
            let mut targets = channels.map(|channel| channel.target().node().index());
            targets.any(|target| chain.iter().any(|node| node.index() == target))
                || pointed
                    .iter()
                    .any(|pointed| pointed.camera == camera.index())
        };
        cameras.retain(is_moved);
    }
    match cameras.len() {
        1 => Ok(cameras.remove(0)),
        _ => check.refuse("cameras", format!("choose one by --camera: {names}")),
    }
}

/// The nodes from the scene's root to this one.
fn chain<'a>(
    check: Checker,
    document: &'a gltf::Document,
    node: &gltf::Node<'a>,
) -> Result<Vec<gltf::Node<'a>>, InputError> {
    let parents = document.nodes().flat_map(|parent| {
        let children: Vec<usize> = parent.children().map(|child| child.index()).collect();
        children
            .into_iter()
            .map(move |child| (child, parent.clone()))
    });
    let parents: BTreeMap<usize, gltf::Node> = parents.collect();
    let mut chain = vec![node.clone()];
    while let Some(parent) = parents.get(&chain[chain.len() - 1].index()) {
        if chain.len() > parents.len() {
            return check.refuse("nodes", "a node is its own ancestor");
        }
        chain.push(parent.clone());
    }
    chain.reverse();
    Ok(chain)
}

impl Link {
    fn read(
        document: &gltf::Document,
        node: &gltf::Node,
        buffers: &mut GltfBuffers,
    ) -> Result<Link, InputError> {
        let rest = node.transform();
        let (translation, rotation, scale) = rest.clone().decomposed();
        let vector = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), y.into(), z.into()).extend(0.0);
        let mut parts = [
            (vector(translation), None),
            (DVec4::from_array(rotation.map(f64::from)), None),
            (vector(scale), None),
        ];
        for animation in document.animations() {
            for channel in animation.channels() {
                let target = channel.target();
                if target.node().index() != node.index() {
                    continue;
                }
                let (part, components) = match target.property() {
                    Property::Translation => (0, 3),
                    Property::Rotation => (1, 4),
                    Property::Scale => (2, 3),
                    Property::MorphTargetWeights => continue,
                };
                let sampler = channel.sampler();
                let name = format!(
                    "animations[{}].samplers[{}]",
                    animation.index(),
                    sampler.index()
                );
                let read = GltfSampler::read(&sampler, &name, components, buffers)?;
                if parts[part].1.replace(read).is_some() {
                    let node = node.name().unwrap_or_default();
                    let message = format!("moves \"{node}\" as another does; keep one of them");
                    return buffers.refuse(&name, message);
                }
            }
        }
        let matrix = DMat4::from_cols_array_2d(&rest.matrix().map(|column| column.map(f64::from)));
        Ok(Link {
            rest: matrix,
            parts,
        })
    }

    /// Its place in its parent at a time.
    fn at(&self, time: f64) -> DMat4 {
        if self.parts.iter().all(|(_, sampler)| sampler.is_none()) {
            return self.rest;
        }
        let [translation, rotation, scale] = [0, 1, 2].map(|i| match &self.parts[i] {
            (_, Some(sampler)) => sampler.at(time),
            (rest, None) => *rest,
        });
        let rotation = DQuat::from_vec4(rotation.normalize_or(DVec4::W));
        DMat4::from_scale_rotation_translation(scale.truncate(), rotation, translation.truncate())
    }
}

/// The camera at a place in the scene: it does not know of scales.
fn camera_of(check: Checker, place: DMat4, fov: f64, time: f64) -> Result<Camera, InputError> {
    let [up, backward, position] =
        [place.y_axis, place.z_axis, place.w_axis].map(|axis| axis.truncate());
    if !(fov > 0.0 && fov < std::f64::consts::PI) {
        let message = format!("{fov} at {time} s; a field of view lies between 0 and pi");
        return check.refuse("yfov", message);
    }
    let spans = up.cross(backward).dot(place.x_axis.truncate());
    if !(spans > 0.0 && position.is_finite()) {
        let message = format!("the camera is mirrored or without size at {time} s");
        return check.refuse("nodes", message);
    }
    Ok(Camera::from_axes(position, backward, up, fov))
}
