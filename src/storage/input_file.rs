//! Files that the user names: links are followed, as anywhere, but only regular files are read, and none beyond a size.

use super::error::FileError;
use rustix::fs::{Mode, OFlags, open};
use rustix::io::Errno;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The bytes of a file that the user named, of at most `most` bytes. An error if it is not a regular file: a device may
/// have no end, and a pipe no writer.
pub fn read_input(file: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    // A pipe without a writer would block.
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    let opened = open(file, flags, Mode::empty()).map_err(|error| match error {
        // A device that is not there.
        Errno::NXIO => io::Error::other("it is not a regular file"),
        error => error.into(),
    });
    let bytes = opened.and_then(|opened| read_regular(opened.into(), most));
    bytes.map_err(|source| FileError::reading(file, source))
}

/// The bytes of an open regular file, of at most `most` bytes.
pub(super) fn read_regular(file: File, most: u64) -> io::Result<Vec<u8>> {
    let file = regular(file)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    if length <= most {
        bytes.try_reserve_exact(length as usize)?;
        // It may grow meanwhile.
        file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    }
    match length.max(bytes.len() as u64) {
        length if length > most => Err(io::Error::other(format!(
            "its {length} bytes are more than the {most} that it may have"
        ))),
        _ => Ok(bytes),
    }
}

/// The file, if it is a regular one.
pub(super) fn regular(file: File) -> io::Result<File> {
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(io::Error::other("it is not a regular file")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, mknodat};
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn only_regular_files_of_bounded_size_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name);
        fs::write(file("whole"), "12345").expect("written");
        symlink("whole", file("link")).expect("linked");
        for name in ["whole", "link"] {
            assert_eq!(read_input(&file(name), 5).expect("read"), b"12345");
            let long = read_input(&file(name), 4)
                .expect_err("too long")
                .to_string();
            assert!(
                long.ends_with("its 5 bytes are more than the 4 that it may have"),
                "{long}"
            );
        }
        mknodat(CWD, file("pipe"), FileType::Fifo, Mode::RUSR, 0).expect("made");
        for odd in [file("pipe"), folder.path().to_owned(), "/dev/zero".into()] {
            let refused = read_input(&odd, 1 << 20).expect_err("odd").to_string();
            assert!(
                refused.ends_with("cannot be read: it is not a regular file"),
                "{refused}"
            );
        }
        assert!(read_input(&file("none"), 1).expect_err("none").is_missing());
    }
}
