//! The file of a baked irradiance cache, which runs of the program share: a magic text, a hash of all that follows,
//! the input hash, and the [`BakeState`] in postcard encoding.

use super::bake_state::BakeState;
use crate::storage::{FileError, FileLock, Folder, PartFile, WaitListener, read_input};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;

/// First bytes of the file: name and version of the format.
const MAGIC: &[u8] = b"flythrough irradiance cache 5\n";

/// Bytes of a hash.
const HASH: usize = blake3::OUT_LEN;

/// The most bytes of a file: the most records that are placed take less.
const MAX_BYTES: u64 = 1 << 34;

/// An irradiance cache on disk.
#[derive(Debug)]
pub struct CacheFile {
    file: PathBuf,
    /// A hash of all that decides the records but for the camera paths: scene, settings, build.
    input_hash: blake3::Hash,
}

/// Why an irradiance cache cannot be read or written.
#[derive(Debug, Error)]
pub enum CacheFileError {
    /// The file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file does not begin with the magic text.
    #[error(
        "{file}: is there already, and is not an irradiance cache of this format; use another file name, or bake \
         --replace to write over it",
        file = .file.display()
    )]
    NotACache {
        /// The file.
        file: PathBuf,
    },
    /// The content does not match its hash.
    #[error(
        "{file}: the irradiance cache is damaged: cut short or changed; --force bakes it anew",
        file = .file.display()
    )]
    Damaged {
        /// The file.
        file: PathBuf,
    },
    /// The input hash differs.
    #[error(
        "{file}: is the irradiance cache of another scene, other settings or another build; use another \
         file, or --force to bake it anew",
        file = .file.display()
    )]
    OtherInputs {
        /// The file.
        file: PathBuf,
    },
}

impl CacheFile {
    /// A file that exists or will be written. The input hash is of all that decides the records but for the camera
    /// paths.
    pub fn new(file: &Path, input_hash: blake3::Hash) -> CacheFile {
        CacheFile {
            file: file.to_owned(),
            input_hash,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.file
    }

    /// Waits for the right to write the file, and removes what killed processes left of it. The listener hears of a
    /// process that is waited for.
    pub fn lock(&self, listener: WaitListener) -> Result<Option<FileLock>, CacheFileError> {
        let (folder, name) = Folder::of_file(&self.file)?;
        let lock = folder.lock_with_timeout(name, Duration::MAX, listener)?;
        folder.remove_leftovers(|of| name == of)?;
        Ok(lock)
    }

    /// Begins the file that [`CacheFile::finish`] ends, before the cache is baked: so it is known early that it can be
    /// written.
    pub fn begin(&self) -> Result<PartFile, CacheFileError> {
        Ok(PartFile::of_file(&self.file)?)
    }

    /// Reads the file; none if it does not exist or, with `force`, if it is damaged or has another input hash.
    pub fn read(&self, force: bool) -> Result<Option<BakeState>, CacheFileError> {
        let bytes = match read_input(&self.file, MAX_BYTES) {
            Err(error) if error.is_missing() => return Ok(None),
            read => read?,
        };
        let file = || self.file.clone();
        let content = bytes.strip_prefix(MAGIC);
        let content = content.ok_or_else(|| CacheFileError::NotACache { file: file() })?;
        match self.decode(content) {
            Err(_) if force => Ok(None),
            read => read.map(Some),
        }
    }

    fn decode(&self, content: &[u8]) -> Result<BakeState, CacheFileError> {
        let damaged = || CacheFileError::Damaged {
            file: self.file.clone(),
        };
        let (hash, content) = content.split_at_checked(HASH).ok_or_else(damaged)?;
        if blake3::hash(content).as_bytes() != hash {
            return Err(damaged());
        }
        let (input_hash, state) = content.split_at_checked(HASH).ok_or_else(damaged)?;
        if self.input_hash.as_bytes() != input_hash {
            return Err(CacheFileError::OtherInputs {
                file: self.file.clone(),
            });
        }
        postcard::from_bytes(state).map_err(|_| damaged())
    }

    /// Writes the file atomically: a reader sees the old one or the new one.
    pub fn finish(&self, begun: PartFile, state: &BakeState) -> Result<(), CacheFileError> {
        let content = postcard::to_extend(state, self.input_hash.as_bytes().to_vec());
        let content =
            content.map_err(|error| FileError::writing(&self.file, io::Error::other(error)))?;
        let hash = blake3::hash(&content);
        let bytes = [MAGIC, hash.as_bytes(), &content].concat();
        Ok(begun.finish(&bytes)?)
    }

    /// Bytes of the file of a state that takes `bytes`.
    pub fn bytes(bytes: u64) -> u64 {
        (MAGIC.len() + 2 * HASH) as u64 + bytes
    }
}
