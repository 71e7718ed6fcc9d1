//! The temporary files that this process has open, so that it leaves none when it ends at a signal.

use super::folder::Folder;
use std::ffi::{OsStr, OsString};
use std::io;
use std::mem;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::Duration;

/// Names in their folders.
static UNFINISHED: Mutex<Vec<(Folder, OsString)>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<(Folder, OsString)>> {
    // Each change of the list is a single step.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Opens a temporary file, and lists it if it is this process's by `is_own`.
pub(super) fn register<T>(
    folder: &Folder,
    name: &OsStr,
    open: impl FnOnce() -> io::Result<T>,
    is_own: impl FnOnce(&T) -> bool,
) -> io::Result<T> {
    let mut unfinished = unfinished();
    let opened = open()?;
    if is_own(&opened) {
        unfinished.push((folder.clone(), name.to_owned()));
    }
    Ok(opened)
}

/// Ends a temporary file, by a removal or under its final name, and lists it no longer.
pub(super) fn forget<T>(folder: &Folder, name: &OsStr, end: impl FnOnce() -> T) -> T {
    let mut unfinished = unfinished();
    let ended = end();
    let is_it = |(of, file): &(Folder, OsString)| file == name && of.is_same(folder);
    if let Some(at) = unfinished.iter().position(is_it) {
        unfinished.swap_remove(at);
    }
    ended
}

/// Removes all files that this process has not finished, and lets it begin and finish no others: for a process that is
/// about to end. Gives up where another thread waits for a disk.
pub fn remove_unfinished() {
    for _ in 0..20 {
        let Ok(unfinished) = UNFINISHED.try_lock() else {
            sleep(Duration::from_millis(10));
            continue;
        };
        for (folder, name) in unfinished.iter() {
            // What stays is removed by `remove_leftovers`.
            let _ = folder.remove(name);
        }
        mem::forget(unfinished);
        return;
    }
}
