//! Camera paths of nerfstudio's viewer: `camera_path.json`.
//!
//! ```json
//! {
//!   "camera_type": "perspective", "render_width": 1280, "render_height": 720, "fps": 30.0, "seconds": 8.0,
//!   "camera_path": [{"camera_to_world": [1.0, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0, 1.7, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 0.0, 1.0], "fov": 50.0}]
//! }
//! ```
//!
//! Matrices are row-major; fields of view are vertical, in degrees. The keys of the editor are not read: nerfstudio
//! renders the frames.

use super::json;
use crate::camera::{Camera, FrameCameras};
use crate::input::InputError;
use crate::input::Settings;
use crate::input::check::{Checker, MAX_MAGNITUDE};
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What is read of a file.
#[derive(Deserialize)]
struct PathInput {
    camera_type: Option<String>,
    render_width: Option<f64>,
    render_height: Option<f64>,
    fps: Option<f64>,
    seconds: Option<f64>,
    camera_path: Vec<FrameJson>,
}

/// What is written to a file.
#[derive(Serialize)]
struct PathOutput {
    default_fov: f64,
    default_transition_sec: f64,
    keyframes: Vec<KeyframeJson>,
    camera_type: &'static str,
    render_height: u32,
    render_width: u32,
    fps: f64,
    seconds: f64,
    is_cycle: bool,
    smoothness_value: f64,
    camera_path: Vec<FrameJson>,
}

/// A key, for the editor of the viewer.
#[derive(Serialize)]
struct KeyframeJson {
    matrix: Vec<f64>,
    fov: f64,
    aspect: f64,
    override_transition_enabled: bool,
    /// Seconds since the key before; for the first key of a loop since the last key, otherwise none.
    override_transition_sec: Option<f64>,
}

/// The camera of a frame.
#[derive(Deserialize, Serialize)]
struct FrameJson {
    camera_to_world: Vec<f64>,
    fov: f64,
    #[serde(skip_deserializing)]
    aspect: f64,
}

/// Types of cameras other than pinhole cameras. Nerfstudio takes any other name for a pinhole camera.
const OTHER_TYPES: [&str; 4] = ["fisheye", "equirectangular", "omnidirectional", "vr180"];

/// The cameras of a file's text, and the size of its frames if it gives one.
pub(super) fn parse(
    file: &Path,
    text: &[u8],
) -> Result<(FrameCameras, Option<(u32, u32)>), InputError> {
    let check = Checker { file };
    let parsed: PathInput = json::parse(file, text)?;
    let kind = parsed.camera_type.unwrap_or_default();
    if OTHER_TYPES.contains(&kind.to_lowercase().as_str()) {
        let message = format!("\"{kind}\"; only perspective cameras can be rendered");
        return check.refuse("camera_type", message);
    }
    if parsed.camera_path.is_empty() {
        let message = "has no frames; let nerfstudio's viewer write the file (Generate Command)";
        return check.refuse("camera_path", message);
    }
    let count = parsed.camera_path.len() as f64;
    // Nerfstudio itself renders these frames in `seconds`, whatever `fps` is.
    let fps = match (parsed.seconds, parsed.fps) {
        (Some(seconds), _) => count / check.positive("seconds", seconds)?,
        (None, Some(fps)) => check.positive("fps", fps)?,
        (None, None) => return check.refuse("seconds", "is missing, and so is fps"),
    };
    let frames = parsed.camera_path.iter().enumerate();
    let cameras = frames.map(|(i, frame)| camera(check, i, frame));
    let side = |key, pixels| {
        check
            .range(key, pixels, 1.0, f64::from(u32::MAX))
            .map(|side| side as u32)
    };
    let size = match (parsed.render_width, parsed.render_height) {
        (Some(width), Some(height)) => {
            Some((side("render_width", width)?, side("render_height", height)?))
        }
        _ => None,
    };
    let settings = Settings {
        size,
        ..Settings::default()
    };
    if let Err(error) = settings.check() {
        return check.refuse("render_width, render_height", error.message);
    }
    let frames = FrameCameras {
        fps,
        start: 0.0,
        cuts: Vec::new(),
        cameras: cameras.collect::<Result<_, _>>()?,
        is_closed: false,
    };
    Ok((frames, size))
}

fn camera(check: Checker, index: usize, frame: &FrameJson) -> Result<Camera, InputError> {
    let name = |field: &str| format!("camera_path[{index}].{field}");
    let matrix = &frame.camera_to_world;
    let fits = |number: &f64| number.abs() <= MAX_MAGNITUDE;
    if matrix.len() != 16 || !matrix.iter().all(fits) {
        let message = "is not 16 numbers, a matrix row by row";
        return check.refuse(&name("camera_to_world"), message);
    }
    let column = |i: usize| DVec3::new(matrix[i], matrix[4 + i], matrix[8 + i]);
    let rotation = DMat3::from_cols(column(0), column(1), column(2));
    // Stored in single precision it is a rotation only approximately.
    let is_rotation = (rotation.transpose() * rotation).abs_diff_eq(DMat3::IDENTITY, 1e-3);
    if !is_rotation || rotation.determinant() < 0.0 {
        let message =
            "turns and scales or mirrors; only rotations and translations can be rendered";
        return check.refuse(&name("camera_to_world"), message);
    }
    Ok(Camera::from_axes(
        column(3),
        column(2),
        column(1),
        check.field_of_view(&name("fov"), frame.fov)?,
    ))
}

/// The text of a file with the cameras of these frames, which have `width` x `height` pixels. `keys` are the cameras at
/// the keys of the editor with their times in seconds.
pub(super) fn to_json(
    cameras: &FrameCameras,
    keys: &[(f64, Camera)],
    (width, height): (u32, u32),
) -> serde_json::Result<String> {
    let aspect = f64::from(width) / f64::from(height);
    let fov = |camera: &Camera| camera.field_of_view().to_degrees();
    // The editor closes a loop from its last key to its first by itself.
    let (keys, closing) = match keys {
        [.., last, again] if cameras.is_closed => (&keys[..keys.len() - 1], Some(again.0 - last.0)),
        keys => (keys, None),
    };
    let mut before = None;
    let keyframes = keys.iter().map(|(time, camera)| KeyframeJson {
        matrix: matrix(camera),
        fov: fov(camera),
        aspect,
        override_transition_enabled: before.is_some() || closing.is_some(),
        override_transition_sec: match before.replace(*time) {
            Some(before) => Some(time - before),
            None => closing,
        },
    });
    let frames = cameras.cameras.iter().map(|camera| FrameJson {
        camera_to_world: matrix(camera),
        fov: fov(camera),
        aspect,
    });
    let path = PathOutput {
        default_fov: fov(&cameras.cameras[0]),
        default_transition_sec: 2.0,
        keyframes: keyframes.collect(),
        camera_type: "perspective",
        render_height: height,
        render_width: width,
        fps: cameras.fps,
        seconds: cameras.cameras.len() as f64 / cameras.fps,
        is_cycle: cameras.is_closed,
        smoothness_value: 0.0,
        camera_path: frames.collect(),
    };
    serde_json::to_string_pretty(&path)
}

/// Camera to world, row by row.
fn matrix(camera: &Camera) -> Vec<f64> {
    let rows = camera.rotation.transpose().to_cols_array_2d();
    let rows = rows.iter().zip(camera.position.to_array());
    // Without negative zeros.
    let rows = rows.flat_map(|([x, y, z], w)| [x + 0.0, y + 0.0, z + 0.0, w]);
    rows.chain([0.0, 0.0, 0.0, 1.0]).collect()
}
