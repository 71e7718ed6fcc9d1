//! Camera path files.
//!
//! ```ron
#![doc = include_str!("../../paths/zoom.ron")]
//! ```

use crate::camera::{CameraPath, Keyframe, Orientation, Pace, Segment, Shape, Speed};
use crate::input::InputError;
use crate::input::InputFiles;
use crate::input::Settings;
use crate::input::check::{Checker, MAX_MAGNITUDE, Triple};
use crate::input::ron_file;
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
    speed: SpeedFile,
    #[serde(default)]
    closed: bool,
    #[serde(default)]
    ease_in: f64,
    #[serde(default)]
    ease_out: f64,
    #[serde(default)]
    settings: Settings,
    keyframes: Vec<KeyframeFile>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename = "Speed", rename_all = "snake_case")]
enum SpeedFile {
    #[default]
    ByKeys,
    Constant,
}

#[derive(Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename = "Interpolation", rename_all = "snake_case")]
enum InterpolationFile {
    Hold,
    Linear,
    #[default]
    CatmullRom,
    Bezier,
    Hermite,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename = "Ease", rename_all = "snake_case")]
enum EaseFile {
    In,
    Out,
    InOut,
}

#[derive(Deserialize)]
#[serde(rename = "Keyframe", deny_unknown_fields)]
struct KeyframeFile {
    time: f64,
    position: Triple,
    look_at: Option<Triple>,
    roll: Option<f64>,
    rotation: Option<Triple>,
    yaw_pitch_roll: Option<Triple>,
    quaternion: Option<(f64, f64, f64, f64)>,
    fov: f64,
    interpolation: Option<InterpolationFile>,
    ease: Option<EaseFile>,
    velocity: Option<Triple>,
    handle_in: Option<Triple>,
    handle_out: Option<Triple>,
}

/// More frames than a film of a day has.
pub(super) const MOST_FRAMES: u32 = 10_000_000;

/// Loads a camera path file and checks the camera of every frame.
pub fn load_camera_path(
    file: &Path,
    files: &mut InputFiles,
) -> Result<CameraPathInput, InputError> {
    parse_camera_path(file, &files.read(file)?)
}

/// As [`load_camera_path`], of the bytes of a file, which need not be there.
pub fn parse_camera_path(file: &Path, bytes: &[u8]) -> Result<CameraPathInput, InputError> {
    let parsed: CameraPathFile = ron_file::parse(file, bytes)?;
    let check = Checker { file };
    let fps = check.positive("fps", parsed.fps)?;
    if let Err(error) = parsed.settings.check() {
        return check.refuse(&format!("settings.{}", error.key), error.message);
    }
    let keys = parsed.keyframes.iter().enumerate();
    let keys = keys.map(|(i, key)| keyframe(check, i, key));
    let mut keys = keys.collect::<Result<Vec<Keyframe>, _>>()?;
    segments(check, &parsed, &mut keys)?;
    if let (Some(first), Some(last)) = (keys.first(), keys.last())
        && (last.time - first.time) * fps > f64::from(MOST_FRAMES)
    {
        return check.refuse("fps", format!("gives more than {MOST_FRAMES} frames"));
    }
    let pace = Pace {
        speed: match parsed.speed {
            SpeedFile::ByKeys => Speed::ByKeys,
            SpeedFile::Constant => Speed::Constant,
        },
        closed: parsed.closed,
        ease_in: check.range("ease_in", parsed.ease_in, 0.0, MAX_MAGNITUDE)?,
        ease_out: check.range("ease_out", parsed.ease_out, 0.0, MAX_MAGNITUDE)?,
    };
    match CameraPath::new(fps, &keys, &pace) {
        Ok(path) => Ok(CameraPathInput {
            path,
            settings: parsed.settings,
        }),
        Err(error) => check.refuse("keyframes", error.to_string()),
    }
}

/// A key of its own: nothing is known yet of the way to the next.
fn keyframe(check: Checker, index: usize, key: &KeyframeFile) -> Result<Keyframe, InputError> {
    let name = |field: &str| format!("keyframes[{index}].{field}");
    let field_of_view = check.field_of_view(&name("fov"), key.fov)?;
    let time = key.time;
    if time.is_nan() || time.abs() > 1e9 {
        return check.refuse(&name("time"), format!("{time} is not a time in seconds"));
    }
    Ok(Keyframe {
        time,
        position: check.vector(&name("position"), key.position)?,
        orientation: orientation(check, index, key)?,
        field_of_view,
        segment: Segment::of(Shape::CatmullRom),
    })
}

