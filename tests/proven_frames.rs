//! Frames that are there are proven, and what is not is rendered again: nothing less, nothing more.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use support::*;

/// A scene with a model and a texture, and a path of nine frames, in a folder of their own.
struct Project {
    folder: tempfile::TempDir,
}

const SCENE: &str = "Scene(
    // A comment.
    ambient: (1, 1, 1),
    materials: {\"photo\": (texture: \"t.png\")},
    objects: [
        sphere(radius: 0.5, material: \"photo\"),
        model(file: \"m.obj\", translation: (0.5, 0, 0)),
    ],
)";

fn keys(keys: &[(f64, f64)]) -> String {
    let key = |(time, x): &(f64, f64)| {
        format!("(time: {time}, position: ({x}, 0, 3), look_at: ({x}, 0, 0), fov: 45)")
    };
    let keys: Vec<String> = keys.iter().map(key).collect();
    format!(
        "CameraPath(fps: 4, interpolation: linear, keyframes: [{}])",
        keys.join(", ")
    )
}

const KEYS: [(f64, f64); 3] = [(0.0, -0.2), (1.0, 0.0), (2.0, 0.3)];

impl Project {
    fn new() -> Project {
        let project = Project {
            folder: tempfile::tempdir().unwrap(),
        };
        project.write("s.ron", SCENE.as_bytes());
        project.write("p.ron", keys(&KEYS).as_bytes());
        project.write("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        project.picture(90);
        project
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.folder.path().join(name), bytes).unwrap();
    }

    fn picture(&self, red: u8) {
        let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([red, 100, 50]));
        picture.save(self.folder.path().join("t.png")).unwrap();
    }

    fn out(&self) -> std::path::PathBuf {
        self.folder.path().join("out")
    }

    /// Runs a command on the scene, the path and the folder of the frames.
    fn run(&self, command: &str, more: &[&str]) -> Output {
        let name = |name: &str| self.folder.path().join(name).to_str().unwrap().to_owned();
        let (scene, path, out) = (name("s.ron"), name("p.ron"), name("out"));
        flythrough(&[&[command, &scene, &path, "-o", &out], more].concat())
    }

    /// Renders, and says which of the frames' files were written.
    fn render(&self, more: &[&str]) -> Vec<u32> {
        let before = changes(&self.out());
        let size = match more.contains(&"--size") {
            true => &[][..],
            false => &["--size", "16x12"],
        };
        let output = self.run("render", &[size, more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let after = changes(&self.out());
        let written = after
            .iter()
            .filter(|(frame, at)| before.get(frame) != Some(at));
        written.map(|(frame, _)| *frame).collect()
    }

    /// The exit status of `verify`, and what it says.
    fn verify(&self) -> (Option<i32>, String) {
        let output = flythrough(&["verify", self.out().to_str().unwrap()]);
        let said = String::from_utf8(output.stdout).unwrap();
        let folder = format!("{}/", self.out().display());
        (output.status.code(), said.replace(&folder, ""))
    }

    fn missing(&self, more: &[&str]) -> String {
        let output = flythrough(&[&["missing", self.out().to_str().unwrap()], more].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stdout).unwrap()
    }

    fn file(&self, frame: u32) -> std::path::PathBuf {
        self.out().join(format!("frame_{frame:05}.png"))
    }
}

/// The inodes of the frames' files by number: a frame that is written is another file.
fn changes(folder: &Path) -> BTreeMap<u32, u64> {
    use std::os::unix::fs::MetadataExt;
    let entries = fs::read_dir(folder).into_iter().flatten();
    let of = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().ok()?;
        let number = name.strip_prefix("frame_")?.strip_suffix(".png")?;
        Some((number.parse().ok()?, entry.metadata().ok()?.ino()))
    };
    entries.filter_map(|entry| of(entry.unwrap())).collect()
}

const ALL: [u32; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];

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
        ("texture", |p| p.picture(91), &ALL),
        (
            "texture, its name",
            |p| {
                fs::rename(p.folder.path().join("t.png"), p.folder.path().join("u.png")).unwrap();
                p.picture(91);
            },
            &none,
        ),
        (
            "model",
            |p| p.write("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"),
            &ALL,
        ),
        (
            "what no scene names",
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
            "one key more",
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
        let (status, said) = project.verify();
        let number = stale.iter().filter(|frame| **frame < 9).count();
        assert_eq!(
            status,
            Some(if stale.is_empty() { 0 } else { 3 }),
            "{what}: {said}"
        );
        assert!(said.matches(": stale").count() >= number, "{what}: {said}");
        assert_eq!(project.render(&[]), stale, "{what}");
        assert_eq!(project.verify().0, Some(0), "{what}");
    }
}

/// It is not enough that the same files are there.
#[test]
fn pictures_that_change_places_make_frames_stale() {
    let project = Project::new();
    let materials = "materials: {\"other\": (texture: \"u.png\"), \"photo\"";
    let scene = SCENE.replace("materials: {\"photo\"", materials);
    project.write("s.ron", scene.as_bytes());
    project.picture(30);
    let name = |name: &str| project.folder.path().join(name);
    fs::rename(name("t.png"), name("u.png")).unwrap();
    project.picture(90);
    assert_eq!(project.render(&[]), ALL);
    for (from, to) in [("t.png", "swap"), ("u.png", "t.png"), ("swap", "u.png")] {
        fs::rename(name(from), name(to)).unwrap();
    }
    assert_eq!(project.verify().0, Some(3));
    assert_eq!(project.render(&[]), ALL);
}

#[test]
fn settings_that_decide_pixels_make_frames_stale_and_others_do_not() {
    let project = Project::new();
    assert_eq!(project.render(&[]), ALL);
    for more in [
        &["--threads", "1"][..],
        &["--order", "coarse-to-fine"],
        &["--quiet"],
        &["--progress", "openjd"],
        &["--mode", "raytracing"],
        &["--bounces", "4"],
    ] {
        assert!(project.render(more).is_empty(), "{more:?}");
    }
    for more in [
        &["--bounces", "3"][..],
        &["--samples", "2"],
        &["--seed", "1"],
        &["--exposure", "1"],
        &["--mode", "supersampling"],
        &["--format", "png16"],
        &["--size", "17x12"],
    ] {
        assert_eq!(project.render(more), ALL, "{more:?}");
        assert_eq!(project.verify().0, Some(0), "{more:?}");
    }
}

#[test]
fn what_is_wrong_with_a_frame_is_said_and_mended() {
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
    let (status, said) = project.verify();
    assert_eq!(status, Some(3));
    let expected = "\
frame_00001.png: cut short or damaged: CRC error
frame_00002.png: cut short or damaged: unexpected end of file
frame_00003.png: empty
frame_00004.png: altered after it was written
frame_00005.png: is frame 0 under another name
frame_00006.png: missing
frame_00007.png: holds no whole record of flythrough
2 of 9 frames are proven: ";
    for (line, expected) in said.lines().zip(expected.lines()) {
        assert!(line.starts_with(expected), "{line}: {expected}");
    }
    assert_eq!(said.lines().count(), 8);
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
    let (status, said) = project.verify();
    assert_eq!(status, Some(3));
    assert!(
        said.starts_with("frame_00009.png: no frame of the sequence"),
        "{said}"
    );
}

#[test]
fn the_manifest_is_made_anew_of_the_frames_and_the_plan_of_the_inputs() {
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
fn a_prepared_folder_knows_what_it_lacks() {
    let project = Project::new();
    assert!(project.render(&["--prepare", "plan"]).is_empty());
    assert_eq!(project.missing(&["--format", "openjd"]), "0-8\n");
    project.render(&["--frames", "2-3"]);
    assert_eq!(project.missing(&["--format", "openjd"]), "0-1,4-8\n");
    project.render(&[]);
    assert_eq!(project.missing(&[]), "");
    project.picture(7);
    assert_eq!(project.missing(&[]), "");
    fs::remove_file(project.folder.path().join("s.ron")).unwrap();
    let output = flythrough(&["verify", project.out().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        stderr(&output).contains("changes since are not seen"),
        "{}",
        stderr(&output)
    );
    project.write("s.ron", SCENE.as_bytes());
    project.render(&["--prepare", "plan"]);
    assert_eq!(project.missing(&["--format", "openjd"]), "0-8\n");
}

/// What a run wants to know of the light of the path, the runs after it find beside the frames.
#[test]
fn light_of_the_path_is_kept_beside_the_frames() {
    let project = Project::new();
    let more = ["--mode", "montecarlo"];
    assert!(
        project
            .render(&[&more[..], &["--prepare", "light"]].concat())
            .is_empty()
    );
    let light = project.out().join("light.cache");
    let kept = fs::metadata(&light).unwrap().modified().unwrap();
    assert_eq!(
        project.render(&[&more[..], &["--frames", "3"]].concat()),
        [3]
    );
    assert_eq!(fs::metadata(&light).unwrap().modified().unwrap(), kept);
    let once = fs::read(project.file(3)).unwrap();
    fs::write(&light, "damaged").unwrap();
    assert_eq!(
        project.render(&[&more[..], &["--frames", "3", "--force"]].concat()),
        [3]
    );
    assert_eq!(fs::read(project.file(3)).unwrap(), once);
    // The light of another path is no part of it.
    project.write("p.ron", keys(&[(0.0, 0.1), (2.0, -0.3)]).as_bytes());
    project.render(&more);
    project.write("p.ron", keys(&KEYS).as_bytes());
    assert_eq!(project.render(&more), ALL);
    assert_eq!(fs::read(project.file(3)).unwrap(), once);
}

/// Frames that are whole and say what they should, but are not what this machine renders.
#[test]
fn an_audit_finds_frames_of_another_machine() {
    let project = Project::new();
    project.render(&["--samples", "2"]);
    let audit = |sample: &str, seed: &str| {
        let out = project.out();
        let more = ["--sample", sample, "--seed", seed];
        let output = flythrough(&[&["audit", out.to_str().unwrap()][..], &more].concat());
        let said = String::from_utf8(output.stdout.clone()).unwrap();
        (output.status.code(), said + &stderr(&output))
    };
    let (status, said) = audit("100%", "0");
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains("9 of 9 frames rendered again are the same"),
        "{said}"
    );
    // A frame of another machine: this program's, of other pixels.
    odd_frame(&project, 4);
    assert_eq!(project.verify().0, Some(0));
    let (status, said) = audit("9", "0");
    assert_eq!(status, Some(3), "{said}");
    assert!(
        said.contains("frame_00004.png is not what this machine renders"),
        "{said}"
    );
    assert!(said.contains("8 of 9"), "{said}");
    // Which frames are chosen, the seed says.
    let found = |seed: u32| audit("3", &seed.to_string()).0 == Some(3);
    let found: Vec<bool> = (0..12).map(found).collect();
    assert!(found.contains(&true) && found.contains(&false), "{found:?}");
    project.picture(7);
    let (status, said) = audit("1%", "0");
    assert_eq!(status, Some(2));
    assert!(said.contains("have changed since"), "{said}");
}

/// Puts another picture in a frame's place, with a record that is right of it.
fn odd_frame(project: &Project, frame: u32) {
    use flythrough::output::{FrameFolder, Plan};
    use flythrough::render::{Claim, FrameSink, RenderedFrame};
    let plan: Plan = FrameFolder::open(&project.out()).unwrap().plan().clone();
    let (width, height) = (plan.width, plan.height);
    let folder = FrameFolder::new(&project.out(), plan, true);
    let Claim::Granted(place) = folder.claim(frame, false).unwrap() else {
        panic!("nobody else is there");
    };
    let rendered = RenderedFrame {
        film: flythrough::film::Film::new(width, height),
        deviation: None,
        error: None,
        rays: 0,
        non_finite_samples: 0,
    };
    let encoded = folder.encode(frame, rendered).unwrap();
    folder.keep(frame, place, &encoded).unwrap();
}

/// What is quoted for a sequence is held against what it took; of the bytes, which do not depend on the hour, it
/// has to hold.
#[test]
fn a_quote_is_scored() {
    let project = Project::new();
    let of = |command: &str, more: &[&str]| {
        let output = project.run(command, &[&["--size", "160x120"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    for more in [
        &["--samples", "3"][..],
        &["--mode", "montecarlo", "--gi", "exact"],
    ] {
        let quoted = of("quote", more);
        for line in ["time ", "disk ", "memory "] {
            assert!(quoted.lines().any(|l| l.starts_with(line)), "{quoted}");
        }
        let rendered = of("render", more);
        let scores: Vec<&str> = rendered
            .lines()
            .filter(|l| l.starts_with("quoted"))
            .collect();
        assert_eq!(scores.len(), 3, "{rendered}");
        assert!(
            scores[1].contains(" MB") && !scores[1].contains("OUTSIDE"),
            "{rendered}"
        );
    }
    // What is quoted for something else is no measure.
    assert!(!of("render", &["--samples", "2"]).contains("quoted"));
}

#[test]
fn a_budget_is_spent_on_samples_once() {
    let project = Project::new();
    let of =
        |command: &str, more: &[&str]| project.run(command, &[&["--size", "64x48"], more].concat());
    let both = [(); 2].map(|()| {
        let name = |name: &str| project.folder.path().join(name);
        Command::new(env!("CARGO_BIN_EXE_flythrough"))
            .arg("render")
            .args([name("s.ron"), name("p.ron")])
            .arg("-o")
            .arg(name("both"))
            .args(["--size", "64x48", "--budget", "3s"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    });
    for mut process in both {
        assert_eq!(process.wait().unwrap().code(), Some(0));
    }
    let first = of("render", &["--budget", "3s", "--frames", "0-3"]);
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    let said = String::from_utf8(first.stdout).unwrap();
    let samples: u32 = said.split(' ').next().unwrap().parse().unwrap();
    assert!(
        said.contains("samples of each pixel fit into 0:00:03") && samples > 1,
        "{said}"
    );
    // The choice stands, whoever comes after and whatever else is quoted.
    assert_eq!(of("quote", &["--samples", "2"]).status.code(), Some(0));
    let second = of("render", &["--budget", "3s"]);
    let said = String::from_utf8(second.stdout).unwrap();
    assert!(said.starts_with("5 frames rendered"), "{said}");
    let same = of("render", &["--samples", &samples.to_string()]);
    let said = String::from_utf8(same.stdout).unwrap();
    assert!(said.starts_with("0 frames rendered"), "{said}");
    let audited = flythrough(&["audit", project.out().to_str().unwrap(), "--sample", "2"]);
    assert_eq!(audited.status.code(), Some(0), "{}", stderr(&audited));
    for (more, wrong) in [
        (
            &["--budget", "1ns"][..],
            "one sample of each pixel takes longer",
        ),
        (&["--budget", "soon"], "--budget"),
        (&["--budget", "1h", "--samples", "3"], "cannot be used with"),
        (
            &["--budget", "1h", "--target-error", "0.1"],
            "cannot be used with",
        ),
    ] {
        let refused = of("quote", more);
        assert_eq!(refused.status.code(), Some(2));
        assert!(stderr(&refused).contains(wrong), "{}", stderr(&refused));
    }
}
