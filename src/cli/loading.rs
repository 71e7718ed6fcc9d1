use super::input_args::{InputArguments, ThreadsArgument};
use super::{Failure, warn};
use crate::camera_formats::{CameraPathInput, load_camera_path};
use crate::input::{InputFiles, SceneInput, Settings, load_scene};

/// A scene, a path and the threads to render them on.
pub(super) struct Loaded {
    pub(super) scene: SceneInput,
    pub(super) path: CameraPathInput,
    /// A hash of every file that the scene is made of.
    pub(super) scene_fingerprint: blake3::Hash,
    /// A hash of the path's file.
    pub(super) path_fingerprint: blake3::Hash,
    pub(super) pool: rayon::ThreadPool,
}

/// Loads what a command names, and says what is odd about it. Threads are all that the process may use unless given.
pub(super) fn load(input: &InputArguments, threads: &ThreadsArgument) -> Result<Loaded, Failure> {
    let mut path_files = InputFiles::default();
    let path = load_camera_path(&input.path, &mut path_files)?;
    let pool = pool(threads)?;
    let mut scene_files = InputFiles::default();
    let scene = pool.install(|| load_scene(&input.scene, &mut scene_files))?;
    warn(&scene.warnings);
    Ok(Loaded {
        scene,
        path,
        scene_fingerprint: scene_files.fingerprint(),
        path_fingerprint: path_files.fingerprint(),
        pool,
    })
}

/// As many threads as are given, else as many as the process may use.
pub(super) fn pool(threads: &ThreadsArgument) -> Result<rayon::ThreadPool, Failure> {
    let threads = match threads.threads {
        Some(threads) => threads.get(),
        None => std::thread::available_parallelism()?.get(),
    };
    Ok(rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?)
}

impl Loaded {
    /// The settings of flags, the path and the scene: who comes first wins.
    pub(super) fn settings(&self, flags: Settings) -> Settings {
        let of_files = self.path.settings.clone().or(self.scene.settings.clone());
        flags.or(of_files)
    }

    /// A hash of every file that was read.
    pub(super) fn fingerprint(&self) -> blake3::Hash {
        let mut both = blake3::Hasher::new();
        both.update(self.scene_fingerprint.as_bytes());
        both.update(self.path_fingerprint.as_bytes());
        both.finalize()
    }
}
