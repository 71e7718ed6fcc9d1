//! The irradiance cache of a job: its location, and what is there already.

use super::error::JobError;
use super::identity::{BUILD, CacheIdentity, cache_hash};
use super::inputs::Inputs;
use super::options::JobOptions;
use crate::bake::{BakeState, Baked, CacheFile, CacheFileError, Listener, bake_with_room};
use crate::memory::check_room;
use crate::render::RenderSettings;
use crate::storage::{PartFile, WaitListener};
use std::path::{Path, PathBuf};

/// The location of an irradiance cache.
#[derive(Debug)]
pub enum CacheLocation {
    /// In a file that jobs share: what it holds for other paths stays.
    Shared(PathBuf),
    /// In a file of this path alone: what it holds for others does not count, so that the cache is that of a first run.
    Own(PathBuf),
    /// In memory.
    Memory,
}

/// Whether a cache that cannot be kept in its file is of use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepCache {
    /// It is baked to be kept: if it cannot be, nothing is baked.
    Always,
    /// Frames use it all the same.
    IfPossible,
}

/// An irradiance cache, as far as a file holds it already.
#[derive(Debug)]
pub struct OpenedCache {
    file: Option<CacheFile>,
    found: Option<BakeState>,
    /// Names the path in the cache.
    path_hash: String,
    /// The build of the program that began the cache: another one than this only if it is accepted.
    build: String,
}

impl OpenedCache {
    /// Reads what is there for frames of these settings. With `rebake` in the options, a shared file that is damaged or
    /// of something else counts as none.
    pub fn open(
        location: CacheLocation,
        inputs: &Inputs,
        settings: &RenderSettings,
        options: &JobOptions,
    ) -> Result<OpenedCache, JobError> {
        let path_hash = inputs.path_hash.to_string();
        let of_build =
            |file: &Path, build: &str| CacheFile::new(file, cache_hash(inputs, settings, build));
        let opened = |file: Option<CacheFile>, found: Option<BakeState>, build: &str| OpenedCache {
            file,
            found,
            path_hash: path_hash.clone(),
            build: build.to_owned(),
        };
        let (file, is_own) = match &location {
            CacheLocation::Shared(file) => (file, false),
            CacheLocation::Own(file) => (file, true),
            CacheLocation::Memory => return Ok(opened(None, None, BUILD)),
        };
        for build in &options.accepted_builds {
            let cache = of_build(file, build);
            if let Ok(Some(found)) = cache.read(false)
                && (!is_own || found.camera_paths().eq([path_hash.as_str()]))
            {
                return Ok(opened(Some(cache), Some(found), build));
            }
        }
        let cache = of_build(file, BUILD);
        let found = match cache.read(options.rebake) {
            // What is of no use is written over.
            Err(
                CacheFileError::NotACache { .. }
                | CacheFileError::Damaged { .. }
                | CacheFileError::OtherInputs { .. },
            ) if is_own || options.replace => None,
            // A pipe or a device in its place is replaced.
            Err(CacheFileError::File(error)) if is_own && error.source.raw_os_error().is_none() => {
                None
            }
            found => found?,
        };
        let found = found.filter(|found| !is_own || found.camera_paths().eq([path_hash.as_str()]));
        Ok(opened(Some(cache), found, BUILD))
    }

    /// What the cache is made from beside scene, path and settings.
    pub fn identity(&self) -> CacheIdentity {
        CacheIdentity {
            other_build: (self.build != BUILD).then(|| self.build.clone()),
        }
    }

    /// Whether nothing is left to bake.
    pub fn is_complete(&self, settings: &RenderSettings) -> bool {
        self.found.as_ref().is_some_and(|found| {
            found
                .errors(&self.path_hash, settings.display_white)
                .is_some()
        })
    }

    /// Bakes what is missing, and writes the file. If that fails and it need not be kept, also returns why.
    pub fn bake(
        mut self,
        inputs: &Inputs,
        settings: &RenderSettings,
        listener: Listener,
        keep: KeepCache,
        waiting: WaitListener,
    ) -> Result<(Baked, Option<CacheFileError>), JobError> {
        let mut lock = None;
        if !self.is_complete(settings)
            && let Some(file) = &self.file
        {
            // If it cannot be locked it cannot be written, which is found below.
            lock = file.lock(waiting).ok().flatten();
            // What other jobs have baked meanwhile, now that nobody else writes the file.
            if let Some(now) = file.read(false).ok().flatten() {
                self.found = Some(now);
            }
        }
        let is_complete = self.is_complete(settings);
        let file = self.file.filter(|_| !is_complete);
        let mut not_kept = None;
        let mut tolerate = |begun: Result<Option<PartFile>, CacheFileError>| match (begun, keep) {
            (Err(error), KeepCache::IfPossible) => {
                not_kept = Some(error);
                Ok(None)
            }
            (begun, _) => begun,
        };
        let mut begun = tolerate(file.as_ref().map(CacheFile::begin).transpose())?;
        // Gathering the light takes long: there has to be room for it.
        let reserve = |bytes: u64| {
            let reserved = begun.take().map(|begun| {
                begun.reserve(CacheFile::bytes(bytes))?;
                Ok(begun)
            });
            begun = tolerate(reserved.transpose())?;
            // Records as they are baked, as frames look them up, and as a file.
            check_room(
                "the irradiance cache",
                4 * bytes,
                "choose a smaller --size, or --gi path-traced",
            )?;
            Ok::<(), JobError>(())
        };
        let (scene, path) = (&inputs.scene.scene, &inputs.path.path);
        let (found, name) = (self.found, &self.path_hash);
        let work = || bake_with_room(scene, path, name, settings, found, listener, reserve);
        let baked = inputs.pool.install(work)?;
        if let Some((file, begun)) = file.zip(begun) {
            tolerate(file.finish(begun, &baked.state).map(|()| None))?;
        }
        drop(lock);
        Ok((baked, not_kept))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::IntegratorSettings;

    /// The cache of another build is another cache, and frames that look it up are other frames.
    #[test]
    fn caches_of_other_builds_are_accepted_knowingly() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("shared.cache");
        let inputs = Inputs::load("scenes/test.ron".as_ref(), "paths/test.ron".as_ref(), None);
        let inputs = inputs.expect("shipped");
        let settings = RenderSettings::new(IntegratorSettings::Cached { bounces: 2 }, 16, 12);
        let open = |accepted: &[&str]| {
            let options = JobOptions {
                accepted_builds: accepted.iter().map(|build| (*build).to_owned()).collect(),
                ..JobOptions::default()
            };
            OpenedCache::open(
                CacheLocation::Shared(file.clone()),
                &inputs,
                &settings,
                &options,
            )
        };
        let none = open(&["older"]).expect("no file yet");
        assert!(none.found.is_none());
        let state = BakeState::new(2, 0);
        let older = CacheFile::new(&file, cache_hash(&inputs, &settings, "older"));
        older
            .finish(older.begin().expect("can be written"), &state)
            .expect("written");
        assert!(matches!(
            open(&[]),
            Err(JobError::Cache(CacheFileError::OtherInputs { .. }))
        ));
        let accepted = open(&["oldest", "older"]).expect("accepted");
        assert!(accepted.found.is_some());
        assert_ne!(accepted.identity(), none.identity());
    }
}
