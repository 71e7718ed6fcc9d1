//! Part files: unfinished files beside their targets, locked by whoever writes them.

use std::collections::hash_map::RandomState;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// An unfinished file, under another name beside its target: `.NAME.part`. Dropped without [`PartFile::finish`], it is
/// removed.
///
/// It is locked while it is written, and the system releases the lock when the process ends, however it ends. So only
/// the owner of the lock writes it, and an unlocked part file is a leftover of a process that was killed. On a file
/// system without locks, leftovers are not recognised.
#[derive(Debug)]
pub struct PartFile {
    file: File,
    part: PathBuf,
    target: PathBuf,
}

impl PartFile {
    /// The part file of `target` that all its writers share, locked; none if another writer holds the lock.
    pub fn claim(target: &Path) -> io::Result<Option<PartFile>> {
        let part = beside(target, "");
        loop {
            match PartFile::open(target, &part)? {
                Opened::Locked(part) => return Ok(Some(part)),
                Opened::Busy => return Ok(None),
                Opened::Gone => {}
                Opened::Lockless(_) => return PartFile::create_unique(target).map(Some),
            }
        }
    }

    /// As [`PartFile::claim`], but waits up to `timeout` for another writer, which may hang.
    pub fn lock_with_timeout(target: &Path, timeout: Duration) -> io::Result<Option<PartFile>> {
        let start = Instant::now();
        loop {
            let claim = PartFile::claim(target)?;
            if claim.is_some() || start.elapsed() >= timeout {
                return Ok(claim);
            }
            sleep(Duration::from_millis(20));
        }
    }

    /// A part file of `target` under a random name, which no other writer shares.
    pub fn create_unique(target: &Path) -> io::Result<PartFile> {
        loop {
            // The standard library's hashes begin with random keys.
            let number = RandomState::new().build_hasher().finish();
            let part = beside(target, &format!(".{number:016x}"));
            match PartFile::open(target, &part)? {
                Opened::Locked(part) | Opened::Lockless(part) => return Ok(part),
                // Another process took it for a leftover.
                Opened::Busy | Opened::Gone => {}
            }
        }
    }

    fn open(target: &Path, part: &Path) -> io::Result<Opened> {
        // Not truncated before the lock is held: another writer may own it, or may have finished it meanwhile.
        let options = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(false)
            .open(part);
        let file = options?;
        let part = PartFile {
            file,
            part: part.to_owned(),
            target: target.to_owned(),
        };
        match part.file.try_lock() {
            Ok(()) if !part.is_still_linked() => Ok(part.release_without_removing(Opened::Gone)),
            Ok(()) => Ok(Opened::Locked(part)),
            Err(TryLockError::WouldBlock) => Ok(part.release_without_removing(Opened::Busy)),
            Err(TryLockError::Error(_)) => Ok(Opened::Lockless(part)),
        }
    }

    /// Whether the open file is still the one of this name: it may have been finished or removed before the lock was
    /// held.
    fn is_still_linked(&self) -> bool {
        let open = self.file.metadata();
        let named = fs::metadata(&self.part);
        let same = |(a, b): (fs::Metadata, fs::Metadata)| (a.dev(), a.ino()) == (b.dev(), b.ino());
        open.ok().zip(named.ok()).is_some_and(same)
    }

    /// Leaves the file in place, as it belongs to another process.
    fn release_without_removing(mut self, instead: Opened) -> Opened {
        self.part.clear();
        instead
    }

    /// Reserves `bytes` of disk space, where the file system supports it.
    pub fn reserve(&self, bytes: u64) -> io::Result<()> {
        use rustix::fs::{FallocateFlags, fallocate};
        use rustix::io::Errno;
        match fallocate(&self.file, FallocateFlags::empty(), 0, bytes.max(1)) {
            Err(error @ (Errno::NOSPC | Errno::DQUOT | Errno::FBIG)) => Err(error.into()),
            _ => Ok(()),
        }
    }

