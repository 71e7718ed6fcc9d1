//! Faults during a batch: processes that are killed, full disks, folders that vanish. No finished frame is lost, no
//! partial file has a frame's name, and the exit status says whether to try again. Tests that mount a file system need
//! root.

use crate::support::*;
use flythrough::sampling::Random;
use rustix::process::{Pid, Signal, kill_process};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The exit status of an interrupted run. The same command resumes it.
const INTERRUPTED: Option<i32> = Some(75);

/// A folder with a path through `test3`, for the folders of its frames.
struct Batch {
    folder: tempfile::TempDir,
}

impl Batch {
    fn new(frames: u32) -> Batch {
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

    fn command(&self, out: &Path, more: &[&str]) -> Command {
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

    fn start(&self, out: &Path, more: &[&str]) -> Child {
        self.command(out, more).spawn().unwrap()
    }

    fn render(&self, out: &Path, more: &[&str]) -> Output {
        self.command(out, more).output().unwrap()
    }

    /// The frames of a run without faults.
    fn undisturbed(&self, more: &[&str]) -> Vec<(PathBuf, Vec<u8>)> {
        let out = self.folder.path().join("undisturbed");
        assert_eq!(self.render(&out, more).status.code(), Some(0));
        frames(&out)
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }
}

/// The lines of `verify` about frames that are neither verified nor missing.
fn faults(out: &Path) -> Vec<String> {
    let output = flythrough(&["verify", "--quiet", out.to_str().unwrap()]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let lines = printed.lines().filter(|line| !line.ends_with(": missing"));
    lines.map(str::to_owned).collect()
}

/// The partial files of a folder.
fn partial_files(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out).unwrap().map(|e| e.unwrap().path());
    entries
        .filter(|file| file.extension().is_some_and(|e| e == "part"))
        .collect()
}

/// Waits until `is_so`, while a process runs.
fn wait_until(child: &mut Child, what: &str, is_so: impl Fn() -> bool) {
    while !is_so() {
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended without {what}"
        );
        sleep(Duration::from_millis(1));
    }
}

/// Waits for a file of a running process.
fn wait_for_file(child: &mut Child, file: &Path) {
    wait_until(child, &file.display().to_string(), || file.is_file());
}

fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

/// Half of the kills are while it starts, half while it renders.
#[test]
fn killed_at_any_moment() {
    let kills = scaled(10, 40, 200);
    let batch = Batch::new(400);
    let more = [
        "--size",
        "80x60",
        "--mode",
        "supersampling",
        "--threads",
        "1",
    ];
    let whole = batch.undisturbed(&more);
    let out = batch.out();
    // As long as it takes to start and to render one frame.
    let start = Instant::now();
    batch.render(
        &batch.folder.path().join("one"),
        &[&more[..], &["--frames", "0"]].concat(),
    );
    let longest = start.elapsed().as_millis() as usize;
    let mut random = Random::new(1);
    let (mut rendered, mut with_partial_files) = (0, 0);
    for kill in 0..kills {
        let count = || fs::read_dir(&out).map_or(0, |_| frames(&out).len());
        let before = count();
        let mut child = batch.start(&out, &more);
        if kill % 2 == 0 {
            sleep(Duration::from_millis(random.below(longest) as u64));
        } else {
            wait_until(&mut child, "a frame", || count() > before);
            sleep(Duration::from_micros(random.below(20_000) as u64));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        if !out.join("sequence.ron").is_file() {
            continue;
        }
        assert_eq!(faults(&out), [""; 0]);
        let there = frames(&out);
        rendered += there.len() - before;
        with_partial_files += usize::from(!partial_files(&out).is_empty());
        if there.len() > 350 {
            for (name, _) in there.iter().filter(|_| random.below(2) == 0) {
                fs::remove_file(out.join(name)).unwrap();
            }
        }
    }
    assert!(
        rendered >= kills / 2 && with_partial_files >= kills / 4,
        "{rendered} frames rendered, {with_partial_files} kills within a frame's file"
    );
    let output = batch.render(&out, &more);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(frames(&out) == whole);
    assert_eq!(partial_files(&out), [""; 0].map(PathBuf::from));
    let verified = flythrough(&["verify", out.to_str().unwrap()]);
    assert_eq!(verified.status.code(), Some(0));
}

#[test]
fn a_signal_gives_up_the_frames_in_flight_and_no_others() {
    let batch = Batch::new(40);
    let more = ["--size", "160x120", "--samples", "24"];
    let whole = batch.undisturbed(&more);
    for sent in [Signal::TERM, Signal::INT] {
        let out = batch.folder.path().join(format!("{sent:?}"));
        let mut child = batch.start(&out, &more);
        wait_for_file(&mut child, &out.join("frame_00001.png"));
        signal(&child, sent);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), INTERRUPTED, "{}", stderr(&output));
        let printed = String::from_utf8(output.stdout).unwrap();
        assert!(printed.contains("interrupted"), "{printed}");
        assert_eq!(faults(&out), [""; 0]);
        assert_eq!(partial_files(&out), [""; 0].map(PathBuf::from));
        let there = frames(&out);
        assert!(there.len() < 40);
        let manifest = fs::read_to_string(out.join("manifest.ron")).unwrap();
        assert_eq!(manifest.matches("Frame(").count(), there.len());
        assert_eq!(batch.render(&out, &more).status.code(), Some(0));
        assert!(frames(&out) == whole);
    }
}

