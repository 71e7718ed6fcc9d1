//! The irradiance cache of a job: its location, and what is there already.

use super::error::JobError;
use super::identity::{BUILD, CacheIdentity, cache_hash};
use super::inputs::Inputs;
use super::options::JobOptions;
use crate::bake::{BakeKeeper, BakeState, Baked, CacheFile, CacheFileError, Listener, bake_kept};
use crate::memory::check_room;
use crate::render::RenderSettings;
use crate::storage::{PartFile, WaitListener};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

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
                && (!is_own || holds_no_other(&found, &path_hash))
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
        let found = found.filter(|found| !is_own || holds_no_other(found, &path_hash));
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
        let mut keeper = FileKeeper::begin(self.file.filter(|_| !is_complete), keep)?;
        let (scene, path) = (&inputs.scene.scene, &inputs.path.path);
        let (found, name) = (self.found, &self.path_hash);
        let work = || bake_kept(scene, path, name, settings, found, listener, &mut keeper);
        let baked = inputs.pool.install(work)?;
        keeper.write(&baked.state)?;
        let not_kept = keeper.not_kept;
        drop(lock);
        Ok((baked, not_kept))
    }
}

/// Whether a state has the records of no other path; those of this one may be on the way.
fn holds_no_other(state: &BakeState, path_hash: &str) -> bool {
    state.camera_paths().all(|path| path == path_hash)
}

/// Bakes that take longer than this are written while they go on.
const CHECKPOINT: Duration = Duration::from_secs(60);

/// Writes the file of a cache.
struct FileKeeper {
    /// None if nothing is written.
    file: Option<CacheFile>,
    keep: KeepCache,
    /// The file that is written next; none if it cannot be.
    begun: Option<PartFile>,
    /// The bytes to reserve for it.
    bytes: u64,
    written: Instant,
    /// Why it cannot be kept.
    not_kept: Option<CacheFileError>,
}

impl FileKeeper {
    fn begin(file: Option<CacheFile>, keep: KeepCache) -> Result<FileKeeper, CacheFileError> {
        let mut keeper = FileKeeper {
            file,
            keep,
            begun: None,
            bytes: 0,
            written: Instant::now(),
            not_kept: None,
        };
        keeper.begin_next()?;
        Ok(keeper)
    }

    fn begin_next(&mut self) -> Result<(), CacheFileError> {
        let begun = self.file.as_ref().map(CacheFile::begin).transpose();
        self.begun = self.tolerated(begun)?;
        Ok(())
    }

    /// Gathering the light takes long: there has to be room for it.
    fn reserve_next(&mut self) -> Result<(), CacheFileError> {
        let bytes = self.bytes;
        let reserved = self.begun.take().map(|begun| {
            begun.reserve(CacheFile::bytes(bytes))?;
            Ok(begun)
        });
        self.begun = self.tolerated(reserved.transpose())?;
        Ok(())
    }

    fn write(&mut self, state: &BakeState) -> Result<(), CacheFileError> {
        let finished = match (&self.file, self.begun.take()) {
            (Some(file), Some(begun)) => file.finish(begun, state).map(|()| None::<()>),
            _ => Ok(None),
        };
        self.tolerated(finished)?;
        Ok(())
    }

    fn tolerated<T>(
        &mut self,
        done: Result<Option<T>, CacheFileError>,
    ) -> Result<Option<T>, CacheFileError> {
        match (done, self.keep) {
            (Err(error), KeepCache::IfPossible) => {
                self.not_kept = Some(error);
                Ok(None)
            }
            (done, _) => done,
        }
    }
}

impl BakeKeeper for FileKeeper {
    type Error = JobError;

    fn reserve(&mut self, bytes: u64) -> Result<(), JobError> {
        self.bytes = bytes;
        self.reserve_next()?;
        // Records as they are baked, as frames look them up, and as a file.
        check_room(
            "the irradiance cache",
            4 * bytes,
            "choose a smaller --size, or --gi path-traced",
        )?;
        Ok(())
    }

    fn checkpoint(&mut self, state: &BakeState) -> Result<(), JobError> {
        if self.begun.is_some() && self.written.elapsed() > CHECKPOINT {
            self.write(state)?;
            self.begin_next()?;
            self.reserve_next()?;
            self.written = Instant::now();
        }
        Ok(())
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
