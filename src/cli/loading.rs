use super::args::InputArguments;
use super::{Failure, warn};
use crate::input::{CameraPathInput, InputFiles, SceneInput, load_camera_path, load_scene};
use std::num::NonZeroUsize;

/// A scene, a path and the threads to render them on.
pub(super) struct Loaded {
    pub(super) scene: SceneInput,
    pub(super) path: CameraPathInput,
    /// A hash of every file that was read.
    pub(super) fingerprint: blake3::Hash,
    pub(super) pool: rayon::ThreadPool,
}

/// Loads what a command names, and says what is odd about it. Threads are all cores unless given.
pub(super) fn load(
    input: &InputArguments,
    threads: Option<NonZeroUsize>,
) -> Result<Loaded, Failure> {
    let mut files = InputFiles::default();
    let path = load_camera_path(&input.path, &mut files)?;
    let threads = match threads {
        Some(threads) => threads.get(),
        None => std::thread::available_parallelism()?.get(),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    let scene = pool.install(|| load_scene(&input.scene, &mut files))?;
    warn(&scene.warnings);
    Ok(Loaded {
        scene,
        path,
        fingerprint: files.fingerprint(),
        pool,
    })
}
