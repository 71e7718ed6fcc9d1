//! Part files: unfinished files beside their targets.

use super::error::FileError;
use super::folder::Folder;
use super::temporary_file::{Opened, PART, TemporaryFile, hidden};
use rustix::fs::{FallocateFlags, OFlags, fallocate};
use rustix::io::Errno;
use std::collections::hash_map::RandomState;
use std::ffi::{OsStr, OsString};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Write};
use std::path::Path;

/// An unfinished file, under an unpredictable name beside its target: `.NAME.0123456789abcdef.part`. Dropped without
/// [`PartFile::finish`], it is removed.
#[derive(Debug)]
pub struct PartFile {
    part: TemporaryFile,
    folder: Folder,
    target: OsString,
}

impl PartFile {
    /// Begins a file that takes its name when it is finished.
    pub fn of_file(file: &Path) -> Result<PartFile, FileError> {
        let (folder, name) = Folder::of_file(file)?;
        PartFile::new(&folder, name)
    }

    pub(super) fn new(folder: &Folder, target: &OsStr) -> Result<PartFile, FileError> {
        let open = || loop {
            // The standard library's hashes begin with random keys.
            let number = RandomState::new().build_hasher().finish();
            let name = hidden(target, &format!(".{number:016x}{PART}"));
            match TemporaryFile::open(folder, &name, OFlags::WRONLY | OFlags::EXCL) {
                Ok(Opened::Locked(part) | Opened::Lockless(part)) => return Ok(part),
                // Another process took it for a leftover.
                Ok(Opened::Busy | Opened::Gone) => {}
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        };
        let part = open().map_err(|error| FileError::writing(&folder.file(target), error))?;
        Ok(PartFile {
            part,
            folder: folder.clone(),
            target: target.to_owned(),
        })
    }

    /// Reserves `bytes` of disk space, where the file system supports it.
    pub fn reserve(&self, bytes: u64) -> Result<(), FileError> {
        match fallocate(&self.part.file, FallocateFlags::empty(), 0, bytes.max(1)) {
            Err(error @ (Errno::NOSPC | Errno::DQUOT | Errno::FBIG)) => {
                Err(FileError::writing(&self.folder.file(&self.target), error))
            }
            _ => Ok(()),
        }
    }

    /// Writes the whole file, syncs it to disk and renames it to its target: atomic even if the machine stops
    /// meanwhile. What has that name is replaced; if it is a link, the link is.
    pub fn finish(self, bytes: &[u8]) -> Result<(), FileError> {
        let PartFile {
            part,
            folder,
            target,
        } = self;
        let finish = || {
            let mut file = &part.file;
            file.write_all(bytes)?;
            file.set_len(bytes.len() as u64)?;
            file.sync_all()?;
            part.rename(&target)
        };
        finish().map_err(|error| FileError::writing(&folder.file(&target), error))
    }
}

impl Folder {
    /// Writes a file atomically: it exists whole or not at all, even if the machine stops meanwhile. What has its name
    /// is replaced.
    pub fn write_atomic(&self, name: impl AsRef<OsStr>, bytes: &[u8]) -> Result<(), FileError> {
        self.part_file(name)?.finish(bytes)
    }

    /// Begins a file that takes its name when it is finished.
    pub fn part_file(&self, name: impl AsRef<OsStr>) -> Result<PartFile, FileError> {
        PartFile::new(self, name.as_ref())
    }
}

/// Writes a file atomically: see [`Folder::write_atomic`].
pub fn write_atomic(file: &Path, bytes: &[u8]) -> Result<(), FileError> {
    PartFile::of_file(file)?.finish(bytes)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::names;
    use super::super::lock::FileLock;
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn leftovers_are_unlocked_and_regular() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("there");
        let held = folder.lock("held.png").expect("can be locked");
        let written = folder.part_file("left.png").expect("can be written");
        let left = [".left.png.0123456789abcdef.part", ".left.png.lock"];
        let of_others = [".film.png.lock", ".left.png", ".left.png.part", "left.part"];
        for name in left.iter().chain(&of_others) {
            let content = if name.ends_with(".lock") { "" } else { "half" };
            fs::write(folder.file(name), content).expect("written");
        }
        fs::write(
            folder.file(".noted.png.lock"),
            "nothing is written in locks",
        )
        .expect("written");
        symlink("left.part", folder.file(".linked.png.lock")).expect("linked");
        folder
            .remove_leftovers(|name| {
                ["left.png", "held.png", "linked.png", "noted.png"].contains(&name)
            })
            .expect("can be read");
        let there = [
            ".film.png.lock",
            ".held.png.lock",
            ".left.png",
            ".left.png.part",
            ".linked.png.lock",
            ".noted.png.lock",
            "left.part",
        ];
        let mut found = names(root.path());
        // The one that is being written has a random name.
        found.retain(|name| name.len() < 20);
        assert_eq!(found, there);
        written.finish(b"whole").expect("was left alone");
        drop(held);
    }

    /// Room that was reserved is given back.
    #[test]
    fn a_file_is_as_long_as_what_is_written() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("there");
        let part = folder.part_file("a.png").expect("can be written");
        part.reserve(1000).expect("there is room");
        part.finish(b"short").expect("written");
        assert_eq!(fs::read(folder.file("a.png")).expect("there"), b"short");
    }

    #[test]
    fn a_link_is_replaced_and_not_written_through() {
        let root = tempfile::tempdir().expect("a folder");
        let file = |name: &str| root.path().join(name);
        fs::write(file("precious"), "data").expect("written");
        symlink("precious", file("a.png")).expect("linked");
        let folder = Folder::open(root.path()).expect("there");
        let read = folder.read("a.png", 10).expect_err("a link").to_string();
        assert!(
            read.ends_with("a.png: cannot be read: it is a link"),
            "{read}"
        );
        write_atomic(&file("a.png"), b"new").expect("written");
        assert_eq!(fs::read(file("precious")).expect("there"), b"data");
        assert_eq!(folder.read("a.png", 10).expect("a file"), b"new");
    }

    /// Many threads lock one file, then write it or not: it is always whole. Each goes on until it has had the lock 50
    /// times, however long another thread that holds it waits for a core.
    #[test]
    fn racing_writers_never_mix() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("there");
        let write = |byte: u8| {
            let mut locks = 0;
            while locks < 50 {
                let lock: Option<FileLock> = folder.lock("a.png").expect("can be locked");
                locks += u32::from(lock.is_some());
                match lock {
                    Some(_) if byte.is_multiple_of(2) => {}
                    Some(_lock) => folder
                        .write_atomic("a.png", &[byte; 5000])
                        .expect("written"),
                    None => std::thread::yield_now(),
                }
                if let Ok(there) = fs::read(folder.file("a.png")) {
                    assert_eq!(there.len(), 5000);
                    assert!(there.iter().all(|byte| *byte == there[0]));
                }
            }
        };
        std::thread::scope(|scope| {
            for byte in 0..4 {
                scope.spawn(move || write(byte));
            }
        });
        assert_eq!(names(root.path()), ["a.png"]);
    }
}