fn orientation(
    check: Checker,
    index: usize,
    key: &KeyframeFile,
) -> Result<Orientation, InputError> {
    let name = |field: &str| format!("keyframes[{index}].{field}");
    let radians = |field: &str, degrees| -> Result<DVec3, InputError> {
        let degrees = check.vector(&name(field), degrees)?;
        Ok(DVec3::from_array(degrees.to_array().map(f64::to_radians)))
    };
    if let (Some(_), None) = (key.roll, key.look_at) {
        let message = "goes with look_at; give yaw_pitch_roll: (yaw, pitch, roll) instead";
        return check.refuse(&name("roll"), message);
    }
    match (
        key.look_at,
        key.rotation,
        key.yaw_pitch_roll,
        key.quaternion,
    ) {
        (Some(point), None, None, None) => Ok(Orientation::LookAt {
            target: check.vector(&name("look_at"), point)?,
            roll: check
                .range(
                    &name("roll"),
                    key.roll.unwrap_or(0.0),
                    -MAX_MAGNITUDE,
                    MAX_MAGNITUDE,
                )?
                .to_radians(),
        }),
        (None, Some(angles), None, None) => {
            let rotation = rotation_xyz(radians("rotation", angles)?);
            Ok(Orientation::Rotation(DQuat::from_mat3(&rotation)))
        }
        (None, None, Some(angles), None) => {
            let angles = radians("yaw_pitch_roll", angles)?;
            Ok(Orientation::YawPitchRoll(angles))
        }
        (None, None, None, Some((x, y, z, w))) => {
            let quaternion = DQuat::from_xyzw(x, y, z, w);
            // What is typed or was stored in single precision is so only nearly.
            if !(0.999..1.001).contains(&quaternion.length()) {
                let message = format!("({x}, {y}, {z}, {w}) is not of length 1");
                return check.refuse(&name("quaternion"), message);
            }
            Ok(Orientation::Rotation(quaternion.normalize()))
        }
        _ => {
            let message = "give one of `look_at: (x, y, z)`, `yaw_pitch_roll: (yaw, pitch, roll)` \
                           in degrees, `quaternion: (x, y, z, w)` and `rotation: (x, y, z)` in \
                           degrees";
            check.refuse(&format!("keyframes[{index}]"), message)
        }
    }
}

/// Sets the segments of keys, and refuses tangents and easing that are given and would not be used.
fn segments(
    check: Checker,
    parsed: &CameraPathFile,
    keys: &mut [Keyframe],
) -> Result<(), InputError> {
    let files = &parsed.keyframes;
    let interpolation = |i: usize| files[i].interpolation.unwrap_or(parsed.interpolation);
    let last = files.len().saturating_sub(1);
    for (i, key) in files.iter().enumerate() {
        let name = |field: &str| format!("keyframes[{i}].{field}");
        let leaves = |kind| i < last && interpolation(i) == kind;
        let arrives = |kind| i > 0 && interpolation(i - 1) == kind;
        use InterpolationFile::{Bezier, Hermite};
        if leaves(InterpolationFile::Hold) && key.ease.is_some() {
            let message = "is of no use: `interpolation: hold` stays where it is";
            return check.refuse(&name("ease"), message);
        }
        let is_passed = leaves(Hermite) || arrives(Hermite);
        for (field, given, is_used, user) in [
            ("velocity", key.velocity, is_passed, "hermite"),
            ("handle_out", key.handle_out, leaves(Bezier), "bezier"),
            ("handle_in", key.handle_in, arrives(Bezier), "bezier"),
        ] {
            if given.is_some() && !is_used {
                let message = format!("is of no use: no `interpolation: {user}` needs it there");
                return check.refuse(&name(field), message);
            }
            if is_used && given.is_none() {
                let message = format!("is missing, and `interpolation: {user}` needs it");
                return check.refuse(&name(field), message);
            }
        }
    }
    let [first, end] = [files.first(), files.last()].map(|key| key?.velocity);
    if parsed.closed && first.is_some() && end.is_some() && first != end {
        let message = "is not that of keyframes[0], where a closed path goes on";
        return check.refuse(&format!("keyframes[{last}].velocity"), message);
    }
    for i in 0..last {
        keys[i].segment = segment(check, interpolation(i), i, files, keys)?;
    }
    Ok(())
}

/// The way from a key to the next, whose fields were checked.
fn segment(
    check: Checker,
    interpolation: InterpolationFile,
    index: usize,
    files: &[KeyframeFile],
    keys: &[Keyframe],
) -> Result<Segment, InputError> {
    let vector = |key: usize, field: &str, given: Option<Triple>| {
        let given = given.unwrap_or_default();
        check.vector(&format!("keyframes[{key}].{field}"), given)
    };
    let (i, j) = (index, index + 1);
    let shape = match interpolation {
        InterpolationFile::Hold => Shape::Hold,
        InterpolationFile::Linear => Shape::Linear,
        InterpolationFile::CatmullRom => Shape::CatmullRom,
        InterpolationFile::Hermite => {
            let seconds = keys[j].time - keys[i].time;
            Shape::Cubic(
                vector(i, "velocity", files[i].velocity)? * seconds,
                vector(j, "velocity", files[j].velocity)? * seconds,
            )
        }
        InterpolationFile::Bezier => Shape::Cubic(
            (vector(i, "handle_out", files[i].handle_out)? - keys[i].position) * 3.0,
            (keys[j].position - vector(j, "handle_in", files[j].handle_in)?) * 3.0,
        ),
    };
    let ease = files[i].ease;
    Ok(Segment {
        shape,
        ease_in: matches!(ease, Some(EaseFile::In | EaseFile::InOut)),
        ease_out: matches!(ease, Some(EaseFile::Out | EaseFile::InOut)),
    })
}
