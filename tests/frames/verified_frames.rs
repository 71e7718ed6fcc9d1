//! Existing frames are verified; missing, damaged and stale ones, and no others, are rendered again.

use crate::support::project::{ALL, KEYS, Project, SCENE, keys};
use crate::support::*;
use std::fs;
use std::process::{Command, Stdio};

#[test]
fn a_frame_rendered_again_is_the_same_file() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let once = frames(&project.out());
    let manifest = fs::read(project.out().join("manifest.ron")).unwrap();
    assert!(project.render(&[]).is_empty());
    assert_eq!(
        project.render(&["--force", "--frames", "2-4", "--threads", "1"]),
        [2, 3, 4]
    );
    fs::remove_dir_all(project.out()).unwrap();
    assert_eq!(
        project.render(&["--frames", "5-8", "--order", "coarse-to-fine"]),
        [5, 6, 7, 8]
    );
    assert_eq!(project.render(&[]), [0, 1, 2, 3, 4]);
    assert_eq!(frames(&project.out()), once);
    assert_eq!(
        fs::read(project.out().join("manifest.ron")).unwrap(),
        manifest
    );
}

#[test]
fn an_edit_makes_the_right_frames_stale() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    let none: [u32; 0] = [];
    type Edit = fn(&Project);
    let edits: [(&str, Edit, &[u32]); 10] = [
        ("nothing", |_| {}, &none),
        (
            "scene",
            |p| p.write("s.ron", SCENE.replace("0.5, m", "0.4, m").as_bytes()),
            &ALL,
        ),
        ("texture", |p| p.write_texture(91), &ALL),
        (
            "texture that no scene names",
            |p| {
                fs::rename(p.folder.path().join("t.png"), p.folder.path().join("u.png")).unwrap();
                p.write_texture(91);
            },
            &none,
        ),
        (
            "model",
            |p| p.write("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"),
            &ALL,
        ),
        (
            "model that no scene names",
            |p| p.write("other.obj", b"v 1 2 3"),
            &none,
        ),
        (
            "comment in the path",
            |p| {
                p.write("p.ron", format!("// Slow.\n{}", keys(&KEYS)).as_bytes());
            },
            &none,
        ),
        (
            "last key",
            |p| {
                p.write("p.ron", keys(&[KEYS[0], KEYS[1], (2.0, 0.4)]).as_bytes());
            },
            &[5, 6, 7, 8],
        ),
        (
            "added key",
            |p| {
                p.write(
                    "p.ron",
                    keys(&[KEYS[0], KEYS[1], (2.0, 0.4), (3.0, 0.4)]).as_bytes(),
                );
            },
            &[9, 10, 11, 12],
        ),
        (
            "middle key",
            |p| {
                p.write(
                    "p.ron",
                    keys(&[KEYS[0], (1.0, 0.1), (2.0, 0.4), (3.0, 0.4)]).as_bytes(),
                );
            },
            &[1, 2, 3, 4, 5, 6, 7],
        ),
    ];
    for (what, edit, stale) in edits {
        edit(&project);
        let (status, printed) = project.verify();
        let number = stale.iter().filter(|frame| **frame < 9).count();
        assert_eq!(
            status,
            Some(if stale.is_empty() { 0 } else { 3 }),
            "{what}: {printed}"
        );
        assert!(
            printed.matches(": stale").count() >= number,
            "{what}: {printed}"
        );
        assert_eq!(project.render(&[]), stale, "{what}");
        assert_eq!(project.verify().0, Some(0), "{what}");
    }
}

/// The set of files stays the same.
#[test]
fn swapped_textures_make_frames_stale() {
    let project = Project::new();
    let materials = "materials: {\"other\": (texture: \"u.png\"), \"photo\"";
    let scene = SCENE.replace("materials: {\"photo\"", materials);
    project.write("s.ron", scene.as_bytes());
    project.write_texture(30);
    let name = |name: &str| project.folder.path().join(name);
    fs::rename(name("t.png"), name("u.png")).unwrap();
    project.write_texture(90);
    assert_eq!(project.render(&[]), ALL);
    for (from, to) in [("t.png", "swap"), ("u.png", "t.png"), ("swap", "u.png")] {
        fs::rename(name(from), name(to)).unwrap();
    }
    assert_eq!(project.verify().0, Some(3));
    assert_eq!(project.render(&[]), ALL);
}

