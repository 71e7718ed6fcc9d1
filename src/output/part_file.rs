use std::collections::hash_map::RandomState;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A file that is not finished yet, under another name beside its own: `.NAME.part`.
///
/// It is locked while somebody writes it, and the system lets go of the lock when that process ends, however
/// it ends. So nobody writes it beside its owner, and one that is not locked is a leftover. Where a file system
/// knows no locks, only leftovers are not found.
#[derive(Debug)]
pub struct PartFile {
    file: File,
    part: PathBuf,
    target: PathBuf,
}

impl PartFile {
    /// The one part of `target` that all who mean to write it agree on; none if somebody else writes it.
    pub(super) fn claim(target: &Path) -> io::Result<Option<PartFile>> {
        let part = beside(target, "");
        loop {
            match PartFile::open(target, &part)? {
                Opened::Locked(part) => return Ok(Some(part)),
                Opened::Busy => return Ok(None),
                Opened::Gone => {}
                Opened::Lockless(_) => return PartFile::own(target).map(Some),
            }
        }
    }

    /// The one part of `target` that all who mean to write it agree on. Whoever else writes it is waited for, so long
    /// at most, as they may hang; none if they still do.
    pub fn claim_in_turn(target: &Path, at_most: Duration) -> io::Result<Option<PartFile>> {
        let start = Instant::now();
        loop {
            let claim = PartFile::claim(target)?;
            if claim.is_some() || start.elapsed() >= at_most {
                return Ok(claim);
            }
            sleep(Duration::from_millis(20));
        }
    }

    /// A part of `target` that nobody else writes, whoever else writes another.
    pub(super) fn own(target: &Path) -> io::Result<PartFile> {
        loop {
            // The standard library's hashes begin with random keys.
            let number = RandomState::new().build_hasher().finish();
            let part = beside(target, &format!(".{number:016x}"));
            match PartFile::open(target, &part)? {
                Opened::Locked(part) | Opened::Lockless(part) => return Ok(part),
                // Somebody takes it for a leftover.
                Opened::Busy | Opened::Gone => {}
            }
        }
    }

    fn open(target: &Path, part: &Path) -> io::Result<Opened> {
        // Nothing is cut before the lock is held: what is there may be somebody's, or even be finished by now.
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
            Ok(()) if !part.has_its_name() => Ok(part.forget(Opened::Gone)),
            Ok(()) => Ok(Opened::Locked(part)),
            Err(TryLockError::WouldBlock) => Ok(part.forget(Opened::Busy)),
            Err(TryLockError::Error(_)) => Ok(Opened::Lockless(part)),
        }
    }

    /// Whether the file that is open is still the one of this name: it may have been finished or removed
    /// before the lock was held.
    fn has_its_name(&self) -> bool {
        let open = self.file.metadata();
        let named = fs::metadata(&self.part);
        let same = |(a, b): (fs::Metadata, fs::Metadata)| (a.dev(), a.ino()) == (b.dev(), b.ino());
        open.ok().zip(named.ok()).is_some_and(same)
    }

    /// Leaves the file as it is, to whom it belongs.
    fn forget(mut self, instead: Opened) -> Opened {
        self.part.clear();
        instead
    }

    /// Makes sure that so many bytes can be written, where the file system knows how.
    pub(super) fn reserve(&self, bytes: u64) -> io::Result<()> {
        use rustix::fs::{FallocateFlags, fallocate};
        use rustix::io::Errno;
        match fallocate(&self.file, FallocateFlags::empty(), 0, bytes.max(1)) {
            Err(error @ (Errno::NOSPC | Errno::DQUOT | Errno::FBIG)) => Err(error.into()),
            _ => Ok(()),
        }
    }

    /// Writes all of the file and gives it its name: whole or not at all, even if the machine stops in between.
    pub(super) fn finish(mut self, bytes: &[u8]) -> io::Result<()> {
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
            // Nothing more can be done about a leftover than to try.
            let _ = fs::remove_file(&self.part);
        }
    }
}

enum Opened {
    Locked(PartFile),
    /// The file system knows no locks.
    Lockless(PartFile),
    /// Somebody else holds the lock.
    Busy,
    /// The file is no longer the one of this name.
    Gone,
}

fn beside(target: &Path, tag: &str) -> PathBuf {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    target.with_file_name(format!(".{name}{tag}.part"))
}

/// Removes what processes that were killed left in a folder of files whose names begin with one of `names`. What
/// cannot be removed stays.
pub(super) fn remove_leftovers(folder: &Path, names: &[&str]) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let of = name
            .strip_prefix('.')
            .filter(|name| name.ends_with(".part"));
        let is_own = of.is_some_and(|of| names.iter().any(|name| of.starts_with(name)));
        // Whoever holds the lock of a file that has its name may remove it.
        if is_own && let Ok(Opened::Locked(part)) = PartFile::open(Path::new(""), &entry.path()) {
            drop(part);
        }
    }
    Ok(())
}

/// Writes a file so that it is there whole or not at all, even if the machine stops in between.
pub fn write_whole(file: &Path, bytes: &[u8]) -> io::Result<()> {
    PartFile::own(file)?.finish(bytes)
}

/// Proves that a file can be written, by a part of it that is there for a moment: before the work, not after.
pub fn try_out(file: &Path) -> io::Result<()> {
    PartFile::own(file).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::names;

    #[test]
    fn a_claim_is_one_persons_until_it_ends() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a.png");
        let claim = || PartFile::claim(&target).expect("can be written");
        let mine = claim().expect("free");
        assert!(claim().is_none());
        let insisted = PartFile::own(&target).expect("always");
        insisted.finish(b"theirs").expect("written");
        assert!(claim().is_none());
        mine.finish(b"mine").expect("written");
        assert_eq!(fs::read(&target).expect("there"), b"mine");
        drop(claim().expect("free again"));
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn leftovers_are_those_that_nobody_holds() {
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

    /// Many threads claim one file, write it and lose it: what is there is always whole. Each goes on until it has had
    /// the claim so many times, however long another thread that has it waits for a core.
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
