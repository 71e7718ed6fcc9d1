//! Camera paths of nerfstudio's viewer: `camera_path.json`.
//!
//! ```json
//! {
//!   "camera_type": "perspective", "render_width": 1280, "render_height": 720, "fps": 30.0, "seconds": 8.0,
//!   "camera_path": [{"camera_to_world": [1.0, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0, 1.7, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 0.0, 1.0], "fov": 50.0}]
//! }
//! ```
//!
//! Matrices are row-major; fields of view are vertical, in degrees. The editor's keys are not read: the frames that
//! it has worked out are what it renders, in all of its versions.

use super::json_file;
use crate::camera::{Camera, FrameCameras};
use crate::input::InputError;
use crate::input::Settings;
use crate::input::check::{Checker, MAX_MAGNITUDE};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
struct CameraPathJson {
    camera_type: Option<String>,
    render_width: Option<f64>,
    render_height: Option<f64>,
    fps: Option<f64>,
    seconds: Option<f64>,
    camera_path: Vec<FrameJson>,
}

#[derive(Deserialize)]
struct FrameJson {
    camera_to_world: Vec<f64>,
    fov: f64,
}

/// Types of cameras whose pictures are not those of a pinhole. Nerfstudio takes any other name for a pinhole.
const OTHER_TYPES: [&str; 4] = ["fisheye", "equirectangular", "omnidirectional", "vr180"];

/// The cameras of a file's text, and the size of its pictures if it says so.
pub(super) fn parse(
    file: &Path,
    text: &[u8],
) -> Result<(FrameCameras, Option<(u32, u32)>), InputError> {
    let check = Checker { file };
    let parsed: CameraPathJson = json_file::parse(file, text)?;
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
    // Nerfstudio itself renders so many frames in so many seconds, whatever stands under fps.
    let fps = match (parsed.seconds, parsed.fps) {
        (Some(seconds), _) => count / check.positive("seconds", seconds)?,
        (None, Some(fps)) => check.positive("fps", fps)?,
        (None, None) => return check.refuse("seconds", "is missing, and so is fps"),
    };
    let frames = parsed.camera_path.iter().enumerate();
    let cameras = frames.map(|(i, frame)| camera(check, i, frame));
    let side = |key, pixels| Ok(check.range(key, pixels, 1.0, f64::from(u32::MAX))? as u32);
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
    // Stored in single precision it is so only nearly.
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
