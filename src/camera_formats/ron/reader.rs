//! Reads camera path files.

use super::super::MAX_FRAMES;
use super::schema::{CameraPathFile, EaseFile, InterpolationFile, KeyframeFile, SpeedFile};
use crate::camera::{
    CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment, Speed,
};
use crate::input::InputError;
use crate::input::InputFiles;
use crate::input::Settings;
use crate::input::check::{Checker, MAX_MAGNITUDE, Triple};
use crate::input::ron_file;
use crate::math::rotation_xyz;
use glam::{DQuat, DVec3};
use std::path::Path;

/// A camera path and the settings of its file.
#[derive(Debug)]
pub struct CameraPathInput {
    /// A camera for every frame.
    pub path: CameraPath,
    /// Settings of the file.
    pub settings: Settings,
}

/// Loads a camera path file and checks the camera of every frame.
pub fn load_camera_path(
    file: &Path,
    files: &mut InputFiles,
) -> Result<CameraPathInput, InputError> {
    parse_camera_path(file, &files.read(file)?)
}

/// As [`load_camera_path`], from bytes; `file` is for messages only.
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
        && (last.time - first.time) * fps > f64::from(MAX_FRAMES)
    {
        return check.refuse("fps", format!("gives more than {MAX_FRAMES} frames"));
    }
    let timing = CameraPathTiming {
        speed: match parsed.speed {
            SpeedFile::ByKeys => Speed::ByKeys,
            SpeedFile::Constant => Speed::Constant,
        },
        closed: parsed.closed,
        ease_in: check.range("ease_in", parsed.ease_in, 0.0, MAX_MAGNITUDE)?,
        ease_out: check.range("ease_out", parsed.ease_out, 0.0, MAX_MAGNITUDE)?,
    };
    match CameraPath::new(fps, &keys, &timing) {
        Ok(path) => Ok(CameraPathInput {
            path,
            settings: parsed.settings,
        }),
        Err(error) => check.refuse("keyframes", error.to_string()),
    }
}

/// A key without its segment.
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
        segment: Segment::of(Interpolation::CatmullRom),
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
            // Typed or stored in single precision it is unit length only approximately.
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

/// Sets the segments of the keys, and refuses tangents and easing that would have no effect.
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
            let message =
                "has no effect: with `interpolation: hold` the camera does not move; remove it";
            return check.refuse(&name("ease"), message);
        }
        let is_passed = leaves(Hermite) || arrives(Hermite);
        for (field, given, is_used, user) in [
            ("velocity", key.velocity, is_passed, "hermite"),
            ("handle_out", key.handle_out, leaves(Bezier), "bezier"),
            ("handle_in", key.handle_in, arrives(Bezier), "bezier"),
        ] {
            if given.is_some() && !is_used {
                let message =
                    format!("has no effect: only `interpolation: {user}` uses it; remove it");
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
        let message = "differs from that of keyframes[0], which it repeats in a closed path";
        return check.refuse(&format!("keyframes[{last}].velocity"), message);
    }
    for i in 0..last {
        keys[i].segment = segment(check, interpolation(i), i, files, keys)?;
    }
    Ok(())
}

/// The segment from a key to the next, whose fields were checked.
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
    let interpolation = match interpolation {
        InterpolationFile::Hold => Interpolation::Hold,
        InterpolationFile::Linear => Interpolation::Linear,
        InterpolationFile::CatmullRom => Interpolation::CatmullRom,
        InterpolationFile::Hermite => {
            let seconds = keys[j].time - keys[i].time;
            Interpolation::Hermite(
                vector(i, "velocity", files[i].velocity)? * seconds,
                vector(j, "velocity", files[j].velocity)? * seconds,
            )
        }
        InterpolationFile::Bezier => Interpolation::Hermite(
            (vector(i, "handle_out", files[i].handle_out)? - keys[i].position) * 3.0,
            (keys[j].position - vector(j, "handle_in", files[j].handle_in)?) * 3.0,
        ),
    };
    let ease = files[i].ease;
    Ok(Segment {
        interpolation,
        ease_in: matches!(ease, Some(EaseFile::In | EaseFile::InOut)),
        ease_out: matches!(ease, Some(EaseFile::Out | EaseFile::InOut)),
    })
}