    /// Writes the whole file, syncs it to disk and renames it to its target: atomic even if the machine stops
    /// meanwhile.
    pub fn finish(mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.file.set_len(bytes.len() as u64)?;
        self.file.sync_all()?;
        fs::rename(&self.part, &self.target)?;
        self.part.clear();
        Ok(())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        if !self.part.as_os_str().is_empty() {
            // If this fails, `remove_leftovers` removes it later.
            let _ = fs::remove_file(&self.part);
        }
    }
}

enum Opened {
    Locked(PartFile),
    /// The file system supports no locks.
    Lockless(PartFile),
    /// Another writer holds the lock.
    Busy,
    /// The file is no longer the one of this name.
    Gone,
}

fn beside(target: &Path, tag: &str) -> PathBuf {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    target.with_file_name(format!(".{name}{tag}.part"))
}

/// Removes from a folder the part files that killed processes left, of targets whose names begin with one of `names`.
/// What cannot be removed stays.
pub(crate) fn remove_leftovers(folder: &Path, names: &[&str]) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let of = name
            .strip_prefix('.')
            .filter(|name| name.ends_with(".part"));
        let is_own = of.is_some_and(|of| names.iter().any(|name| of.starts_with(name)));
        // Only the holder of the lock may remove the file.
        if is_own && let Ok(Opened::Locked(part)) = PartFile::open(Path::new(""), &entry.path()) {
            drop(part);
        }
    }
    Ok(())
}

/// Writes a file atomically: it exists whole or not at all, even if the machine stops meanwhile.
pub fn write_atomic(file: &Path, bytes: &[u8]) -> io::Result<()> {
    PartFile::create_unique(file)?.finish(bytes)
}

/// Checks that a file can be written, by creating a part file and removing it: call it before long work.
pub fn check_writable(file: &Path) -> io::Result<()> {
    PartFile::create_unique(file).map(drop)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::names;
    use super::*;

    #[test]
    fn a_claim_is_exclusive_until_it_ends() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a.png");
        let claim = || PartFile::claim(&target).expect("can be written");
        let mine = claim().expect("free");
        assert!(claim().is_none());
        let unique = PartFile::create_unique(&target).expect("always");
        unique.finish(b"theirs").expect("written");
        assert!(claim().is_none());
        mine.finish(b"mine").expect("written");
        assert_eq!(fs::read(&target).expect("there"), b"mine");
        drop(claim().expect("free again"));
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn leftovers_are_unlocked_part_files() {
        let folder = tempfile::tempdir().expect("a folder");
        let held = PartFile::claim(&folder.path().join("held.png")).expect("can be written");
        let left = [".left.png.part", ".left.png.0123.part"];
        let of_others = [".film.part", ".left.png", "left.part"];
        for name in left.iter().chain(&of_others) {
            fs::write(folder.path().join(name), "half").expect("written");
        }
        remove_leftovers(folder.path(), &["left", "held"]).expect("can be read");
        let there = [".film.part", ".held.png.part", ".left.png", "left.part"];
        assert_eq!(names(folder.path()), there);
        drop(held);
    }

    /// A leftover is longer than what is written over it.
    #[test]
    fn nothing_of_a_leftover_remains() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a.png");
        fs::write(folder.path().join(".a.png.part"), [7; 100]).expect("written");
        let claim = PartFile::claim(&target)
            .expect("can be written")
            .expect("free");
        claim.reserve(1000).expect("there is room");
        claim.finish(b"short").expect("written");
        assert_eq!(fs::read(&target).expect("there"), b"short");
    }

    /// Many threads claim one file, then finish or drop it: the target is always whole. Each goes on until it has had
    /// the claim 50 times, however long another thread that holds it waits for a core.
    #[test]
    fn racing_writers_never_mix() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a.png");
        let write = |byte: u8| {
            let mut claims = 0;
            while claims < 50 {
                let claim = PartFile::claim(&target).expect("can be written");
                claims += u32::from(claim.is_some());
                match claim {
                    Some(part) if byte.is_multiple_of(2) => drop(part),
                    Some(part) => part.finish(&[byte; 5000]).expect("written"),
                    None => std::thread::yield_now(),
                }
                if let Ok(there) = fs::read(&target) {
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
        assert_eq!(names(folder.path()), ["a.png"]);
    }
}
