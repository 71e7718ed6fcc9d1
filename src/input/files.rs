//! Reads input files and hashes their contents.

use super::error::InputError;
use crate::memory::check_room;
use crate::storage::read_input;
use std::fs;
use std::path::{Path, PathBuf};

/// Reads input files and hashes their contents, which identify the inputs of frames.
#[derive(Debug, Default)]
pub struct InputFiles {
    /// The files and the hashes of their contents, in the order in which they were read.
    read: Vec<(PathBuf, blake3::Hash)>,
}

impl InputFiles {
    /// The bytes of a file that the user named. An error if it is not a regular file: a device may have no end.
    pub fn read(&mut self, file: &Path) -> Result<Vec<u8>, InputError> {
        let length = fs::metadata(file).map_or(0, |is| is.len());
        check_room(&file.display().to_string(), length, "use a smaller file")?;
        let bytes = read_input(file, u64::MAX)?;
        self.read.push((file.to_owned(), blake3::hash(&bytes)));
        Ok(bytes)
    }

    /// The bytes of a file that the file `from` names at `key`.
    pub fn read_reference(
        &mut self,
        file: &Path,
        from: &Path,
        key: &str,
    ) -> Result<Vec<u8>, InputError> {
        self.read(file).map_err(|error| match error {
            InputError::Read(error) => InputError::Reference {
                file: from.to_owned(),
                key: key.to_owned(),
                missing: error.file,
                source: error.source,
            },
            other => other,
        })
    }

    /// The files whose contents have changed since they were read, or that cannot be read any more.
    pub fn changed(&self) -> Vec<&Path> {
        let is_changed = |(file, hash): &&(PathBuf, blake3::Hash)| {
            let now = read_input(file, u64::MAX);
            !now.is_ok_and(|bytes| blake3::hash(&bytes) == *hash)
        };
        let changed = self.read.iter().filter(is_changed);
        changed.map(|(file, _)| &**file).collect()
    }

    /// A hash of the contents of all files read so far, in their order. Names and folders do not count.
    pub fn fingerprint(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        for (_, hash) in &self.read {
            hasher.update(hash.as_bytes());
        }
        hasher.finalize()
    }
}

/// The path of the file that `file` names as `name`: relative to that file's folder, with either kind of slash.
pub(crate) fn relative_to(file: &Path, name: &str) -> PathBuf {
    let name = name.trim().replace('\\', "/");
    file.parent().unwrap_or(Path::new("")).join(name)
}
