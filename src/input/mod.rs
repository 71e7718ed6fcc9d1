//! Files in, resolved scene and camera path out: the only place that knows file syntax, units of
//! the files, defaults and relative names.
//!
//! Colours in files are linear RGB, lengths metres, angles degrees, times seconds. Whatever is
//! wrong is refused with the file and the place; whatever is left out of the picture is said in a
//! warning.

pub(crate) mod check;
mod error;
pub(crate) mod files;
mod mtl;
mod obj;
mod obj_check;
pub(crate) mod ron_file;
mod scene_file;
mod scene_loader;
mod settings_file;
mod statements;
mod texture_file;
mod unused;

pub use error::InputError;
pub use files::InputFiles;
pub use scene_loader::{SceneInput, load_scene};
pub use settings_file::{GlobalIllumination, LEAST_TARGET_ERROR, Mode, Settings, SettingsError};
