//! Camera path files.
//!
//! ```ron
#![doc = include_str!("../../paths/zoom.ron")]
//! ```

use super::check::{Checker, Triple};
use super::error::InputError;
use super::files::InputFiles;
use super::ron_file;
use super::settings_file::Settings;
use crate::camera::{CameraPath, Interpolation, Keyframe, Orientation};
use crate::math::rotation_xyz;
use glam::{DQuat, DVec3};
use serde::Deserialize;
use std::path::Path;

/// A camera path and the settings that stand with it.
#[derive(Debug)]
pub struct CameraPathInput {
    /// A camera for every frame.
    pub path: CameraPath,
    /// Settings of the file.
    pub settings: Settings,
}

#[derive(Deserialize)]
#[serde(rename = "CameraPath", deny_unknown_fields)]
struct CameraPathFile {
    fps: f64,
    #[serde(default)]
    interpolation: InterpolationFile,
    #[serde(default)]
    settings: Settings,
    keyframes: Vec<KeyframeFile>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename = "Interpolation", rename_all = "snake_case")]
enum InterpolationFile {
    Linear,
    #[default]
    CatmullRom,
}

#[derive(Deserialize)]
#[serde(rename = "Keyframe", deny_unknown_fields)]
struct KeyframeFile {
    time: f64,
    position: Triple,
    look_at: Option<Triple>,
    rotation: Option<Triple>,
    fov: f64,
}

/// More frames than a film of a day has.
const MOST_FRAMES: f64 = 1e7;

/// Loads a camera path file and checks the camera of every frame.
pub fn load_camera_path(
    file: &Path,
    files: &mut InputFiles,
) -> Result<CameraPathInput, InputError> {
    let parsed: CameraPathFile = ron_file::parse(file, &files.read(file)?)?;
    let check = Checker { file };
    let fps = check.positive("fps", parsed.fps)?;
    if let Err(error) = parsed.settings.check() {
        return check.refuse(&format!("settings.{}", error.key), error.message);
    }
    let mut keys = Vec::new();
    for (i, key) in parsed.keyframes.iter().enumerate() {
        keys.push(keyframe(check, i, key)?);
    }
    if let (Some(first), Some(last)) = (keys.first(), keys.last())
        && (last.time - first.time) * fps > MOST_FRAMES
    {
        return check.refuse("fps", format!("gives more than {MOST_FRAMES} frames"));
    }
    let interpolation = match parsed.interpolation {
        InterpolationFile::Linear => Interpolation::Linear,
        InterpolationFile::CatmullRom => Interpolation::CatmullRom,
    };
    match CameraPath::new(fps, interpolation, &keys) {
        Ok(path) => Ok(CameraPathInput {
            path,
            settings: parsed.settings,
        }),
        Err(error) => check.refuse("keyframes", error.to_string()),
    }
}

fn keyframe(check: Checker, index: usize, key: &KeyframeFile) -> Result<Keyframe, InputError> {
    let name = |field: &str| format!("keyframes[{index}].{field}");
    let orientation = match (key.look_at, key.rotation) {
        (Some(point), None) => Orientation::LookAt(check.vector(&name("look_at"), point)?),
        (None, Some(degrees)) => {
            let angles = check.vector(&name("rotation"), degrees)?;
            let angles = DVec3::from_array(angles.to_array().map(f64::to_radians));
            Orientation::Rotation(DQuat::from_mat3(&rotation_xyz(angles)))
        }
        _ => {
            let message = "give either `look_at: (x, y, z)` or `rotation: (x, y, z)` in degrees";
            return check.refuse(&format!("keyframes[{index}]"), message);
        }
    };
    let fov = key.fov;
    if !(fov > 0.0 && fov < 180.0) {
        let message = format!("{fov} degrees; a vertical field of view lies between 0 and 180");
        return check.refuse(&name("fov"), message);
    }
    let time = key.time;
    if time.is_nan() || time.abs() > 1e9 {
        return check.refuse(&name("time"), format!("{time} is not a time in seconds"));
    }
    Ok(Keyframe {
        time,
        position: check.vector(&name("position"), key.position)?,
        orientation,
        field_of_view: fov.to_radians(),
    })
}
