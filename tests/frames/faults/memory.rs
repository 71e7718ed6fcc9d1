//! Memory and open files of long sequences.

use super::batch::*;
use crate::support::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Child;
use std::thread::sleep;
use std::time::Duration;

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
