//! The memory of the process: what it has, what it may have, and whether something still fits.
//!
//! Large parts work out what they need before they take it: a process that the system kills for its memory says
//! nothing, and leaves everything unfinished.

use std::fs;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Something that needs more memory than there is.
#[derive(Debug, Error)]
#[error(
    "{what}: needs {} of memory; {} are in use, and the limit is {} ({}): {advice}",
    in_bytes(*.need), in_bytes(.room.used), in_bytes(.room.limit), .room.source
)]
pub struct MemoryError {
    /// What needs it.
    pub what: String,
    /// Bytes.
    pub need: u64,
    /// What there is.
    pub room: MemoryRoom,
    /// What to do.
    pub advice: &'static str,
}

/// The memory of the process and its limit.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRoom {
    /// Bytes in use.
    pub used: u64,
    /// Bytes that it may use.
    pub limit: u64,
    /// Who sets the limit.
    pub source: &'static str,
}

impl MemoryRoom {
    /// Checks that `need` more bytes than are in use fit, for `what`.
    pub fn check(self, what: &str, need: u64, advice: &'static str) -> Result<(), MemoryError> {
        match need > self.left() {
            true => Err(MemoryError {
                what: what.to_owned(),
                need,
                room: self,
                advice,
            }),
            false => Ok(()),
        }
    }

    /// Bytes that are left.
    pub fn left(&self) -> u64 {
        self.limit.saturating_sub(self.used)
    }
}

/// Checks that `need` more bytes fit, for `what`.
pub fn check_room(what: &str, need: u64, advice: &'static str) -> Result<(), MemoryError> {
    room().map_or(Ok(()), |room| room.check(what, need, advice))
}

/// The limit that leaves the least room: of the control group, of the process (`ulimit -v`), or the machine's memory.
/// None where the system does not say.
pub fn room() -> Option<MemoryRoom> {
    let status = Status::read()?;
    let resident = |(limit, source)| MemoryRoom {
        used: status.resident,
        limit,
        source,
    };
    let control_group =
        control_group_limit().map(|limit| resident((limit, "of the control group")));
    let machine = machine_memory().map(|limit| resident((limit, "the machine's memory")));
    let process = address_space_limit().map(|limit| MemoryRoom {
        used: status.virtual_size,
        limit,
        source: "ulimit -v",
    });
    let all = [control_group, process, machine].into_iter().flatten();
    all.min_by_key(MemoryRoom::left)
}

/// Bytes of memory that the process has now, and the most that it had; none where the system does not say.
pub fn resident() -> Option<[u64; 2]> {
    let status = Status::read()?;
    Some([status.resident, status.most_resident])
}

/// What Linux says of the process, in bytes.
struct Status {
    resident: u64,
    most_resident: u64,
    virtual_size: u64,
}

impl Status {
    fn read() -> Option<Status> {
        let text = fs::read_to_string("/proc/self/status").ok()?;
        Some(Status {
            resident: kibibytes(&text, "VmRSS:")?,
            most_resident: kibibytes(&text, "VmHWM:")?,
            virtual_size: kibibytes(&text, "VmSize:")?,
        })
    }
}

/// The number of a line `NAME: 123 kB`, in bytes.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let number: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024 * number)
}

fn machine_memory() -> Option<u64> {
    kibibytes(&fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")
}

fn address_space_limit() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/limits").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The least limit of the control groups of the process, from its own up to the root; of version 2 or 1.
fn control_group_limit() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let limits = groups.lines().filter_map(|line| {
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, group) = (fields.next()?, fields.next()?);
        match controllers {
            "" => least(Path::new("/sys/fs/cgroup"), group, "memory.max"),
            "memory" => least(
                Path::new("/sys/fs/cgroup/memory"),
                group,
                "memory.limit_in_bytes",
            ),
            _ => None,
        }
    });
    limits.min()
}

fn least(root: &Path, group: &str, file: &str) -> Option<u64> {
    let group: PathBuf = root.join(group.trim_start_matches('/'));
    let levels = group
        .ancestors()
        .take_while(|level| level.starts_with(root));
    // No number is no limit.
    let limits = levels.filter_map(|level| {
        fs::read_to_string(level.join(file))
            .ok()?
            .trim()
            .parse()
            .ok()
    });
    limits.min()
}

fn in_bytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_the_numbers() {
        let room = room().expect("Linux says");
        assert!(room.used > 0 && room.left() > 0);
        check_room("little", 1, "").expect("there is room");
        let need = room.limit;
        let refused = check_room("a frame", need, "choose a smaller --size")
            .expect_err("too much")
            .to_string();
        let start = format!("a frame: needs {} of memory; ", in_bytes(need));
        assert!(
            refused.starts_with(&start) && refused.ends_with(": choose a smaller --size"),
            "{refused}"
        );
    }

    #[test]
    fn the_least_limit_of_the_groups_counts() {
        let root = tempfile::tempdir().expect("a folder");
        let deep = root.path().join("a/b");
        fs::create_dir_all(&deep).expect("made");
        let limit = |folder: &Path, text: &str| {
            fs::write(folder.join("memory.max"), text).expect("written")
        };
        assert_eq!(least(root.path(), "/a/b", "memory.max"), None);
        limit(&deep, "max\n");
        limit(&root.path().join("a"), "1000\n");
        limit(root.path(), "2000\n");
        assert_eq!(least(root.path(), "/a/b", "memory.max"), Some(1000));
        // A group that is not seen from inside a container.
        assert_eq!(least(root.path(), "/c/d", "memory.max"), Some(2000));
    }
}
