//! The irradiance cache of a job: where it is kept, and what is there already.

use super::error::JobError;
use super::identity::{BUILD, cache_hash};
use super::inputs::Inputs;
use super::options::JobOptions;
use crate::bake::{BakeState, Baked, CacheFile, Listener, bake};
use crate::render::RenderSettings;
use std::path::PathBuf;

/// Where an irradiance cache is kept.
#[derive(Debug)]
pub enum CacheStore {
    /// In a file that jobs share: what it holds for other paths stays.
    Shared(PathBuf),
    /// In a file of this path alone: what it holds for others does not count, so that the cache is that of a first run.
    Own(PathBuf),
    /// In memory.
    Memory,
}

/// An irradiance cache, as far as a file holds it already.
#[derive(Debug)]
pub struct CacheSource {
    file: Option<CacheFile>,
    found: Option<BakeState>,
    /// Names the path in the cache.
    path_hash: String,
}

impl CacheSource {
    /// Reads what is kept for frames of these settings. With `rebake` in the options, a shared file that is damaged or of
    /// something else counts as none.
    pub fn open(
        store: CacheStore,
        inputs: &Inputs,
        settings: &RenderSettings,
        options: &JobOptions,
    ) -> Result<CacheSource, JobError> {
        let path_hash = inputs.path_hash.to_string();
        let hash = |build: &str| cache_hash(inputs, settings, build);
        let accepted = options.accepted_builds.iter().map(|build| hash(build));
        let accepted: Vec<blake3::Hash> = accepted.collect();
        let cache_file = |file: PathBuf| CacheFile::new(&file, hash(BUILD), accepted);
        let (file, found) = match store {
            CacheStore::Shared(file) => {
                let file = cache_file(file);
                let found = file.read(options.rebake)?;
                (Some(file), found)
            }
            CacheStore::Own(file) => {
                let file = cache_file(file);
                // What is of no use is written over.
                let found = file.read(true).ok().flatten();
                let is_own = |found: &BakeState| found.paths() == [path_hash.as_str()];
                (Some(file), found.filter(is_own))
            }
            CacheStore::Memory => (None, None),
        };
        Ok(CacheSource {
            file,
            found,
            path_hash,
        })
    }

    /// The hashes of all paths that the cache will be baked for, in order: it depends on them.
    pub fn paths(&self) -> Vec<String> {
        let found = self.found.as_ref();
        let mut paths = found.map_or(Vec::new(), |found| found.paths().to_vec());
        if !paths.contains(&self.path_hash) {
            paths.push(self.path_hash.clone());
        }
        paths
    }

    /// Whether nothing is left to bake.
    pub fn is_complete(&self, settings: &RenderSettings) -> bool {
        self.found.as_ref().is_some_and(|found| {
            found
                .errors(&self.path_hash, settings.display_white)
                .is_some()
        })
    }

    /// Bakes what is missing, and keeps it.
    pub fn bake(
        self,
        inputs: &Inputs,
        settings: &RenderSettings,
        listener: Listener,
    ) -> Result<Baked, JobError> {
        let is_complete = self.is_complete(settings);
        let file = self.file.filter(|_| !is_complete);
        if let Some(file) = &file {
            file.check_writable()?;
        }
        let (scene, path) = (&inputs.scene.scene, &inputs.path.path);
        let (found, name) = (self.found, &self.path_hash);
        let work = || bake(scene, path, name, settings, found, listener);
        let baked = inputs.pool.install(work);
        if let Some(file) = file {
            file.write(&baked.state)?;
        }
        Ok(baked)
    }
}
