//! The structure of camera path files.

use crate::input::Settings;
use crate::input::check::Triple;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(rename = "CameraPath", deny_unknown_fields)]
pub(super) struct CameraPathFile {
    pub(super) fps: f64,
    #[serde(default)]
    pub(super) interpolation: InterpolationFile,
    #[serde(default)]
    pub(super) speed: SpeedFile,
    #[serde(default)]
    pub(super) closed: bool,
    #[serde(default)]
    pub(super) ease_in: f64,
    #[serde(default)]
    pub(super) ease_out: f64,
    #[serde(default)]
    pub(super) settings: Settings,
    pub(super) keyframes: Vec<KeyframeFile>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename = "Speed", rename_all = "snake_case")]
pub(super) enum SpeedFile {
    #[default]
    ByKeys,
    Constant,
}

#[derive(Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename = "Interpolation", rename_all = "snake_case")]
pub(super) enum InterpolationFile {
    Hold,
    Linear,
    #[default]
    CatmullRom,
    Bezier,
    Hermite,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename = "Ease", rename_all = "snake_case")]
pub(super) enum EaseFile {
    In,
    Out,
    InOut,
}

#[derive(Deserialize)]
#[serde(rename = "Keyframe", deny_unknown_fields)]
pub(super) struct KeyframeFile {
    pub(super) time: f64,
    pub(super) position: Triple,
    pub(super) look_at: Option<Triple>,
    pub(super) roll: Option<f64>,
    pub(super) rotation: Option<Triple>,
    pub(super) yaw_pitch_roll: Option<Triple>,
    pub(super) quaternion: Option<(f64, f64, f64, f64)>,
    pub(super) fov: f64,
    pub(super) interpolation: Option<InterpolationFile>,
    pub(super) ease: Option<EaseFile>,
    pub(super) velocity: Option<Triple>,
    pub(super) handle_in: Option<Triple>,
    pub(super) handle_out: Option<Triple>,
}
