//! Irradiance cache files that runs of the program share.

use crate::support::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Runs a command on the room of `scenes/test3.ron` and a path; returns its exit status and all that it printed.
fn run(command: &str, path: &Path, more: &[&str]) -> (Option<i32>, String) {
    let mut arguments = vec![command, "scenes/test3.ron", path.to_str().unwrap()];
    arguments.extend(more);
    let output = flythrough(&arguments);
    let printed = String::from_utf8(output.stdout.clone()).unwrap() + &stderr(&output);
    (output.status.code(), printed)
}

/// A folder with two paths of four frames each.
struct Folder {
    folder: tempfile::TempDir,
}

impl Folder {
    fn new() -> Folder {
        let folder = tempfile::tempdir().unwrap();
        for (name, x) in [("left", -0.6), ("right", 0.6)] {
            let text = format!(
                "CameraPath(fps: 4, settings: (mode: \"montecarlo\", bounces: 2, size: (48, 27)), keyframes: [
                    (time: 0.0, position: ({x}, 0.1, 2.9), look_at: ({x}, -0.3, 0), fov: 40),
                    (time: 0.75, position: ({x}, 0.0, 2.5), look_at: ({x}, -0.2, 0), fov: 40)])"
            );
            fs::write(folder.path().join(name).with_extension("ron"), text).unwrap();
        }
        Folder { folder }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.file(name).to_str().unwrap().to_owned()
    }

    fn bake(&self, path: &str, more: &[&str]) -> (Option<i32>, String) {
        let out = self.text("gi.cache");
        run("bake", &self.file(path), &[&["--out", &out], more].concat())
    }

    fn render(&self, path: &str, out: &str, more: &[&str]) -> (Option<i32>, String) {
        let out = self.text(out);
        let always = ["--gi", "cached", "--samples", "4", "--out", &out];
        run("render", &self.file(path), &[&always, more].concat())
    }

    fn frame(&self, out: &str, number: u32) -> Vec<u8> {
        fs::read(self.file(out).join(format!("frame_{number:05}.png"))).unwrap()
    }
}

fn assert_done((status, printed): (Option<i32>, String)) -> String {
    assert_eq!(status, Some(0), "{printed}");
    printed
}

fn assert_refused((status, printed): (Option<i32>, String), why: &str) {
    assert_eq!(status, Some(2), "{printed}");
    assert!(printed.contains(why), "{printed}");
}

#[test]
fn runs_that_share_a_file_render_the_frames_of_one_run() {
    let folder = Folder::new();
    let cache = folder.text("gi.cache");
    let cache = ["--gi-cache", &cache];
    assert_done(folder.bake("left.ron", &["--threads", "2"]));
    let kept = fs::read(cache[1]).unwrap();
    for (frames, threads) in [("0-1", "1"), ("2-3", "4")] {
        let part = ["--frames", frames, "--threads", threads];
        let printed =
            assert_done(folder.render("left.ron", "parts", &[&cache[..], &part].concat()));
        assert!(printed.contains("irradiance cache read"), "{printed}");
    }
    assert_done(folder.render("left.ron", "whole", &[]));
    for number in 0..4 {
        assert!(folder.frame("parts", number) == folder.frame("whole", number));
    }
    assert!(kept == fs::read(cache[1]).unwrap());
    // A run that finds no file writes the same one.
    fs::remove_file(cache[1]).unwrap();
    assert_done(folder.render(
        "left.ron",
        "new",
        &[&cache[..], &["--frames", "3"]].concat(),
    ));
    assert!(kept == fs::read(cache[1]).unwrap());
    assert!(folder.frame("new", 3) == folder.frame("whole", 3));
}

#[test]
fn another_path_adds_the_records_it_needs() {
    let folder = Folder::new();
    let cache = folder.text("gi.cache");
    let cached = ["--gi-cache", &cache, "--frames", "0"];
    assert_done(folder.render("left.ron", "left", &cached));
    let first = fs::read(&cache).unwrap();
    let printed = assert_done(folder.render("right.ron", "right", &cached));
    assert!(printed.contains("irradiance cache baked"), "{printed}");
    let both = fs::read(&cache).unwrap();
    assert!(both.len() > first.len() && both.len() < 2 * first.len());
    // The file has the records of both now, and is not written again.
    let printed = assert_done(folder.bake("right.ron", &[]));
    assert!(printed.contains("irradiance cache read"), "{printed}");
    assert!(both == fs::read(&cache).unwrap());
    // What the file holds for another path changes no frame.
    let more = ["--gi-cache", &cache, "--frames", "1"];
    for path in ["left", "right"] {
        assert_done(folder.render(&format!("{path}.ron"), path, &more));
        let listed = flythrough(&["missing", &folder.text(path)]);
        assert_eq!(String::from_utf8(listed.stdout).unwrap(), "2\n3\n");
        let alone = format!("{path}_alone");
        assert_done(folder.render(&format!("{path}.ron"), &alone, &["--frames", "0-1"]));
        for number in 0..2 {
            assert!(folder.frame(path, number) == folder.frame(&alone, number));
        }
    }
}

