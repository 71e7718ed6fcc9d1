//! Open folders, whose files are accessed relative to them.

use super::error::FileError;
use super::input_file::{read_regular, regular};
use rustix::fs::{
    AtFlags, Dir, FileType, Mode, OFlags, fstat, open, openat, renameat, statat, unlinkat,
};
use rustix::io::Errno;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An open folder. Its files are accessed by their names in it, wherever the folder may be moved; links among them are
/// not followed.
#[derive(Clone, Debug)]
pub struct Folder {
    fd: Arc<OwnedFd>,
    path: PathBuf,
}

/// Tells a file from one that is put in its place: device, inode, and time of the last change in seconds and
/// nanoseconds.
pub(crate) type FileIdentity = (u64, u64, i64, i64);

impl Folder {
    /// Opens a folder that exists. The folder itself may be reached through links.
    pub fn open(path: &Path) -> Result<Folder, FileError> {
        let name = if path == Path::new("") {
            Path::new(".")
        } else {
            path
        };
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
        let fd =
            open(name, flags, Mode::empty()).map_err(|error| FileError::reading(path, error))?;
        Ok(Folder {
            fd: Arc::new(fd),
            path: path.to_owned(),
        })
    }

    /// Opens a folder, and makes it and those above it if they are not there.
    pub fn create(path: &Path) -> Result<Folder, FileError> {
        fs::create_dir_all(path).map_err(|error| FileError::writing(path, error))?;
        Folder::open(path)
    }

    /// The folder of a file, and the file's name in it.
    pub fn of_file(file: &Path) -> Result<(Folder, &OsStr), FileError> {
        let none = || FileError::writing(file, io::Error::other("it is no name of a file"));
        let name = file.file_name().ok_or_else(none)?;
        let parent = file.parent().unwrap_or(Path::new(""));
        let folder =
            Folder::open(parent).map_err(|error| FileError::writing(file, error.source))?;
        Ok((folder, name))
    }

    /// Its path, as it was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of one of its files.
    pub fn file(&self, name: impl AsRef<OsStr>) -> PathBuf {
        self.path.join(name.as_ref())
    }

    /// An error if its path leads to another folder by now, or to none.
    pub fn check_in_place(&self) -> Result<(), FileError> {
        let found = Folder::open(&self.path).and_then(|there| there.identity());
        let is_gone = match found {
            Err(error) if error.is_missing() => true,
            found => found? != self.identity()?,
        };
        match is_gone {
            true => {
                let gone = io::Error::other("the folder was moved or removed");
                Err(FileError::writing(&self.path, gone))
            }
            false => Ok(()),
        }
    }

    /// Device and inode.
    fn identity(&self) -> Result<(u64, u64), FileError> {
        let stat = fstat(&self.fd).map_err(|error| FileError::reading(&self.path, error))?;
        Ok((stat.st_dev, stat.st_ino))
    }

    /// Whether both are the same open folder.
    pub(super) fn is_same(&self, other: &Folder) -> bool {
        Arc::ptr_eq(&self.fd, &other.fd)
    }

    /// Opens a regular file for reading.
    pub(crate) fn open_file(&self, name: impl AsRef<OsStr>) -> Result<File, FileError> {
        let name = name.as_ref();
        let opened = self.open_at(name, OFlags::RDONLY).and_then(regular);
        opened.map_err(|source| FileError::reading(&self.file(name), source))
    }

    /// The bytes of a regular file of at most `most` bytes.
    pub fn read(&self, name: impl AsRef<OsStr>, most: u64) -> Result<Vec<u8>, FileError> {
        let name = name.as_ref();
        let bytes = self
            .open_at(name, OFlags::RDONLY)
            .and_then(|file| read_regular(file, most));
        bytes.map_err(|source| FileError::reading(&self.file(name), source))
    }

    /// As [`Folder::read`], as text.
    pub fn read_text(&self, name: impl AsRef<OsStr>, most: u64) -> Result<String, FileError> {
        let name = name.as_ref();
        String::from_utf8(self.read(name, most)?)
            .map_err(|error| FileError::reading(&self.file(name), io::Error::other(error)))
    }

    /// Opens whatever has that name, but follows no link and waits for no pipe.
    pub(super) fn open_at(&self, name: &OsStr, flags: OFlags) -> io::Result<File> {
        let flags = flags | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
        let mode = Mode::from_raw_mode(0o666);
        openat(&self.fd, name, flags, mode)
            .map(File::from)
            .map_err(|error| match error {
                Errno::LOOP => io::Error::other("it is a link"),
                // A folder, or a pipe that is opened for writing and that nobody reads.
                Errno::ISDIR | Errno::NXIO => io::Error::other("it is not a regular file"),
                error => error.into(),
            })
    }

    /// Tells the file of a name from one that is put in its place; none if there is none.
    pub(crate) fn identity_of(&self, name: impl AsRef<OsStr>) -> Option<FileIdentity> {
        let stat = statat(&self.fd, name.as_ref(), AtFlags::SYMLINK_NOFOLLOW).ok()?;
        Some((stat.st_dev, stat.st_ino, stat.st_mtime, stat.st_mtime_nsec))
    }

    /// Whether anything has that name.
    pub fn contains(&self, name: impl AsRef<OsStr>) -> bool {
        self.identity_of(name).is_some()
    }

    /// The bytes of a regular file; none if none has that name.
    pub(super) fn size_of_regular(&self, name: &OsStr) -> Option<u64> {
        let (kind, size) = self.kind_and_size(name)?;
        (kind == FileType::RegularFile).then_some(size)
    }

    /// Whether a folder has that name: no file can be written over it.
    pub(crate) fn is_folder(&self, name: &str) -> bool {
        let found = self.kind_and_size(name.as_ref());
        found.is_some_and(|(kind, _)| kind == FileType::Directory)
    }

    fn kind_and_size(&self, name: &OsStr) -> Option<(FileType, u64)> {
        let stat = statat(&self.fd, name, AtFlags::SYMLINK_NOFOLLOW).ok()?;
        Some((FileType::from_raw_mode(stat.st_mode), stat.st_size as u64))
    }

    /// The names in it, in no order.
    pub fn names(&self) -> Result<Vec<OsString>, FileError> {
        let read = || -> rustix::io::Result<Vec<OsString>> {
            let mut names = Vec::new();
            for entry in Dir::read_from(&self.fd)? {
                let name = OsString::from_vec(entry?.file_name().to_bytes().to_vec());
                if name != "." && name != ".." {
                    names.push(name);
                }
            }
            Ok(names)
        };
        read().map_err(|error| FileError::reading(&self.path, error))
    }

    /// Removes a file, if it is there.
    pub fn remove(&self, name: impl AsRef<OsStr>) -> Result<(), FileError> {
        let name = name.as_ref();
        match unlinkat(&self.fd, name, AtFlags::empty()) {
            Err(error) if error != Errno::NOENT => Err(FileError::writing(&self.file(name), error)),
            _ => Ok(()),
        }
    }

    /// Gives a file another name, in place of what has that name.
    pub(super) fn rename(&self, from: &OsStr, to: &OsStr) -> io::Result<()> {
        Ok(renameat(&self.fd, from, &self.fd, to)?)
    }

    /// Brings the names of all files to the disk, where the file system knows how.
    pub fn sync(&self) -> io::Result<()> {
        Ok(rustix::fs::fsync(&self.fd)?)
    }
}
