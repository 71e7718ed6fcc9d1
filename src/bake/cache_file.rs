use super::BakeState;
use crate::storage::{check_writable, write_atomic};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What such a file begins with: its format and the number of that.
const MAGIC: &[u8] = b"flythrough light 2\n";

/// Bytes of a hash.
const HASH: usize = blake3::OUT_LEN;

/// A file of light that camera paths share: the magic, a hash of all that follows, a hash of what the light is
/// of, and the light.
#[derive(Debug)]
pub struct CacheFile {
    file: PathBuf,
    /// A hash of all that decides the light but for the paths: scene, settings, program version.
    fingerprint: blake3::Hash,
    /// The same for other builds of the program whose caches count as this one's.
    accepted: Vec<blake3::Hash>,
}

/// Why a file of light cannot be used.
#[derive(Debug, Error)]
pub enum CacheFileError {
    /// It is there, but cannot be read.
    #[error("{file}: cannot be read: {source}", file = .file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It cannot be written.
    #[error("{file}: cannot be written: {source}", file = .file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is something else.
    #[error("{file}: is no file of light of this version; use another name", file = .file.display())]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// It is not what was written.
    #[error(
        "{file}: is damaged: cut short or changed; --force works the light out anew",
        file = .file.display()
    )]
    Damaged {
        /// The file.
        file: PathBuf,
    },
    /// It is the light of something else.
    #[error(
        "{file}: holds the light of another scene, other settings or another version; use another \
         file, or --force to work it out anew",
        file = .file.display()
    )]
    Other {
        /// The file.
        file: PathBuf,
    },
}

impl CacheFile {
    /// A file that is there or will be. What is written has the first hash; what is read may have any of them.
    pub fn new(file: &Path, fingerprint: blake3::Hash, accepted: Vec<blake3::Hash>) -> CacheFile {
        CacheFile {
            file: file.to_owned(),
            fingerprint,
            accepted,
        }
    }

    /// Proves that it can be written, before the work and not after.
    pub fn check_writable(&self) -> Result<(), CacheFileError> {
        check_writable(&self.file).map_err(|source| self.unwritable(source))
    }

    /// The light that it holds; none if there is no such file. With `force` none, too, if it is damaged or of
    /// something else.
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
            return Err(CacheFileError::Foreign { file: file() });
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
        let (fingerprint, light) = content.split_at_checked(HASH).ok_or_else(damaged)?;
        let is_it = |hash: &blake3::Hash| hash.as_bytes() == fingerprint;
        if !is_it(&self.fingerprint) && !self.accepted.iter().any(is_it) {
            return Err(CacheFileError::Other {
                file: self.file.clone(),
            });
        }
        postcard::from_bytes(light).map_err(|_| damaged())
    }

    /// Keeps light for other runs: the file is there whole or not at all.
    pub fn write(&self, light: &BakeState) -> Result<(), CacheFileError> {
        let content = postcard::to_extend(light, self.fingerprint.as_bytes().to_vec());
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
