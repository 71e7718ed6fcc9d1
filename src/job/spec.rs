//! The spec of a job: the job as data, before anything is loaded. `sequence.ron` holds it beside the frames.
//!
//! ```ron
//! Job(scene: "../gallery.ron", path: "../walk.ron", settings: (mode: "montecarlo", size: (640, 360)))
//! ```

use super::error::JobError;
use crate::frames::{FrameFolder, FrameFormat};
use crate::input::Settings;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// What decides the frames of a sequence: files by name, settings as far as they are given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Job", deny_unknown_fields)]
pub struct Spec {
    /// The scene file.
    pub scene: PathBuf,
    /// The camera path file.
    pub path: PathBuf,
    /// Settings that win over those of the files.
    #[serde(default, skip_serializing_if = "is_default")]
    pub settings: Settings,
    /// File format of the frames.
    #[serde(default, skip_serializing_if = "is_default")]
    pub format: FrameFormat,
    /// Whether the error of every pixel is stored beside the frames.
    #[serde(default, skip_serializing_if = "is_default")]
    pub error_maps: bool,
    /// Whether that which the irradiance cache makes is, too.
    #[serde(default, skip_serializing_if = "is_default")]
    pub cache_error_maps: bool,
    /// An irradiance cache that other jobs may share; none for one of the folder's own.
    #[serde(default, skip_serializing_if = "is_default")]
    pub irradiance_cache: Option<PathBuf>,
    /// Whether frames are small and ray traced, whatever the settings of the files say.
    #[serde(default, skip_serializing_if = "is_default")]
    pub preview: bool,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Options are written as values, as in scene files.
fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

impl Spec {
    /// A scene and a camera path with the settings of their files, as PNG frames.
    pub fn new(scene: &Path, path: &Path) -> Spec {
        Spec {
            scene: scene.to_owned(),
            path: path.to_owned(),
            settings: Settings::default(),
            format: FrameFormat::default(),
            error_maps: false,
            cache_error_maps: false,
            irradiance_cache: None,
            preview: false,
        }
    }

    /// The job spec of a folder's frames, its files named from the current folder.
    pub fn of_folder(folder: &FrameFolder) -> Result<Spec, JobError> {
        let text = folder.sequence().job.get_ron();
        let spec: Spec = options()
            .from_str(text)
            .map_err(|error| JobError::UnreadableJob {
                folder: folder.path().to_owned(),
                message: error.code.to_string(),
            })?;
        spec.map_files(|file| Ok(folder.path().join(file)))
    }

    /// The job as `sequence.ron` holds it: files are named from the folder, so that all may be moved together.
    ///
    /// An error if a name is not UTF-8, which RON cannot hold.
    pub fn for_folder(&self, folder: &Path) -> io::Result<Box<RawValue>> {
        let folder = absolute(folder)?;
        let spec = self.clone().map_files(|file| {
            let name = relative(&absolute(file)?, &folder);
            match name.to_str() {
                Some(_) => Ok(name),
                None => Err(io::Error::other(format!(
                    "{}: is not valid UTF-8, so that sequence.ron cannot name it: rename it, or give its folder \
                     another name",
                    name.display()
                ))),
            }
        })?;
        let pretty = ron::ser::PrettyConfig::new()
            .struct_names(true)
            .depth_limit(0);
        let text = options().to_string_pretty(&spec, pretty);
        let text = text.map_err(io::Error::other)?;
        RawValue::from_boxed_ron(text.into()).map_err(io::Error::other)
    }

    /// Whether both name the same scene and the same camera path.
    pub(super) fn has_the_files_of(&self, other: &Spec) -> bool {
        is_same(&self.scene, &other.scene) && is_same(&self.path, &other.path)
    }

    fn map_files<E>(self, map: impl Fn(&Path) -> Result<PathBuf, E>) -> Result<Spec, E> {
        Ok(Spec {
            scene: map(&self.scene)?,
            path: map(&self.path)?,
            irradiance_cache: self.irradiance_cache.as_deref().map(map).transpose()?,
            ..self
        })
    }
}

/// Whether two names are of one file.
pub(super) fn is_same(a: &Path, b: &Path) -> bool {
    absolute(a).ok() == absolute(b).ok()
}

/// A file's name from the root, links on the way to it resolved as far as they exist: `..` is then the folder above.
fn absolute(file: &Path) -> io::Result<PathBuf> {
    let file = std::path::absolute(file)?;
    for existing in file.ancestors() {
        if let Ok(resolved) = fs::canonicalize(existing) {
            let rest = file.strip_prefix(existing).unwrap_or(Path::new(""));
            return Ok(resolved.join(rest));
        }
    }
    Ok(file)
}

/// The name of a file from a folder, both from the root.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let common = file.components().zip(folder.components());
    let common = common.take_while(|(a, b)| a == b).count();
    let up = folder
        .components()
        .skip(common)
        .map(|_| Component::ParentDir);
    up.chain(file.components().skip(common)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{GlobalIllumination, Mode, Samples};

    #[test]
    fn names_from_a_folder_lead_back() {
        for (file, folder, expected) in [
            ("/a/s.ron", "/a/out", "../s.ron"),
            ("/a/out/s.ron", "/a/out", "s.ron"),
            ("/a/b/c.ron", "/x/y", "../../a/b/c.ron"),
            ("/s.ron", "/", "s.ron"),
        ] {
            let name = relative(Path::new(file), Path::new(folder));
            assert_eq!(name, Path::new(expected), "{file} from {folder}");
        }
    }

    #[test]
    fn the_stored_spec_is_the_original() {
        let root = tempfile::tempdir().expect("a folder");
        let file = |name: &str| root.path().join(name);
        for name in ["s.ron", "p.ron"] {
            fs::write(file(name), "").expect("written");
        }
        let plain = Spec::new(&file("s.ron"), &file("p.ron"));
        let full = Spec {
            settings: Settings {
                mode: Some(Mode::MontecarloSupersampling),
                size: Some((64, 48)),
                samples: Some(Samples::Spread(3)),
                splits: Some(vec![8, 2]),
                exposure: Some(-0.5),
                target_error: Some(1e-3),
                gi: Some(GlobalIllumination::Cached),
                lock_seed: Some(true),
                ..Settings::default()
            },
            format: FrameFormat::Exr,
            error_maps: true,
            cache_error_maps: true,
            irradiance_cache: Some(file("shared.cache")),
            preview: true,
            ..plain.clone()
        };
        for spec in [plain, full] {
            let stored = spec.for_folder(&file("frames/deep")).expect("stored");
            assert!(!stored.get_ron().contains(&*root.path().to_string_lossy()));
            let read: Spec = options().from_str(stored.get_ron()).expect("as written");
            assert_eq!(read.scene, Path::new("../../s.ron"));
            let folder = fs::canonicalize(root.path())
                .expect("there")
                .join("frames/deep");
            let back = read.map_files(|file| io::Result::Ok(lexical(&folder.join(file))));
            let spec = spec.map_files(absolute);
            assert_eq!(back.expect("there"), spec.expect("there"));
        }
    }

    /// Without `..`.
    fn lexical(file: &Path) -> PathBuf {
        let mut clean = PathBuf::new();
        for part in file.components() {
            match part {
                Component::ParentDir => assert!(clean.pop()),
                part => clean.push(part),
            }
        }
        clean
    }
}
