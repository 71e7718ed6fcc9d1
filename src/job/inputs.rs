//! The scene and the camera path of a job, loaded.

use super::error::JobError;
use crate::camera_formats::{CameraPathInput, load_camera_path};
use crate::input::{InputFiles, SceneInput, Settings, load_scene};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;
use std::path::Path;
use std::thread::available_parallelism;

/// A scene, a camera path and the threads to render them on.
#[derive(Debug)]
pub struct Inputs {
    /// The scene.
    pub scene: SceneInput,
    /// The camera path.
    pub path: CameraPathInput,
    /// The files of both, as they were read.
    files: [InputFiles; 2],
    /// A hash of every file that the scene is made of.
    pub scene_hash: blake3::Hash,
    /// A hash of the path's file.
    pub path_hash: blake3::Hash,
    /// The threads.
    pub pool: ThreadPool,
}

impl Inputs {
    /// Loads a scene and a camera path.
    pub fn load(
        scene: &Path,
        path: &Path,
        threads: Option<NonZeroUsize>,
    ) -> Result<Inputs, JobError> {
        let mut path_files = InputFiles::default();
        let path = load_camera_path(path, &mut path_files)?;
        let pool = pool(threads)?;
        let mut scene_files = InputFiles::default();
        let scene = pool.install(|| load_scene(scene, &mut scene_files))?;
        Ok(Inputs {
            scene,
            path,
            scene_hash: scene_files.fingerprint(),
            path_hash: path_files.fingerprint(),
            files: [scene_files, path_files],
            pool,
        })
    }

    /// Settings of the command, the path and the scene; the first that gives one wins.
    pub fn settings(&self, overrides: Settings) -> Settings {
        let of_files = self.path.settings.clone().or(self.scene.settings.clone());
        overrides.or(of_files)
    }

    /// The files that have changed since they were loaded.
    pub fn changed_files(&self) -> Vec<&Path> {
        self.files.iter().flat_map(InputFiles::changed).collect()
    }

    /// Frames of the path.
    pub fn frame_count(&self) -> u32 {
        self.path.path.timeline().frame_count()
    }
}

/// A pool of `threads`; by default as many as the process may use.
pub fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, JobError> {
    let threads = match threads {
        Some(threads) => threads,
        None => available_parallelism()?,
    };
    Ok(ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build()?)
}
