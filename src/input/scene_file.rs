//! The syntax of scene files: serde structures that mirror them.
//!
//! ```ron
#![doc = include_str!("../../scenes/test.ron")]
//! ```

use super::check::Triple;
use super::light_file::LightFile;
use super::ron_file;
use super::settings_file::Settings;
use super::sky_file::SkyFile;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(super) struct SceneFile {
    #[serde(default)]
    pub(super) background: SkyFile,
    #[serde(default)]
    pub(super) ambient: Triple,
    #[serde(default)]
    pub(super) settings: Settings,
    #[serde(default, deserialize_with = "ron_file::unique_keys")]
    pub(super) materials: BTreeMap<String, MaterialFile>,
    #[serde(default)]
    pub(super) lights: Vec<LightFile>,
    pub(super) objects: Vec<ObjectFile>,
}

#[derive(Deserialize)]
#[serde(rename = "Material", deny_unknown_fields)]
pub(super) struct MaterialFile {
    pub(super) diffuse: Option<Triple>,
    pub(super) texture: Option<String>,
    #[serde(default)]
    pub(super) specular: Triple,
    #[serde(default)]
    pub(super) shininess: f64,
    #[serde(default)]
    pub(super) reflective: Triple,
    pub(super) emission: Option<Triple>,
    pub(super) emission_texture: Option<String>,
    #[serde(default)]
    pub(super) two_sided: bool,
}

#[derive(Deserialize)]
#[serde(rename = "Object", rename_all = "snake_case")]
pub(super) enum ObjectFile {
    Sphere(SphereFile),
    Triangle(TriangleFile),
    Model(ModelFile),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereFile {
    #[serde(default)]
    pub(super) center: Triple,
    pub(super) radius: f64,
    pub(super) material: String,
    pub(super) emission: Option<Triple>,
    #[serde(default = "one")]
    pub(super) scale: Triple,
    #[serde(default)]
    pub(super) rotation: Triple,
    #[serde(default)]
    pub(super) translation: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TriangleFile {
    #[serde(deserialize_with = "ron_file::three")]
    pub(super) vertices: [Triple; 3],
    #[serde(default, deserialize_with = "ron_file::maybe_three")]
    pub(super) uvs: Option<[(f64, f64); 3]>,
    pub(super) material: Option<String>,
    pub(super) emission: Option<Triple>,
    #[serde(default, deserialize_with = "ron_file::maybe_three")]
    pub(super) vertex_materials: Option<[String; 3]>,
    #[serde(default = "one")]
    pub(super) scale: Triple,
    #[serde(default)]
    pub(super) rotation: Triple,
    #[serde(default)]
    pub(super) translation: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelFile {
    pub(super) file: String,
    pub(super) material: Option<String>,
    pub(super) reflective: Option<Triple>,
    pub(super) emission: Option<Triple>,
    #[serde(default = "one")]
    pub(super) scale: Triple,
    #[serde(default)]
    pub(super) rotation: Triple,
    #[serde(default)]
    pub(super) translation: Triple,
}

pub(super) fn one() -> Triple {
    (1.0, 1.0, 1.0)
}
