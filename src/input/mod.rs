//! Scene files, models, material libraries, textures and images of the sky, parsed, checked and resolved to a
//! [`Scene`](crate::scene::Scene) and [`Settings`].
//!
//! Colours in files are linear RGB, lengths metres, angles degrees, times seconds. Whatever is wrong is an
//! [`InputError`] with the file and the place in it; whatever a file asks for and does not get is a warning.

pub(crate) mod check;
mod error;
mod extra_light;
pub(crate) mod files;
mod ignored_settings;
mod jpeg;
mod light_file;
mod mtl;
mod obj;
mod obj_check;
mod obj_signature;
pub(crate) mod ron_file;
mod samples;
mod scene_file;
mod scene_loader;
mod settings_file;
mod sky_file;
mod sky_map_file;
mod statements;
mod technique;
mod texture_file;
mod unused;

pub use error::InputError;
pub use extra_light::ExtraLight;
pub use files::InputFiles;
pub use ignored_settings::{IgnoredSetting, ignored_settings};
pub use samples::Samples;
pub use scene_loader::{SceneInput, load_scene};
pub use settings_file::{
    DEFAULT_ERROR, DEFAULT_PATH_TRACED_ERROR, MIN_TARGET_ERROR, Settings, SettingsError,
};
pub use technique::{GlobalIllumination, Mode};
