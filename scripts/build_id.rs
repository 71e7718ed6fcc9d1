//! Build script: the identity of the build, a hash of what decides pixels, for `FLYTHROUGH_BUILD`.
//!
//! It is taken from sources, so it is the same for debug and release, on whatever machine they are compiled: the code
//! of all modules but those that only request or show frames, and the versions of the libraries that read inputs,
//! compute or encode. Comments, blank lines, indentation and tests do not count.
#![expect(
    clippy::print_stdout,
    reason = "cargo reads what a build script prints"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Rooms that decide no pixel.
const OTHER_ROOMS: [&str; 8] = [
    "cli",
    "drawing",
    "forecast",
    "job",
    "preflight",
    "report",
    "selftest",
    "storage",
];

/// Libraries that decide pixels or the bytes of frames; what they use counts with them.
const LIBRARIES: [&str; 7] = ["exr", "glam", "image", "libm", "png", "ron", "tobj"];

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut hash = Fnv::default();
    for file in sources(&root.join("src"))? {
        hash.write(
            file.strip_prefix(&root)
                .unwrap_or(&file)
                .to_string_lossy()
                .as_bytes(),
        );
        hash.write(code(&fs::read_to_string(&file)?).as_bytes());
    }
    // Not there where another program builds this one as a library: it has its own.
    if let Ok(lock) = fs::read_to_string(root.join("Cargo.lock")) {
        for library in libraries(&lock) {
            hash.write(library.as_bytes());
        }
    }
    println!("cargo::rustc-env=FLYTHROUGH_BUILD={:016x}", hash.finish());
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=Cargo.lock");
    println!("cargo::rerun-if-changed=scripts/build_id.rs");
    Ok(())
}

/// The files of the rooms that decide pixels, in order.
fn sources(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if path.is_dir() && name != "tests" && !OTHER_ROOMS.contains(&&*name) {
            files.extend(sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs")
            && !["lib", "main", "tests"].contains(&&*name)
        {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// A source file without comments, blank lines, indentation and its tests, which end it.
fn code(text: &str) -> String {
    let text = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or(text);
    let lines = text.lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Names and versions in Cargo.lock of the libraries that decide pixels and of all that they use, in order.
fn libraries(lock: &str) -> BTreeSet<String> {
    let value = |line: &str, key: &str| {
        let value = line
            .strip_prefix(key)?
            .strip_prefix(" = \"")?
            .strip_suffix('"')?;
        Some(value.to_owned())
    };
    // By name: versions, and the names of what they use.
    let mut packages: BTreeMap<String, (BTreeSet<String>, BTreeSet<String>)> = BTreeMap::new();
    for package in lock.split("[[package]]").skip(1) {
        let Some(name) = package.lines().find_map(|line| value(line, "name")) else {
            continue;
        };
        let (versions, uses) = packages.entry(name).or_default();
        versions.extend(package.lines().find_map(|line| value(line, "version")));
        let used = package.lines().filter_map(|line| line.strip_prefix(" \""));
        uses.extend(used.filter_map(|line| Some(line.split(['"', ' ']).next()?.to_owned())));
    }
    let mut found = BTreeSet::new();
    let mut queue: Vec<&str> = LIBRARIES.to_vec();
    let mut seen = BTreeSet::new();
    while let Some(name) = queue.pop() {
        if let (true, Some((versions, uses))) = (seen.insert(name), packages.get(name)) {
            found.extend(versions.iter().map(|version| format!("{name} {version}\n")));
            queue.extend(uses.iter().map(String::as_str));
        }
    }
    found
}

/// FNV-1a, 64 bits: the standard library's own hash may differ from one release of Rust to the next.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