/// Two paths at once: both are rendered, and the file has the records of both.
#[test]
fn paths_that_are_baked_into_one_file_at_once_do_not_lose_each_other() {
    let folder = Folder::new();
    let cache = folder.text("gi.cache");
    let render = |path: &str| folder.render(&format!("{path}.ron"), path, &["--gi-cache", &cache]);
    let results = std::thread::scope(|scope| {
        let left = scope.spawn(|| render("left"));
        let right = render("right");
        [left.join().unwrap(), right]
    });
    for (result, path) in results.into_iter().zip(["left", "right"]) {
        assert_done(result);
        let verified = flythrough(&["verify", &folder.text(path)]).status.code();
        assert_eq!(verified, Some(0));
        let printed = assert_done(folder.bake(&format!("{path}.ron"), &[]));
        assert!(printed.contains("irradiance cache read"), "{printed}");
    }
}

#[test]
fn a_cache_has_no_name_of_another_file() {
    let folder = Folder::new();
    for name in ["frames/frame_00003.png", "frames/sequence.ron", "left.ron"] {
        let _ = fs::create_dir(folder.file("frames"));
        let cache = folder.text(name);
        let more = ["--gi-cache", &cache, "--force", "--replace"];
        assert_refused(
            folder.render("left.ron", "frames", &more),
            "use another name",
        );
    }
}

#[test]
fn a_cache_of_other_inputs_is_refused() {
    let folder = Folder::new();
    let cache = folder.text("gi.cache");
    assert_done(folder.bake("left.ron", &[]));
    let kept = fs::read(&cache).unwrap();
    for other in [
        &["--bounces", "3"][..],
        &["--seed", "7"],
        &["--size", "64x36"],
        &["--target-error", "0.01"],
    ] {
        assert_refused(folder.bake("left.ron", other), "of another scene, other");
    }
    let scene = fs::read_to_string(root().join("scenes/test3.ron")).unwrap();
    fs::write(folder.file("scene.ron"), scene + "// Changed.\n").unwrap();
    let (scene, path) = (folder.text("scene.ron"), folder.text("left.ron"));
    let arguments = ["bake", &scene, &path, "--out", &cache];
    let output = flythrough(&arguments);
    assert_refused((output.status.code(), stderr(&output)), "of another scene");
    assert!(kept == fs::read(&cache).unwrap());
    assert_done(folder.bake("left.ron", &["--seed", "7", "--force"]));
    assert!(kept != fs::read(&cache).unwrap());
}

#[test]
fn damage_is_refused() {
    let folder = Folder::new();
    let cache = folder.file("gi.cache");
    assert_done(folder.bake("left.ron", &[]));
    let kept = fs::read(&cache).unwrap();
    for byte in [40, 70, 100, kept.len() / 2, kept.len() - 1] {
        let mut flipped = kept.clone();
        flipped[byte] ^= 0x10;
        fs::write(&cache, flipped).unwrap();
        assert_refused(folder.bake("left.ron", &[]), "is damaged");
        fs::write(&cache, &kept[..byte]).unwrap();
        assert_refused(folder.bake("left.ron", &[]), "is damaged");
    }
    assert_done(folder.bake("left.ron", &["--force"]));
    assert!(kept == fs::read(&cache).unwrap());
    // A file that is no irradiance cache is never overwritten.
    for text in ["", "Dear diary"] {
        fs::write(&cache, text).unwrap();
        for more in [&[][..], &["--force"]] {
            assert_refused(folder.bake("left.ron", more), "is not an irradiance cache");
        }
        assert_eq!(fs::read_to_string(&cache).unwrap(), text);
    }
}

#[test]
fn a_file_that_cannot_be_written_is_refused_before_the_work() {
    let folder = Folder::new();
    let nowhere = folder.text("nowhere/gi.cache");
    let printed = run("bake", &folder.file("left.ron"), &["--out", &nowhere]);
    assert_refused(printed, "cannot be written");
    let more = ["--gi", "path-traced", "--gi-cache", &nowhere];
    let out = folder.text("frames");
    let render = [&["--out", &out][..], &more].concat();
    assert_refused(
        run("render", &folder.file("left.ron"), &render),
        "--gi cached",
    );
}
