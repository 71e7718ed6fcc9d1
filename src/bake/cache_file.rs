//! The file of a baked irradiance cache, which runs of the program share: a magic text, a hash of all that follows,
//! the input hash, and the [`BakeState`] in postcard encoding.

use super::bake_state::BakeState;
use crate::storage::{check_writable, write_atomic};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// First bytes of the file: name and version of the format.
const MAGIC: &[u8] = b"flythrough irradiance cache 3\n";

/// Bytes of a hash.
const HASH: usize = blake3::OUT_LEN;

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
    /// The file exists, but cannot be read.
    #[error("{file}: cannot be read: {source}", file = .file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file cannot be written.
    #[error("{file}: cannot be written: {source}", file = .file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file does not begin with the magic text. It is never written over.
    #[error(
        "{file}: is not an irradiance cache of this format; use another file name, or remove the file \
         if it is an old cache",
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

    /// Checks that the file can be written, before the cache is baked.
    pub fn check_writable(&self) -> Result<(), CacheFileError> {
        check_writable(&self.file).map_err(|source| self.unwritable(source))
    }

    /// Reads the file; none if it does not exist or, with `force`, if it is damaged or has another input hash.
    pub fn read(&self, force: bool) -> Result<Option<BakeState>, CacheFileError> {
        let file = || self.file.clone();
        let bytes = match fs::read(&self.file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|source| CacheFileError::Unreadable {
                file: file(),
                source,
            })?,
        };
        let Some(content) = bytes.strip_prefix(MAGIC) else {
            return Err(CacheFileError::NotACache { file: file() });
        };
        let read = self.decode(content);
        match read {
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
    pub fn write(&self, state: &BakeState) -> Result<(), CacheFileError> {
        let content = postcard::to_extend(state, self.input_hash.as_bytes().to_vec());
        let written = content.map_err(io::Error::other).and_then(|content| {
            let hash = blake3::hash(&content);
            let bytes = [MAGIC, hash.as_bytes(), &content].concat();
            write_atomic(&self.file, &bytes)
        });
        written.map_err(|source| self.unwritable(source))
    }

    fn unwritable(&self, source: io::Error) -> CacheFileError {
        CacheFileError::Unwritable {
            file: self.file.clone(),
            source,
        }
    }
}
