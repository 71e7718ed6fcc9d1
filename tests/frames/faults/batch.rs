//! A batch of frames that processes render, and what they leave in its folder.

use crate::support::*;
use rustix::process::{Pid, Signal, kill_process};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// The exit status of an interrupted run. The same command resumes it.
pub(super) const INTERRUPTED: Option<i32> = Some(75);

/// A folder with a path through `test3`, for the folders of its frames.
pub(super) struct Batch {
    pub(super) folder: tempfile::TempDir,
}

impl Batch {
    pub(super) fn new(frames: u32) -> Batch {
        let folder = tempfile::tempdir().unwrap();
        let last = frames - 1;
        let path = format!(
            "CameraPath(fps: 1, interpolation: linear, keyframes: [
                (time: 0, position: (0, 0, 3), look_at: (0, 0, 0), fov: 45),
                (time: {last}, position: (0.3, 0.2, 2.5), look_at: (0, 0, 0), fov: 45),
            ])"
        );
        fs::write(folder.path().join("p.ron"), path).unwrap();
        Batch { folder }
    }

    pub(super) fn command(&self, out: &Path, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flythrough"));
        command
            .current_dir(root())
            .args(["render", "scenes/test3.ron"])
            .args([&self.folder.path().join("p.ron"), Path::new("-o"), out])
            .args(more)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    pub(super) fn start(&self, out: &Path, more: &[&str]) -> Child {
        self.command(out, more).spawn().unwrap()
    }

    pub(super) fn render(&self, out: &Path, more: &[&str]) -> Output {
        self.command(out, more).output().unwrap()
    }

    /// The frames of a run without faults.
    pub(super) fn undisturbed(&self, more: &[&str]) -> Vec<(PathBuf, Vec<u8>)> {
        let out = self.folder.path().join("undisturbed");
        assert_eq!(self.render(&out, more).status.code(), Some(0));
        frames(&out)
    }

    pub(super) fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }
}

/// The lines of `verify` about frames that are neither verified nor missing.
pub(super) fn faults(out: &Path) -> Vec<String> {
    let output = flythrough(&["verify", "--quiet", out.to_str().unwrap()]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let lines = printed.lines().filter(|line| !line.ends_with(": missing"));
    lines.map(str::to_owned).collect()
}

/// The partial files of a folder.
pub(super) fn partial_files(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out).unwrap().map(|e| e.unwrap().path());
    entries
        .filter(|file| file.extension().is_some_and(|e| e == "part"))
        .collect()
}

/// Waits until `is_so`, while a process runs.
pub(super) fn wait_until(child: &mut Child, what: &str, is_so: impl Fn() -> bool) {
    while !is_so() {
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended without {what}"
        );
        sleep(Duration::from_millis(1));
    }
}

/// Waits for a file of a running process.
pub(super) fn wait_for_file(child: &mut Child, file: &Path) {
    wait_until(child, &file.display().to_string(), || file.is_file());
}

/// Starts the program with these arguments.
pub(super) fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flythrough"));
    command.current_dir(root()).args(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// What a process printed that has to end by itself: one that still runs after a minute hangs.
pub(super) fn ends(mut child: Child) -> Output {
    for _ in 0..6000 {
        if child.try_wait().unwrap().is_some() {
            return child.wait_with_output().unwrap();
        }
        sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    panic!("it hangs");
}

pub(super) fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}
