//! What frames and caches are made from, as hashes of canonical data: JSON with sorted keys and numbers that read back
//! as the same, in which what has its default is left out. So a new setting leaves hashes as they were.

use super::inputs::Inputs;
use crate::camera::Camera;
use crate::frames::FrameFormat;
use crate::integrator::IntegratorSettings;
use crate::render::RenderSettings;
use serde_json::{Map, Value, json};

/// The build of the program: a hash of the code and the libraries that decide pixels, the same for debug, release and
/// whichever machine compiles it.
pub const BUILD: &str = env!("FLYTHROUGH_BUILD");

/// What an irradiance cache is made from, beside scene, path and settings: what it holds for other paths changes nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheIdentity {
    /// The build of the program that began it, if it is another one than this.
    pub other_build: Option<String>,
}

/// What decides the pixels of all frames of a sequence, beside their cameras.
#[derive(Debug)]
pub(super) struct SequenceInputs<'a> {
    pub(super) inputs: &'a Inputs,
    pub(super) settings: &'a RenderSettings,
    pub(super) exposure: f32,
    pub(super) format: FrameFormat,
    /// None where nothing is looked up.
    pub(super) cache: Option<&'a CacheIdentity>,
}

impl SequenceInputs<'_> {
    /// The input hash of every frame.
    pub(super) fn hashes(&self) -> Vec<String> {
        let mut data = json!({
            "scene": self.inputs.scene_hash.to_string(),
            "settings": canonical_settings(self.settings),
        });
        if self.exposure != 0.0 {
            data["exposure"] = json!(self.exposure);
        }
        if self.format != FrameFormat::default() {
            data["format"] = json!(self.format);
        }
        if let Some(CacheIdentity { other_build }) = self.cache {
            // Where its records stand depends on the whole path.
            data["irradiance_cache"] = json!(self.inputs.path_hash.to_string());
            if let Some(build) = other_build {
                data["cache_build"] = json!(build);
            }
        }
        let path = &self.inputs.path.path;
        let hash = |frame| {
            data["frame"] = json!(frame);
            data["camera"] = canonical_camera(&path.camera(frame));
            blake3::hash(data.to_string().as_bytes()).to_string()
        };
        (0..self.inputs.frame_count()).map(hash).collect()
    }
}

/// A hash of what decides an irradiance cache, but for the paths that it is baked for; `build` is that of the program
/// that bakes it.
pub(super) fn cache_hash(inputs: &Inputs, settings: &RenderSettings, build: &str) -> blake3::Hash {
    let mut data = json!({
        "build": build,
        "scene": inputs.scene_hash.to_string(),
        "bounces": settings.integrator.bounces(),
        "size": [settings.width, settings.height],
    });
    if settings.seed != 0 {
        data["seed"] = json!(settings.seed);
    }
    // Only where the error decides on refinement what it is measured by does, too.
    if let Some(target) = settings.target_error {
        data["target"] = json!([target, settings.display_white]);
    }
    blake3::hash(data.to_string().as_bytes())
}

/// What differs from the defaults.
fn canonical_settings(settings: &RenderSettings) -> Value {
    let fields = |settings: &RenderSettings| match json!(settings) {
        Value::Object(fields) => fields,
        _ => Map::new(),
    };
    let defaults = RenderSettings::new(IntegratorSettings::Whitted { bounces: 0 }, 0, 0);
    let defaults = fields(&defaults);
    let mut given = fields(settings);
    given.retain(|key, value| defaults.get(key) != Some(value));
    Value::Object(given)
}

fn canonical_camera(camera: &Camera) -> Value {
    json!({
        "position": camera.position.to_array(),
        "rotation": camera.rotation.to_cols_array(),
        "half_height": camera.half_height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_left_out() {
        let settings = RenderSettings {
            seed: 7,
            ..RenderSettings::new(IntegratorSettings::Whitted { bounces: 4 }, 64, 48)
        };
        assert_eq!(
            canonical_settings(&settings).to_string(),
            r#"{"height":48,"integrator":{"Whitted":{"bounces":4}},"seed":7,"width":64}"#
        );
    }

    #[test]
    fn cameras_are_told_apart_to_the_last_bit() {
        let camera = Camera {
            position: glam::DVec3::new(0.1, -1e300, 5e-324),
            rotation: glam::DMat3::from_rotation_y(0.3),
            half_height: 1.0 / 3.0,
        };
        let text = canonical_camera(&camera).to_string();
        for number in ["0.1", "-1e+300", "5e-324", "0.3333333333333333"] {
            assert!(text.contains(number), "{text}");
        }
        let next = Camera {
            half_height: camera.half_height.next_up(),
            ..camera
        };
        assert_ne!(canonical_camera(&next).to_string(), text);
    }
}
