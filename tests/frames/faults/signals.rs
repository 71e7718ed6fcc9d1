//! Signals that ask for an end, in every command that takes long.

use super::batch::*;
use crate::support::*;
use rustix::process::Signal;
use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

const SIGNALS: [Signal; 4] = [Signal::TERM, Signal::INT, Signal::HUP, Signal::USR1];

/// All files below a folder.
fn files(folder: &Path) -> Vec<String> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => all.extend(files(&path)),
            false => all.push(path.to_str().unwrap().to_owned()),
        }
    }
    all
}

/// Whether a process catches a signal, as Linux says.
fn catches(process: u32, signal: Signal) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal.as_raw() - 1) & 1 == 1)
}

/// A tile of such a frame takes minutes: no process waits for it.
#[test]
fn every_signal_ends_a_frame_of_many_paths() {
    let batch = Batch::new(2);
    let more = [
        "--mode",
        "montecarlo",
        "--splits",
        "32,32,32,32",
        "--size",
        "64x48",
    ];
    for sent in SIGNALS {
        let out = batch.folder.path().join(format!("{sent:?}"));
        let mut child = batch.start(&out, &more);
        wait_until(&mut child, "a part file", || {
            out.join("sequence.ron").is_file() && !partial_files(&out).is_empty()
        });
        signal(&child, sent);
        let output = ends(child);
        assert_eq!(
            output.status.code(),
            INTERRUPTED,
            "{sent:?}: {}",
            stderr(&output)
        );
        assert_eq!(names_of_files(&out), ["sequence.ron"]);
    }
}

fn names_of_files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = files(folder)
        .iter()
        .map(|file| file[folder.to_str().unwrap().len() + 1..].to_owned())
        .collect();
    names.retain(|name| name != "manifest.ron" && name != "cameras.jsonl");
    names
}

/// Each command is interrupted at several moments; none leaves a temporary file.
#[test]
fn every_command_ends_at_a_signal() {
    let batch = Batch::new(60);
    let path = batch.folder.path().join("p.ron");
    let path = path.to_str().unwrap();
    let scene = "scenes/test3.ron";
    let montecarlo = [
        "--mode",
        "montecarlo",
        "--size",
        "640x480",
        "--threads",
        "1",
    ];
    let commands: [(&str, &[&str]); 4] = [
        ("bake", &montecarlo),
        ("quote", &montecarlo),
        ("render", &montecarlo),
        ("report", &["--threads", "1"]),
    ];
    for (number, (command, more)) in commands.into_iter().enumerate() {
        for (moment, sent) in SIGNALS.into_iter().enumerate() {
            let folder = batch.folder.path().join(format!("{number}_{moment}"));
            fs::create_dir(&folder).unwrap();
            let out = folder.join("out");
            let arguments = [&[command, scene, path, "-o", out.to_str().unwrap()], more].concat();
            let mut child = start(&arguments);
            // From the first moment at which it catches signals.
            let process = child.id();
            wait_until(&mut child, "catching signals", || catches(process, sent));
            sleep(Duration::from_millis([0, 20, 100, 400][moment]));
            signal(&child, sent);
            let output = ends(child);
            let printed = stderr(&output);
            assert_eq!(output.status.code(), INTERRUPTED, "{command}: {printed}");
            let left: Vec<String> = files(&folder)
                .into_iter()
                .filter(|file| file.ends_with(".part") || file.ends_with(".lock"))
                .collect();
            assert_eq!(left, [""; 0], "{command}");
        }
    }
}
