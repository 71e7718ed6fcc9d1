//! Samples an animated camera of a glTF file at every frame.

use super::super::MAX_FRAMES;
use super::buffers::GltfBuffers;
use super::nodes::{FovAnimation, GltfNodes, gltf_nodes};
use super::sampler::GltfSampler;
use crate::camera::{Camera, FrameCameras, Timeline};
use crate::input::InputError;
use crate::input::check::Checker;
use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::animation::Property;
use gltf::camera::Projection;
use std::collections::BTreeMap;
use std::path::Path;

/// A node on the way from the scene's root to the camera.
struct AnimatedNode {
    /// The transform to its parent, if it is not animated.
    rest: DMat4,
    /// Translation, rotation and scale at rest, and their animations.
    parts: [(DVec4, Option<GltfSampler>); 3],
}

/// The cameras of a file's bytes at `fps` frames per second, from the first key of the camera's animation to the last.
/// Of several cameras that of `name`, or the only one that is animated.
pub(in super::super) fn parse(
    file: &Path,
    bytes: &[u8],
    fps: f64,
    name: Option<&str>,
) -> Result<FrameCameras, InputError> {
    let check = Checker { file };
    let GltfNodes {
        text,
        blob,
        fov_animations,
    } = gltf_nodes(file, bytes)?;
    let document = match gltf::Gltf::from_slice(&text) {
        Ok(gltf) => gltf.document,
        Err(error) => return check.refuse("glTF", error.to_string()),
    };
    let (node, camera) = choose(check, &document, &fov_animations, name)?;
    let Projection::Perspective(perspective) = camera.projection() else {
        return check.refuse(
            "cameras",
            "is orthographic; only perspective can be rendered",
        );
    };
    let mut buffers = GltfBuffers::new(file, blob);
    let mut nodes = Vec::new();
    for node in &ancestry(check, &document, &node)? {
        nodes.push(AnimatedNode::read(&document, node, &mut buffers)?);
    }
    let mut zoom = None;
    let is_of_camera = |fov: &&FovAnimation| fov.camera == camera.index();
    for fov in fov_animations.iter().filter(is_of_camera) {
        let name = format!("animations[{}].samplers[{}]", fov.animation, fov.sampler);
        let animation = document.animations().nth(fov.animation);
        let sampler = animation.and_then(|animation| animation.samplers().nth(fov.sampler));
        let Some(sampler) = sampler else {
            return check.refuse(&name, "is missing");
        };
        let read = GltfSampler::read(&sampler, &name, 1, &mut buffers)?;
        if zoom.replace(read).is_some() {
            return check.refuse(
                &name,
                "animates the same property as another animation; keep one of them",
            );
        }
    }

    let moving = nodes.iter().flat_map(|node| &node.parts);
    let moving = moving.filter_map(|(_, sampler)| sampler.as_ref());
    let samplers = moving.chain(&zoom);
    let spans = samplers.clone().map(GltfSampler::span);
    let span = spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let [start, end] = span.unwrap_or([0.0, 0.0]);
    if (end - start) * fps > f64::from(MAX_FRAMES) {
        return check.refuse("animations", format!("give more than {MAX_FRAMES} frames"));
    }
    let timeline = Timeline::of_whole_frames(fps, start, end);
    let frame = |frame: u32| {
        let time = timeline.time_of(frame);
        let fov = match &zoom {
            Some(sampler) => sampler.at(time).x,
            None => perspective.yfov().into(),
        };
        let to_world = nodes
            .iter()
            .fold(DMat4::IDENTITY, |to_world, node| to_world * node.at(time));
        camera_of(check, to_world, fov, time)
    };
    let samplers: Vec<&GltfSampler> = samplers.collect();
    let is_cut = |frame: &u32| {
        let [time, next] = [*frame, frame + 1].map(|frame| timeline.time_of(frame));
        samplers.iter().any(|sampler| sampler.jumps(time, next))
    };
    let count = timeline.frame_count();
    let cuts = (0..count - 1).filter(is_cut);
    Ok(FrameCameras {
        fps,
        start: timeline.start,
        cuts: cuts.map(|frame| frame as usize).collect(),
        cameras: (0..count).map(frame).collect::<Result<_, _>>()?,
        is_closed: false,
    })
}

/// The node of the camera to be imported.
fn choose<'a>(
    check: Checker,
    document: &'a gltf::Document,
    fov_animations: &[FovAnimation],
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
            let nodes = ancestry(check, document, node).unwrap_or_default();
            let channels = document
                .animations()
                .flat_map(|animation| animation.channels());
            let mut targets = channels.map(|channel| channel.target().node().index());
            targets.any(|target| nodes.iter().any(|node| node.index() == target))
                || fov_animations
                    .iter()
                    .any(|fov| fov.camera == camera.index())
        };
        cameras.retain(is_moved);
    }
    match cameras.len() {
        1 => Ok(cameras.remove(0)),
        _ => check.refuse("cameras", format!("choose one by --camera: {names}")),
    }
}

/// The nodes from the scene's root to this one.
fn ancestry<'a>(
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
    let mut nodes = vec![node.clone()];
    while let Some(parent) = parents.get(&nodes[nodes.len() - 1].index()) {
        if nodes.len() > parents.len() {
            return check.refuse("nodes", "a node is its own ancestor");
        }
        nodes.push(parent.clone());
    }
    nodes.reverse();
    Ok(nodes)
}

impl AnimatedNode {
    fn read(
        document: &gltf::Document,
        node: &gltf::Node,
        buffers: &mut GltfBuffers,
    ) -> Result<AnimatedNode, InputError> {
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
                    let message = format!(
                        "animates the same property of \"{node}\" as another sampler; keep one of them"
                    );
                    return buffers.refuse(&name, message);
                }
            }
        }
        let matrix = DMat4::from_cols_array_2d(&rest.matrix().map(|column| column.map(f64::from)));
        Ok(AnimatedNode {
            rest: matrix,
            parts,
        })
    }

    /// The transform to its parent at a time.
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

/// The camera with a transform to the world, whose scale is ignored.
fn camera_of(check: Checker, to_world: DMat4, fov: f64, time: f64) -> Result<Camera, InputError> {
    let [up, backward, position] =
        [to_world.y_axis, to_world.z_axis, to_world.w_axis].map(|axis| axis.truncate());
    if !(fov > 0.0 && fov < std::f64::consts::PI) {
        let message = format!("{fov} at {time} s; a field of view lies between 0 and pi");
        return check.refuse("yfov", message);
    }
    let volume = up.cross(backward).dot(to_world.x_axis.truncate());
    if !(volume > 0.0 && position.is_finite()) {
        let message = format!("the camera is mirrored or without size at {time} s");
        return check.refuse("nodes", message);
    }
    Ok(Camera::from_axes(position, backward, up, fov))
}