#[test]
fn damage_to_frames_is_named_and_repaired() {
    let project = Project::new();
    project.render(&[]);
    let once = frames(&project.out());
    let change = |frame: u32, change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = fs::read(project.file(frame)).unwrap();
        change(&mut bytes);
        fs::write(project.file(frame), bytes).unwrap();
    };
    let middle = once[0].1.len() / 2;
    change(1, &|bytes| bytes[middle] ^= 4);
    change(2, &|bytes| bytes.truncate(middle));
    change(3, &|bytes| bytes.clear());
    change(4, &|bytes| bytes.push(0));
    fs::copy(project.file(0), project.file(5)).unwrap();
    fs::remove_file(project.file(6)).unwrap();
    image::RgbImage::new(16, 12).save(project.file(7)).unwrap();
    let (status, printed) = project.verify();
    assert_eq!(status, Some(3));
    let expected = "\
frame_00001.png: cut short or damaged: CRC error
frame_00002.png: cut short or damaged: unexpected end of file
frame_00003.png: empty
frame_00004.png: altered after it was written
frame_00005.png: is frame 0 under another name
frame_00006.png: missing
frame_00007.png: no valid flythrough metadata
2 of 9 frames are verified: ";
    for (line, expected) in printed.lines().zip(expected.lines()) {
        assert!(line.starts_with(expected), "{line}: {expected}");
    }
    assert_eq!(printed.lines().count(), 8);
    assert_eq!(project.missing(&[]), "1\n2\n3\n4\n5\n6\n7\n");
    assert_eq!(project.missing(&["--format", "openjd"]), "1-7\n");
    assert_eq!(
        project.missing(&["--format", "slurm", "--chunk", "4"]),
        "0-1\n"
    );
    assert_eq!(project.render(&[]), [1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(frames(&project.out()), once);
    assert_eq!(project.missing(&["--format", "openjd"]), "");
    fs::write(project.file(9), "no frame").unwrap();
    let mut unread = Command::new(env!("CARGO_BIN_EXE_flythrough"))
        .arg("verify")
        .arg(project.out())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(unread.stdout.take());
    assert_eq!(unread.wait().unwrap().code(), Some(3));
    let (status, printed) = project.verify();
    assert_eq!(status, Some(3));
    assert!(
        printed.starts_with("frame_00009.png: no frame of the sequence"),
        "{printed}"
    );
}

#[test]
fn a_lost_manifest_or_sequence_record_is_written_again() {
    let project = Project::new();
    project.render(&[]);
    for name in ["manifest.ron", "sequence.ron"] {
        let file = project.out().join(name);
        let once = fs::read(&file).unwrap();
        for lost in [true, false] {
            match lost {
                true => fs::remove_file(&file).unwrap(),
                false => fs::write(&file, &once[..once.len() / 2]).unwrap(),
            }
            assert_eq!(
                project.verify().0,
                Some(if name == "sequence.ron" { 2 } else { 0 })
            );
            assert!(project.render(&[]).is_empty());
            assert_eq!(fs::read(&file).unwrap(), once, "{name}");
        }
    }
}

#[test]
fn a_prepared_folder_lists_its_missing_frames() {
    let project = Project::new();
    assert!(project.render(&["--prepare", "sequence"]).is_empty());
    assert_eq!(project.missing(&["--format", "openjd"]), "0-8\n");
    project.render(&["--frames", "2-3"]);
    assert_eq!(project.missing(&["--format", "openjd"]), "0-1,4-8\n");
    project.render(&[]);
    assert_eq!(project.missing(&[]), "");
    project.write_texture(7);
    assert_eq!(project.missing(&[]), "");
    fs::remove_file(project.folder.path().join("s.ron")).unwrap();
    let out = project.out();
    let verify = ["verify", out.to_str().unwrap()];
    for unloadable in ["gone", "(("] {
        let output = flythrough(&verify);
        assert_eq!(output.status.code(), Some(2), "{unloadable}");
        let printed = stderr(&output);
        assert!(
            printed.contains("s.ron") && printed.contains("--as-recorded"),
            "{printed}"
        );
        let output = flythrough(&[&verify[..], &["--as-recorded"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        project.write("s.ron", format!("{SCENE}((").as_bytes());
    }
    project.write("s.ron", SCENE.as_bytes());
    project.render(&["--prepare", "sequence"]);
    assert_eq!(project.missing(&["--format", "openjd"]), "0-8\n");
}

/// Runs share that cache.
#[test]
fn the_irradiance_cache_is_kept_beside_the_frames() {
    let project = Project::new();
    let more = ["--mode", "montecarlo"];
    assert!(
        project
            .render(&[&more[..], &["--prepare", "cache"]].concat())
            .is_empty()
    );
    let cache = project.out().join("irradiance.cache");
    let kept = fs::metadata(&cache).unwrap().modified().unwrap();
    assert_eq!(
        project.render(&[&more[..], &["--frames", "3"]].concat()),
        [3]
    );
    assert_eq!(fs::metadata(&cache).unwrap().modified().unwrap(), kept);
    let once = fs::read(project.file(3)).unwrap();
    fs::write(&cache, "damaged").unwrap();
    assert_eq!(
        project.render(&[&more[..], &["--frames", "3", "--force"]].concat()),
        [3]
    );
    assert_eq!(fs::read(project.file(3)).unwrap(), once);
    // Another path's records are not part of it.
    project.write("p.ron", keys(&[(0.0, 0.1), (2.0, -0.3)]).as_bytes());
    project.render(&more);
    project.write("p.ron", keys(&KEYS).as_bytes());
    assert_eq!(project.render(&more), ALL);
    assert_eq!(fs::read(project.file(3)).unwrap(), once);
    // Without missing frames no cache is needed.
    fs::remove_file(&cache).unwrap();
    assert!(project.render(&more).is_empty());
    assert!(!cache.exists());
}
