//! File systems that fail, lie and flip bits: a library that is loaded before the system's makes its calls do so.

use super::batch::*;
use crate::support::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The library, built by the C compiler that Rust links with.
fn shim(folder: &Path) -> PathBuf {
    let library = folder.join("shim.so");
    let source = root().join("tests/frames/faults/shim.c");
    let mut compiler = Command::new("cc");
    compiler
        .args(["-O1", "-Wall", "-Werror", "-shared", "-fPIC", "-o"])
        .arg(&library)
        .arg(source)
        .arg("-ldl");
    assert!(compiler.status().unwrap().success());
    library
}

/// What goes wrong, and the variables that make it so.
const FAULTS: [(&str, &[(&str, &str)]); 6] = [
    ("calls fail", &[("SHIM_FAIL", "0.03")]),
    (
        "calls are interrupted or do a part",
        &[("SHIM_EINTR", "0.2"), ("SHIM_SHORT", "0.4")],
    ),
    (
        "what was written or renamed is not there",
        &[("SHIM_LIE", "0.02")],
    ),
    ("bits flip when they are read", &[("SHIM_FLIP", "0.02")]),
    ("renames are done and fail", &[("SHIM_RETRY", "0.1")]),
    (
        "there are no locks, and calls fail",
        &[("SHIM_NO_LOCKS", "1"), ("SHIM_FAIL", "0.02")],
    ),
];

/// After each run status 0 means that all frames are there, and no frame is there that is not whole, unless the file
/// system has lied of it. In the end there are the frames of a run without faults.
#[test]
fn no_fault_of_the_disk_is_taken_for_a_frame() {
    let batch = Batch::new(12);
    let more = ["--size", "24x16", "--threads", "2"];
    let whole = batch.undisturbed(&more);
    let library = shim(batch.folder.path());
    let mut finished = 0;
    for seed in 0..scaled(2, 3, 40) {
        for (number, (what, variables)) in FAULTS.into_iter().enumerate() {
            let out = batch.folder.path().join(format!("frames_{number}"));
            let mut command = batch.command(&out, &more);
            command
                .env("LD_PRELOAD", &library)
                .env("SHIM_FOLDER", &out)
                .env("SHIM_SEED", (100 * seed + number).to_string());
            command.envs(variables.iter().copied());
            let output = ends(command.spawn().unwrap());
            let printed = stderr(&output);
            let status = output.status.code();
            assert!(
                matches!(status, Some(0 | 3)),
                "{what}: {status:?}: {printed}"
            );
            if !out.join("sequence.ron").is_file() {
                continue;
            }
            let bad = if variables[0].0 == "SHIM_LIE" && status == Some(3) {
                Vec::new()
            } else {
                faults(&out)
            };
            assert_eq!(bad, [""; 0], "{what}: {printed}");
            if status == Some(0) {
                finished += 1;
                assert!(frames(&out) == whole, "{what}");
                for (name, _) in &whole[..6] {
                    fs::remove_file(out.join(name)).unwrap();
                }
            }
        }
    }
    assert!(finished > 0);
    for number in 0..FAULTS.len() {
        let out = batch.folder.path().join(format!("frames_{number}"));
        let output = batch.render(&out, &more);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(frames(&out) == whole);
        assert_eq!(partial_files(&out), [""; 0].map(PathBuf::from));
    }
}