/// While the irradiance cache is baked.
#[test]
fn a_signal_before_the_first_frame() {
    let batch = Batch::new(40);
    let more = [
        "--size",
        "1280x960",
        "--mode",
        "montecarlo",
        "--target-error",
        "0.000001",
    ];
    let mut child = batch.start(&batch.out(), &more);
    wait_for_file(&mut child, &batch.out().join("sequence.ron"));
    sleep(Duration::from_millis(20));
    signal(&child, Signal::TERM);
    assert_eq!(child.wait_with_output().unwrap().status.code(), INTERRUPTED);
    assert!(frames(&batch.out()).is_empty());
}

#[test]
fn several_processes_share_the_frames_of_one_folder() {
    let batch = Batch::new(150);
    let more = ["--size", "80x60", "--samples", "16", "--threads", "1"];
    let whole = batch.undisturbed(&more);
    for processes in [2, 4] {
        let out = batch.folder.path().join(processes.to_string());
        let children: Vec<Child> = (0..processes).map(|_| batch.start(&out, &more)).collect();
        let mut rendered = 0;
        for child in children {
            let output = child.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            let printed = String::from_utf8(output.stdout).unwrap();
            let count: u32 = printed.split(' ').next().unwrap().parse().unwrap();
            rendered += count;
        }
        assert!(frames(&out) == whole);
        // The last two frames of each process may be rendered by any other, too.
        let most = 150 + 2 * processes * processes;
        assert!((150..most).contains(&rendered), "{rendered}");
        let manifest = fs::read_to_string(out.join("manifest.ron")).unwrap();
        assert_eq!(manifest.matches("Frame(").count(), 150);
        assert_eq!(partial_files(&out), [""; 0].map(PathBuf::from));
    }
}

/// Each process renders every frame.
#[test]
fn two_runs_with_force_write_the_same_frames() {
    let batch = Batch::new(60);
    let more = ["--size", "80x60", "--threads", "1"];
    let whole = batch.undisturbed(&more);
    let force = [&more[..], &["--force"]].concat();
    let children = [(); 2].map(|()| batch.start(&batch.out(), &force));
    for child in children {
        assert_eq!(child.wait_with_output().unwrap().status.code(), Some(0));
    }
    assert!(frames(&batch.out()) == whole);
}

/// One folder cannot hold two sequences: the run whose sequence is replaced fails.
#[test]
fn another_sequence_in_the_same_folder_is_noticed() {
    let batch = Batch::new(200);
    let more = ["--size", "80x60", "--samples", "16", "--threads", "1"];
    let mut first = batch.start(&batch.out(), &more);
    wait_for_file(&mut first, &batch.out().join("frame_00003.png"));
    let other = [&more[..], &["--seed", "5"]].concat();
    let second = batch.start(&batch.out(), &other);
    let outputs = [first, second].map(|child| child.wait_with_output().unwrap());
    assert_eq!(outputs[0].status.code(), Some(3));
    let printed = stderr(&outputs[0]);
    assert!(
        printed.contains("frame 199 failed") && printed.contains("use two folders"),
        "{printed}"
    );
    assert_eq!(outputs[1].status.code(), Some(0));
    assert_eq!(batch.render(&batch.out(), &other).status.code(), Some(0));
    let verified = flythrough(&["verify", batch.out().to_str().unwrap()]);
    assert_eq!(verified.status.code(), Some(0));
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
        assert!(
            std::env::var_os("CI").is_none(),
            "CI must be able to mount a tmpfs"
        );
        // Not `eprintln!`, which test runners capture.
        let _ = writeln!(
            std::io::stderr(),
            "NOT TESTED: this system does not let the test mount a tmpfs; run it as root"
        );
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

/// Memory and open files while a process renders up to 10,000 frames: neither grows after a fifth of them.
#[test]
fn memory_does_not_grow_after_a_fifth_of_the_frames() {
    let count = scaled(500, 2000, 10_000);
    let batch = Batch::new(count);
    let mut child = batch.start(&batch.out(), &["--size", "8x6", "--threads", "2"]);
    let status = |child: &Child| -> Option<(u64, u64)> {
        let process = PathBuf::from(format!("/proc/{}", child.id()));
        let files = fs::read_dir(process.join("fd")).ok()?.count() as u64;
        let status = fs::read_to_string(process.join("status")).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmRSS"))?;
        let kilobytes = line.split_whitespace().nth(1)?.parse().ok()?;
        Some((kilobytes, files))
    };
    // The most of each in every fifth of the sequence.
    let mut fifths: BTreeMap<usize, (u64, u64)> = BTreeMap::new();
    let is_there = |frame: usize| batch.out().join(format!("frame_{frame:05}.png")).is_file();
    let mut fifth = 0;
    while child.try_wait().unwrap().is_none() {
        while fifth < 4 && is_there(count as usize / 5 * (fifth + 1)) {
            fifth += 1;
        }
        if let Some((kilobytes, files)) = status(&child) {
            let most = fifths.entry(fifth).or_default();
            *most = (most.0.max(kilobytes), most.1.max(files));
        }
        sleep(Duration::from_millis(2));
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(frames(&batch.out()).len(), count as usize);
    let most = |fifth: usize| fifths.get(&fifth).copied().unwrap_or_default();
    let (first, last) = (most(0), most(3));
    assert!(0 < first.0 && last.0 <= first.0 + 2000, "{fifths:?}");
    assert!(last.1 < 40, "{fifths:?}");
}
