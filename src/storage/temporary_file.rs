//! Hidden files beside those that they are for: they are locked while a process needs them, and removed after.

use super::error::FileError;
use super::folder::Folder;
use super::input_file::regular;
use super::unfinished;
use rustix::fs::{OFlags, fstat};
use std::ffi::{OsStr, OsString};
use std::fs::{File, TryLockError};
use std::io;

/// A file `.NAME.SUFFIX`, removed when it is dropped, and when the process ends at a signal
/// ([`super::remove_unfinished`]).
///
/// The system releases its lock when the process ends, however it ends. So an unlocked one is a leftover of a process
/// that was killed. On a file system without locks, leftovers are not recognised.
#[derive(Debug)]
pub(super) struct TemporaryFile {
    pub(super) file: File,
    folder: Folder,
    /// Empty if it is no longer this process's to remove.
    name: OsString,
}

/// What came of opening one.
pub(super) enum Opened {
    Locked(TemporaryFile),
    /// The file system supports no locks.
    Lockless(TemporaryFile),
    /// Another process holds the lock.
    Busy,
    /// The file is no longer the one of this name: it was finished or removed before the lock was held.
    Gone,
}

/// The suffix of names of locks.
pub(super) const LOCK: &str = ".lock";

/// The suffix of names of unfinished files.
pub(super) const PART: &str = ".part";

/// The name of a temporary file for the file `name`.
pub(super) fn hidden(name: &OsStr, suffix: &str) -> OsString {
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(suffix);
    hidden
}

impl TemporaryFile {
    /// Opens or makes a temporary file, as `flags` say, and locks it. An error if it is not a regular file.
    pub(super) fn open(folder: &Folder, name: &OsStr, flags: OFlags) -> io::Result<Opened> {
        let temporary = |file| TemporaryFile {
            file,
            folder: folder.clone(),
            name: name.to_owned(),
        };
        let open = || {
            let file = regular(folder.open_at(name, flags | OFlags::CREATE)?)?;
            Ok(match file.try_lock() {
                Err(TryLockError::WouldBlock) => Opened::Busy,
                Ok(()) if !has_name(&file, folder, name) => Opened::Gone,
                Ok(()) => Opened::Locked(temporary(file)),
                Err(TryLockError::Error(_)) => Opened::Lockless(temporary(file)),
            })
        };
        let is_own = |opened: &Opened| matches!(opened, Opened::Locked(_) | Opened::Lockless(_));
        unfinished::register(folder, name, open, is_own)
    }

    /// Gives it its final name.
    pub(super) fn rename(mut self, target: &OsStr) -> io::Result<()> {
        let name = std::mem::take(&mut self.name);
        let renamed = unfinished::forget(&self.folder, &name, || self.folder.rename(&name, target));
        if renamed.is_err() {
            self.name = name;
        }
        renamed
    }
}

/// Whether an open file is still the one of a name.
fn has_name(file: &File, folder: &Folder, name: &OsStr) -> bool {
    let stat = fstat(file);
    let identity = folder.identity_of(name);
    stat.is_ok_and(|stat| identity.is_some_and(|of| (of.0, of.1) == (stat.st_dev, stat.st_ino)))
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        if !self.name.is_empty() {
            // If this fails, `remove_leftovers` removes it later.
            unfinished::forget(&self.folder, &self.name, || {
                drop(self.folder.remove(&self.name))
            });
        }
    }
}

impl Folder {
    /// Removes the unfinished files and the locks that killed processes left, of files whose names `is_own` tells. What
    /// cannot be removed stays.
    pub fn remove_leftovers(&self, is_own: impl Fn(&str) -> bool) -> Result<(), FileError> {
        for name in self.names()? {
            let hidden = name.to_string_lossy();
            let is_ours = target_of(&hidden).is_some_and(&is_own);
            // Nothing is written in a lock.
            let is_leftover = match self.size_of_regular(&name) {
                Some(size) => size == 0 || !hidden.ends_with(LOCK),
                None => false,
            };
            // Only the holder of the lock may remove the file.
            if is_ours
                && is_leftover
                && let Ok(Opened::Locked(leftover)) =
                    TemporaryFile::open(self, &name, OFlags::WRONLY)
            {
                drop(leftover);
            }
        }
        Ok(())
    }
}

/// The name of the file that a temporary file of this name is for.
fn target_of(hidden: &str) -> Option<&str> {
    let hidden = hidden.strip_prefix('.')?;
    if let Some(target) = hidden.strip_suffix(LOCK) {
        return Some(target);
    }
    let (target, number) = hidden.strip_suffix(PART)?.rsplit_once('.')?;
    let is_number = number.len() == 16 && number.bytes().all(|digit| digit.is_ascii_hexdigit());
    is_number.then_some(target)
}
