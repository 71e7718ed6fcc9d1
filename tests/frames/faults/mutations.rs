//! Random damage: to finished folders, which a rerun repairs, and to input files, which are refused or rendered.

use super::batch::*;
use crate::support::project::Project;
use crate::support::*;
use flythrough::sampling::Random;
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// All files of a folder, by name.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.collect();
    files.sort();
    files
        .into_iter()
        .map(|file| (file.clone(), fs::read(file).unwrap()))
        .collect()
}

/// Other bytes: flipped, cut, continued, filled, replaced in part by others of the same file.
fn mutated(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.below(3) {
        let length = bytes.len().max(1);
        let at = random.below(length);
        let count = 1 + random.below(length - at).min(40);
        match random.below(6) {
            0 => bytes.truncate(at),
            1 => bytes.extend((0..count).map(|_| random.below(256) as u8)),
            2 if !bytes.is_empty() => bytes[at..at + count].fill(0),
            3 if !bytes.is_empty() => {
                let from = random.below(length - count + 1);
                bytes.copy_within(from..from + count, at);
            }
            4 if !bytes.is_empty() => drop(bytes.drain(at..at + count)),
            _ if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            _ => {}
        }
    }
    bytes
}

/// Damages one of some files.
fn damage(files: &[(PathBuf, Vec<u8>)], random: &mut Random) {
    let (file, bytes) = &files[random.below(files.len())];
    let (other, other_bytes) = &files[random.below(files.len())];
    let remove = || fs::remove_file(file).or_else(|_| fs::remove_dir_all(file));
    match random.below(8) {
        0 => drop(remove()),
        1 => {
            let _ = remove();
            mknodat(CWD, file, FileType::Fifo, Mode::RWXU, 0).unwrap();
        }
        2 => {
            let _ = remove();
            symlink(
                ["/dev/zero", "nowhere", other.to_str().unwrap()][random.below(3)],
                file,
            )
            .unwrap();
        }
        3 if file != other && other.is_file() => {
            let _ = remove();
            fs::hard_link(other, file).unwrap();
        }
        4 => {
            let _ = remove();
            fs::write(file, other_bytes).unwrap();
        }
        _ => {
            let _ = remove();
            fs::write(file, mutated(bytes, random)).unwrap();
        }
    }
}

/// Up to three files of a folder are damaged, again and again; each time the same command makes it whole.
#[test]
fn damaged_folders_are_repaired() {
    for (more, count) in [
        (&["--size", "8x6"][..], scaled(15, 40, 400)),
        (
            &[
                "--size",
                "8x6",
                "--mode",
                "montecarlo",
                "--samples",
                "2",
                "--aov",
                "error",
            ],
            scaled(3, 10, 100),
        ),
    ] {
        let batch = Batch::new(6);
        let out = batch.out();
        let more = [more, &["--threads", "1"]].concat();
        assert_eq!(batch.render(&out, &more).status.code(), Some(0));
        let whole = files(&out);
        let mut random = Random::new(7);
        for number in 0..count {
            for _ in 0..1 + random.below(3) {
                damage(&whole, &mut random);
            }
            let output = ends(batch.start(&out, &more));
            assert_eq!(
                output.status.code(),
                Some(0),
                "{number}: {}",
                stderr(&output)
            );
            assert!(frames(&out) == frames_of(&whole), "{number}");
            let verified = flythrough(&["verify", out.to_str().unwrap()]);
            assert_eq!(
                verified.status.code(),
                Some(0),
                "{number}: {}",
                stderr(&verified)
            );
            for (file, bytes) in &whole {
                let _ = fs::remove_file(file);
                fs::write(file, bytes).unwrap();
            }
        }
    }
}

/// The frames among files.
fn frames_of(files: &[(PathBuf, Vec<u8>)]) -> Vec<(PathBuf, Vec<u8>)> {
    let named = files
        .iter()
        .map(|(file, bytes)| (PathBuf::from(file.file_name().unwrap()), bytes.clone()));
    named
        .filter(|(name, _)| name.to_str().unwrap().starts_with("frame_"))
        .collect()
}

/// One input file is damaged: the program refuses it, or renders a frame that is then verified.
#[test]
fn damaged_inputs_are_refused_or_rendered() {
    let project = Project::new();
    project.write("m.obj", b"mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    project.write(
        "m.mtl",
        b"newmtl a\nKd 0.5 0.5 0.5\nKs 0.1 0.1 0.1\nNs 20\nmap_Kd t.png\n",
    );
    let inputs = files(project.folder.path());
    let out = project.out();
    let cache = project.folder.path().join("light.cache");
    let more = [
        "--mode",
        "montecarlo",
        "--frames",
        "0",
        "--size",
        "8x6",
        "--gi",
        "path-traced",
        "--splits",
        "1",
    ];
    let bake = ["--size", "8x6", "--threads", "1"];
    assert_eq!(
        project.run_with("bake", &cache, &bake).status.code(),
        Some(0)
    );
    let baked = fs::read(&cache).unwrap();
    let mut random = Random::new(3);
    let mut statuses = [0; 4];
    for number in 0..scaled(30, 80, 2000) {
        let (file, bytes) = &inputs[random.below(inputs.len())];
        fs::write(file, mutated(bytes, &mut random)).unwrap();
        let output = project.run("render", &more);
        let status = output.status.code();
        let printed = stderr(&output);
        assert!(
            matches!(status, Some(0 | 2 | 3)),
            "{number}: {}: {status:?}: {printed}",
            file.display()
        );
        statuses[status.unwrap() as usize] += 1;
        if status == Some(0) {
            let missing =
                flythrough(&["missing", "-q", out.to_str().unwrap(), "--format", "openjd"]);
            assert!(
                !String::from_utf8(missing.stdout).unwrap().starts_with('0'),
                "{number}"
            );
        }
        fs::write(file, bytes).unwrap();
        if number % 10 == 0 {
            fs::write(&cache, mutated(&baked, &mut random)).unwrap();
            let status = project.run_with("bake", &cache, &bake).status.code();
            assert!(matches!(status, Some(0 | 2)), "{number}: {status:?}");
            let _ = fs::remove_dir_all(&out);
        }
    }
    assert!(statuses[0] > 0 && statuses[2] > 0, "{statuses:?}");
}
