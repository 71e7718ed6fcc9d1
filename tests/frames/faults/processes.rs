//! Processes that are killed, are asked to stop, or share a folder.

use super::batch::*;
use crate::support::*;
use flythrough::sampling::Random;
use rustix::process::Signal;
use std::fs;
use std::path::PathBuf;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Half of the kills are while it starts, half while it renders.
#[test]
fn killed_at_any_moment() {
    let kills = scaled(10, 16, 200);
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
