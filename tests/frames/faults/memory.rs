//! Memory and open files of long sequences.

use super::batch::*;
use crate::support::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command};
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

/// Runs the program with so many kilobytes of address space.
fn limited(kilobytes: u32, arguments: &[&str]) -> (Option<i32>, String) {
    let mut shell = Command::new("sh");
    shell.args([
        "-c",
        &format!("ulimit -v {kilobytes}; exec \"$@\""),
        "sh",
        env!("CARGO_BIN_EXE_flythrough"),
    ]);
    let output = shell.args(arguments).current_dir(root()).output().unwrap();
    (output.status.code(), stderr(&output))
}

/// What does not fit is refused with the numbers and what to do, before it is taken.
#[test]
fn what_does_not_fit_into_memory_is_refused() {
    let batch = Batch::new(2);
    let path = batch.folder.path().join("p.ron");
    let (path, out) = (path.to_str().unwrap(), batch.out());
    let out = out.to_str().unwrap();
    let render = |scene: &str, more: &[&str]| {
        let arguments = [&["render", scene, path, "-o", out, "--threads", "1"], more].concat();
        limited(600_000, &arguments)
    };
    let refused = |(status, printed): (Option<i32>, String), what: &str, advice: &str| {
        assert_eq!(status, Some(2), "{printed}");
        assert!(
            printed.contains(what) && printed.contains(advice),
            "{printed}"
        );
        assert!(printed.contains("ulimit -v"), "{printed}");
        assert!(!batch.out().exists() || frames(&batch.out()).is_empty());
    };
    refused(
        render("scenes/test3.ron", &["--size", "8000x8000"]),
        "frames of 8000x8000",
        "--size",
    );
    let file = |name: &str| batch.folder.path().join(name);
    let row = |y: u32| -> String { (0..300).map(|x| format!("v {x} {y} 0\n")).collect() };
    let face = |at: u32| format!("f {} {} {}\n", at + 1, at + 2, at + 301);
    let model: String = (0..300).map(row).chain((0..300 * 299).map(face)).collect();
    fs::write(file("m.obj"), model).unwrap();
    let copies: String = (0..40)
        .map(|x| format!("model(file: \"m.obj\", translation: ({x}, 0, 0)), "))
        .collect();
    let scene = file("copies.ron");
    fs::write(
        &scene,
        format!("Scene(ambient: (1, 1, 1), objects: [{copies}])"),
    )
    .unwrap();
    refused(
        render(scene.to_str().unwrap(), &["--size", "8x6"]),
        "triangles: needs",
        "fewer copies",
    );
    image::RgbImage::new(8000, 5000)
        .save(file("t.png"))
        .unwrap();
    let scene = file("texture.ron");
    let text = "Scene(materials: {\"m\": (texture: \"t.png\")}, objects: [sphere(radius: 1, material: \"m\")])";
    fs::write(&scene, text).unwrap();
    refused(
        render(scene.to_str().unwrap(), &["--size", "8x6"]),
        "t.png: ",
        "smaller",
    );
    let (status, printed) = render("scenes/test3.ron", &["--size", "8x6"]);
    assert_eq!(status, Some(0), "{printed}");
}

/// A file that may not become so long is an error of its writing, and leaves nothing.
#[test]
fn files_beyond_a_limit_of_their_size_end_no_process() {
    let batch = Batch::new(2);
    let path = batch.folder.path().join("p.ron");
    let out = batch.out();
    let (path, plot) = (path.to_str().unwrap(), batch.folder.path().join("plot.svg"));
    let scene = "scenes/test3.ron";
    for arguments in [
        &[
            "render",
            scene,
            path,
            "-o",
            out.to_str().unwrap(),
            "--size",
            "64x48",
        ][..],
        &["path", "plot", scene, path, "-o", plot.to_str().unwrap()],
    ] {
        let mut shell = Command::new("bash");
        shell.args([
            "-c",
            "ulimit -f 1; exec \"$@\"",
            "bash",
            env!("CARGO_BIN_EXE_flythrough"),
        ]);
        let output = shell.args(arguments).current_dir(root()).output().unwrap();
        let printed = stderr(&output);
        assert!(
            matches!(output.status.code(), Some(2 | 3)),
            "{:?}: {printed}",
            output.status
        );
        assert!(printed.contains("File too large"), "{printed}");
    }
    for folder in [&out, &batch.folder.path().to_owned()] {
        assert_eq!(partial_files(folder), [""; 0].map(PathBuf::from));
    }
}

/// What is named like a frame is read as far as a frame's metadata may stand.
#[test]
fn metadata_without_end_is_not_read() {
    let batch = Batch::new(2);
    let out = batch.out();
    assert_eq!(
        batch.render(&out, &["--size", "16x12"]).status.code(),
        Some(0)
    );
    let mut file = fs::File::create(out.join("frame_00077.png")).unwrap();
    let mut encoder = png::Encoder::new(&mut file, 1, 1);
    for _ in 0..100_000 {
        encoder
            .add_text_chunk("a".to_owned(), "b".repeat(80))
            .unwrap();
    }
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&[0])
        .unwrap();
    let (status, printed) = limited(200_000, &["verify", out.to_str().unwrap(), "-t", "1"]);
    assert_eq!(status, Some(3), "{printed}");
    let exr = fs::File::create(out.join("frame_00078.exr")).unwrap();
    exr.set_len(1 << 31).unwrap();
    let (status, printed) = limited(200_000, &["verify", out.to_str().unwrap(), "-t", "1"]);
    assert_eq!(status, Some(3), "{printed}");
}

/// The system may grant more of them later.
#[test]
fn threads_that_cannot_be_started_are_no_wrong_usage() {
    let batch = Batch::new(2);
    let path = batch.folder.path().join("p.ron");
    let arguments = [
        "check",
        "scenes/test3.ron",
        path.to_str().unwrap(),
        "--threads",
        "4000",
    ];
    let (status, printed) = limited(1_000_000, &arguments);
    assert_eq!(status, Some(3), "{printed}");
    assert!(printed.contains("threads cannot be started"), "{printed}");
    let arguments = [
        "check",
        "scenes/test3.ron",
        path.to_str().unwrap(),
        "--threads",
        "1000000",
    ];
    assert_eq!(limited(1_000_000, &arguments).0, Some(2));
}
