//! Disks that are full or read-only, and folders that vanish. Tests that mount a file system need root.

use super::batch::*;
use crate::support::*;
use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::Command;

/// A mounted file system in memory. Where the system forbids that there is none: the test is skipped with a message, or
/// fails in CI.
struct Disk {
    folder: tempfile::TempDir,
}

impl Disk {
    fn new(kilobytes: u32) -> Option<Disk> {
        let disk = Disk {
            folder: tempfile::tempdir().unwrap(),
        };
        let size = format!("size={kilobytes}k");
        if disk.mount(&["-t", "tmpfs", "-o", &size, "flythrough"]) {
            return Some(disk);
        }
        not_tested("this system does not let the test mount a tmpfs; run it as root");
        None
    }

    fn mount(&self, options: &[&str]) -> bool {
        let mut mount = Command::new("mount");
        mount.args(options).arg(self.folder.path());
        mount.status().is_ok_and(|status| status.success())
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount")
            .arg("-l")
            .arg(self.folder.path())
            .status();
    }
}

#[test]
fn a_full_disk_keeps_finished_frames_and_gets_the_rest_when_there_is_room() {
    let batch = Batch::new(30);
    let more = ["--size", "160x120"];
    let whole = batch.undisturbed(&more);
    let Some(disk) = Disk::new(400) else { return };
    let output = batch.render(&disk.out(), &more);
    let printed = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{printed}");
    assert!(
        printed.contains("frame 29 failed") && printed.contains("No space left on device"),
        "{printed}"
    );
    let there = frames(&disk.out()).len();
    assert!((3..30).contains(&there), "{there}");
    assert_eq!(faults(&disk.out()), [""; 0]);
    assert_eq!(partial_files(&disk.out()), [""; 0].map(PathBuf::from));
    assert!(disk.mount(&["-o", "remount,size=20m"]));
    assert_eq!(batch.render(&disk.out(), &more).status.code(), Some(0));
    assert!(frames(&disk.out()) == whole);
}

#[test]
fn a_disk_that_fills_up_within_a_file_keeps_none_of_it() {
    let Some(disk) = Disk::new(64) else { return };
    let file = disk.folder.path().join("a");
    flythrough::storage::write_atomic(&file, &[1; 20_000]).unwrap();
    let error = flythrough::storage::write_atomic(&file, &[2; 100_000]).unwrap_err();
    assert_eq!(error.kind(), std::io::ErrorKind::StorageFull);
    assert_eq!(fs::read(&file).unwrap(), [1; 20_000]);
    assert_eq!(fs::read_dir(disk.folder.path()).unwrap().count(), 1);
}

#[test]
fn a_read_only_folder_is_refused_unless_it_is_complete() {
    let batch = Batch::new(4);
    let more = ["--size", "16x12"];
    let Some(disk) = Disk::new(1000) else { return };
    assert_eq!(batch.render(&disk.out(), &more).status.code(), Some(0));
    assert!(disk.mount(&["-o", "remount,ro"]));
    let output = batch.render(&disk.out(), &more);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for more in [&["--size", "17x12"][..], &["--size", "16x12", "--force"]] {
        let output = batch.render(&disk.out(), more);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(
            stderr(&output).contains("Read-only file system"),
            "{}",
            stderr(&output)
        );
    }
    assert_eq!(faults(&disk.out()), [""; 0]);
}

#[test]
fn a_folder_that_vanishes_is_not_made_again_and_its_frames_are_named() {
    let batch = Batch::new(400);
    let more = ["--size", "160x120", "--samples", "16"];
    let mut child = batch.start(&batch.out(), &more);
    wait_for_file(&mut child, &batch.out().join("frame_00002.png"));
    let gone = batch.folder.path().join("gone");
    fs::rename(batch.out(), &gone).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    let printed = stderr(&output);
    assert!(
        printed.contains("frame 399 failed")
            && printed.contains("frame_00399.png: cannot be written"),
        "{printed}"
    );
    assert!(!printed.contains("use two folders"), "{printed}");
    assert!(!batch.out().exists());
    assert_eq!(faults(&gone), [""; 0]);
    assert!(frames(&gone).len() >= 2);
}

/// There may be room later: status 3. The cache is found not to fit before its light is gathered, and frames that do
/// fit use one that does not.
#[test]
fn commands_on_a_full_disk_say_that_trying_again_may_help() {
    let batch = Batch::new(4);
    let path = batch.folder.path().join("p.ron");
    let path = path.to_str().unwrap();
    let scene = "scenes/test3.ron";
    let small = ["--size", "64x48", "--mode", "montecarlo"];
    let rendered = batch.folder.path().join("rendered");
    assert_eq!(
        batch.render(&rendered, &["--size", "64x48"]).status.code(),
        Some(0)
    );
    let Some(disk) = Disk::new(160) else { return };
    let file = |name: &str| disk.folder.path().join(name).to_str().unwrap().to_owned();
    let output = flythrough(
        &[
            &["bake", scene, path, "-o", &file("light.cache")],
            &small[..],
        ]
        .concat(),
    );
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("light.cache: cannot be written: No space left"),
        "{}",
        stderr(&output)
    );
    let output = batch.render(&disk.out(), &small);
    let printed = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{printed}");
    assert!(printed.contains("used, but not kept"), "{printed}");
    assert_eq!(faults(&disk.out()), [""; 0]);
    // Nothing at all fits any more.
    let rest = fs::File::create(file("rest")).unwrap();
    while (&rest).write_all(&[1; 512]).is_ok() {}
    let out = disk.out();
    let rendered = rendered.to_str().unwrap();
    let commands: [&[&str]; 6] = [
        &[
            "quote",
            scene,
            path,
            "-o",
            out.to_str().unwrap(),
            "--size",
            "64x48",
        ],
        &["sheet", rendered, "-o", &file("sheet.png")],
        &["path", "plot", scene, path, "-o", &file("plot.svg")],
        &["path", "export", path, "-o", &file("path.json")],
        &[
            "report",
            scene,
            path,
            "-o",
            &file("report"),
            "--frames",
            "0",
            "--size",
            "16x12",
            "--seeds",
            "2",
        ],
        &[
            "render",
            scene,
            path,
            "-o",
            &file("out2"),
            "--size",
            "64x48",
        ],
    ];
    for command in commands {
        let output = flythrough(command);
        let printed = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{command:?}: {printed}");
        assert!(printed.contains("No space left on device"), "{printed}");
    }
    let left: Vec<_> = partial_files(disk.folder.path());
    assert_eq!(left, [""; 0].map(PathBuf::from));
}
