//! Links, pipes and devices that somebody plants in the folder of the frames.

use super::batch::*;
use crate::support::*;
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::symlink;

const SMALL: [&str; 4] = ["--size", "16x12", "--threads", "1"];

/// Under every name that can be guessed: of a frame, of what earlier versions wrote it to, of its lock.
#[test]
fn nothing_is_written_through_a_link() {
    let batch = Batch::new(6);
    let whole = batch.undisturbed(&SMALL);
    let out = batch.out();
    let precious = batch.folder.path().join("precious");
    fs::write(&precious, "data").unwrap();
    assert_eq!(
        batch
            .render(&out, &[&SMALL[..], &["--frames", "0"]].concat())
            .status
            .code(),
        Some(0)
    );
    let names = [
        "frame_00002.png",
        ".frame_00003.png.part",
        ".frame_00004.png.lock",
        "manifest.ron",
        ".manifest.ron.lock",
    ];
    for name in names {
        let _ = fs::remove_file(out.join(name));
        symlink(&precious, out.join(name)).unwrap();
    }
    let output = batch.render(&out, &SMALL);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read(&precious).unwrap(), b"data");
    assert!(frames(&out) == whole);
    for frame in 0..6 {
        let file = out.join(format!("frame_{frame:05}.png"));
        assert!(fs::symlink_metadata(file).unwrap().is_file());
    }
    assert_eq!(faults(&out), [""; 0]);
}

/// While the frames are rendered, too.
#[test]
fn a_link_that_is_planted_meanwhile_is_not_followed() {
    let batch = Batch::new(40);
    let more = ["--size", "80x60", "--threads", "1"];
    let out = batch.out();
    let precious = batch.folder.path().join("precious");
    fs::write(&precious, "data").unwrap();
    let mut child = batch.start(&out, &more);
    wait_for_file(&mut child, &out.join("frame_00000.png"));
    for frame in 20..40 {
        let names = [
            format!(".frame_{frame:05}.png.part"),
            format!(".frame_{frame:05}.png.lock"),
            format!("frame_{frame:05}.png"),
        ];
        for name in names {
            symlink(&precious, out.join(name)).unwrap();
        }
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read(&precious).unwrap(), b"data");
    assert_eq!(faults(&out), [""; 0]);
}

/// A pipe or a device under any name of the folder's own files neither stops a command nor fills the memory.
#[test]
fn pipes_and_devices_are_not_read() {
    let batch = Batch::new(4);
    let whole = batch.undisturbed(&SMALL);
    let montecarlo = [&SMALL[..], &["--mode", "montecarlo"]].concat();
    let names = [
        "sequence.ron",
        "manifest.ron",
        "cameras.jsonl",
        "estimate.ron",
        "irradiance.cache",
        "errors.csv",
        "sheet.png",
        ".frame_00001.png.lock",
        ".frame_00001.png.part",
        "frame_00001.png",
    ];
    for name in names {
        for is_pipe in [true, false] {
            let out = batch.folder.path().join(format!("{name}_{is_pipe}"));
            assert_eq!(
                batch
                    .render(&out, &[&SMALL[..], &["--frames", "0"]].concat())
                    .status
                    .code(),
                Some(0)
            );
            let file = out.join(name);
            let _ = fs::remove_file(&file);
            match is_pipe {
                true => mknodat(CWD, &file, FileType::Fifo, Mode::RWXU, 0).unwrap(),
                false => symlink("/dev/zero", &file).unwrap(),
            }
            let folder = out.to_str().unwrap();
            for command in ["verify", "status", "missing", "sheet"] {
                ends(start(&[command, folder]));
            }
            if name == "irradiance.cache" {
                assert_eq!(ends(batch.start(&out, &montecarlo)).status.code(), Some(0));
            }
            let output = ends(batch.start(&out, &SMALL));
            assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
            assert!(frames(&out) == whole, "{name}");
        }
    }
}

/// A process that hangs for as long as others wait does not keep a frame from being rendered, and a lock that is waited
/// for is named.
#[test]
fn locks_of_strangers_are_named() {
    let batch = Batch::new(3);
    let out = batch.out();
    fs::create_dir(&out).unwrap();
    let lock = |name: &str| {
        let file = fs::File::create(out.join(name)).unwrap();
        file.lock().unwrap();
        file
    };
    let of_frame = lock(".frame_00001.png.lock");
    let output = batch.render(&out, &SMALL);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    drop(of_frame);
    fs::remove_file(out.join("manifest.ron")).unwrap();
    let of_manifest = lock(".manifest.ron.lock");
    let mut child = batch.start(&out, &[&SMALL[..], &["--force"]].concat());
    // It goes on as soon as the lock is free, and would after a minute.
    let errors = BufReader::new(child.stderr.take().unwrap());
    let told = errors
        .lines()
        .map(|line| line.unwrap())
        .find(|line| line.contains("waits for"));
    assert!(told.unwrap().ends_with("out/.manifest.ron.lock"));
    drop(of_manifest);
    assert_eq!(ends(child).status.code(), Some(0));
    assert!(out.join("manifest.ron").is_file());
}
