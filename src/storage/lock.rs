//! Locks that processes share.

use super::error::FileError;
use super::folder::Folder;
use super::temporary_file::{LOCK, Opened, TemporaryFile, hidden};
use rustix::fs::OFlags;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Hears of a file whose lock another process holds, and which is waited for.
pub type WaitListener<'a> = &'a dyn Fn(&Path);

/// The right to write a file, which one process has at a time: a lock on `.NAME.lock` beside it, in which nothing is
/// ever written. Released when dropped.
///
/// On a file system without locks, and where something else has that name, everybody has the right: files are written
/// under names that nobody shares, so they are whole all the same.
#[derive(Debug)]
pub struct FileLock {
    _file: Option<TemporaryFile>,
}

impl Folder {
    /// The lock on a file, none if another process holds it. See [`FileLock`].
    pub fn lock(&self, name: impl AsRef<OsStr>) -> Result<Option<FileLock>, FileError> {
        FileLock::try_new(self, name.as_ref())
    }

    /// The lock on a file, for which it waits up to `timeout`, none after that: another process may hang. The listener
    /// hears of it once if the lock is not free at first.
    pub fn lock_with_timeout(
        &self,
        name: impl AsRef<OsStr>,
        timeout: Duration,
        listener: WaitListener,
    ) -> Result<Option<FileLock>, FileError> {
        FileLock::wait(self, name.as_ref(), timeout, listener)
    }
}

impl FileLock {
    pub(super) fn try_new(folder: &Folder, name: &OsStr) -> Result<Option<FileLock>, FileError> {
        let lock = hidden(name, LOCK);
        loop {
            let opened = TemporaryFile::open(folder, &lock, OFlags::WRONLY);
            let opened = match opened {
                // It is another user's.
                Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                    TemporaryFile::open(folder, &lock, OFlags::RDONLY)
                }
                opened => opened,
            };
            match opened {
                Ok(Opened::Locked(file) | Opened::Lockless(file)) => {
                    return Ok(Some(FileLock { _file: Some(file) }));
                }
                Ok(Opened::Busy) => return Ok(None),
                Ok(Opened::Gone) => {}
                // It is no regular file.
                Err(error) if error.raw_os_error().is_none() => {
                    return Ok(Some(FileLock { _file: None }));
                }
                Err(error) => return Err(FileError::writing(&folder.file(name), error)),
            }
        }
    }

    pub(super) fn wait(
        folder: &Folder,
        name: &OsStr,
        timeout: Duration,
        listener: WaitListener,
    ) -> Result<Option<FileLock>, FileError> {
        let start = Instant::now();
        let mut is_told = false;
        loop {
            let lock = FileLock::try_new(folder, name)?;
            if lock.is_some() || start.elapsed() >= timeout {
                return Ok(lock);
            }
            // Most locks are free in a moment.
            if !is_told && start.elapsed() >= Duration::from_secs(1).min(timeout / 2) {
                is_told = true;
                listener(&folder.file(hidden(name, LOCK)));
            }
            sleep(Duration::from_millis(20));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::names;
    use super::*;
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    use std::cell::RefCell;
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_lock_is_exclusive_until_it_ends() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("there");
        let lock = || folder.lock("a.png").expect("can be locked");
        let mine = lock().expect("free");
        assert!(lock().is_none());
        folder
            .write_atomic("a.png", b"theirs")
            .expect("needs no lock");
        let told = RefCell::new(Vec::new());
        let listener = |file: &Path| told.borrow_mut().push(file.to_owned());
        let waited = folder.lock_with_timeout("a.png", Duration::from_millis(200), &listener);
        assert!(waited.expect("can be locked").is_none());
        assert_eq!(told.take(), [root.path().join(".a.png.lock")]);
        drop(mine);
        assert!(
            folder
                .lock_with_timeout("a.png", Duration::ZERO, &listener)
                .expect("free")
                .is_some()
        );
        drop(lock().expect("free again"));
        assert!(told.take().is_empty());
        assert_eq!(names(root.path()), ["a.png"]);
    }

    /// Whatever is planted under a lock's name is left as it is, and stops nobody.
    #[test]
    fn planted_locks_are_neither_followed_nor_waited_for() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("there");
        fs::write(folder.file("precious"), "data").expect("written");
        symlink("precious", folder.file(".a.lock")).expect("linked");
        mknodat(CWD, folder.file(".b.lock"), FileType::Fifo, Mode::RUSR, 0).expect("made");
        fs::create_dir(folder.file(".c.lock")).expect("made");
        for name in ["a", "b", "c"] {
            drop(folder.lock(name).expect("no error").expect("granted"));
        }
        assert_eq!(fs::read(folder.file("precious")).expect("there"), b"data");
        assert_eq!(
            names(root.path()),
            [".a.lock", ".b.lock", ".c.lock", "precious"]
        );
    }
}
