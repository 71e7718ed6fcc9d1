//! Names and texts that hold commands for a terminal, line breaks, or markup: shown, but never as what they are.

use crate::support::*;
use flythrough::drawing::chart::{Axis, Chart, Series};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// ESC, CR, BEL, DEL, a C1 control, right-to-left override, and a line of its own; with letters that are legitimate.
pub(crate) const HOSTILE: &str = "é日\u{1b}[31m\r\u{7}\u{7f}\u{9b}\u{202e}\nforged\n";

/// What is left of `HOSTILE` where it is shown.
pub(crate) const SHOWN: &str = r"é日\u{1b}[31m\r\u{7}\u{7f}\u{9b}\u{202e}\nforged\n";

/// Whether a text has no control but the ends of its lines, and no line that a name began.
#[track_caller]
pub(crate) fn assert_is_harmless(text: &str) {
    let control = text
        .chars()
        .find(|&c| c != '\n' && (c.is_control() || c == '\u{202e}'));
    assert_eq!(control, None, "{text:?}");
    assert!(
        !text.lines().any(|line| line.starts_with("forged")),
        "{text}"
    );
}

/// Runs the program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_flythrough"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Runs the program; it ends with `status`, and shows the hostile name as it may be shown.
#[track_caller]
fn assert_shows(folder: &Path, arguments: &[&str], status: i32, shown: &str) {
    let output = run(folder, arguments);
    let text = String::from_utf8(output.stdout.clone()).unwrap() + &stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{text}");
    assert!(text.contains(shown), "{arguments:?}: {text}");
    assert_is_harmless(&text);
}

struct Folder {
    folder: tempfile::TempDir,
}

impl Folder {
    /// A folder with a path, a texture, and a scene of a sphere.
    fn new() -> Folder {
        let folder = Folder {
            folder: tempfile::tempdir().unwrap(),
        };
        let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([90, 100, 50]));
        let mut png = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        folder.write(&format!("{HOSTILE}.png"), png.get_ref());
        folder.write(&format!("{HOSTILE}.path"), path(KEY).as_bytes());
        let scene = format!(
            "Scene(
                materials: {{\"a\": (texture: {0:?}), \"unused {HOSTILE}\": ()}},
                objects: [sphere(radius: 9, material: \"a\")]
            )",
            format!("{HOSTILE}.png")
        );
        folder.write(&format!("{HOSTILE}.ron"), scene.as_bytes());
        folder
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path().join(name), bytes).unwrap();
    }
}

#[test]
fn names_of_files_and_folders() {
    let folder = Folder::new();
    let [scene, path, texture] = ["ron", "path", "png"].map(|end| format!("{HOSTILE}.{end}"));
    let here = folder.path();
    let check = run(here, &["check", &scene, &path]);
    let printed = String::from_utf8(check.stdout.clone()).unwrap();
    for shown in ["scene      ", "path       ", "2x2 "] {
        assert!(printed.contains(&format!("{shown}{SHOWN}.")), "{printed}");
    }
    assert_is_harmless(&(printed + &stderr(&check)));

    let render = ["render", &scene, &path, "-o", HOSTILE, "--size", "8x6"];
    assert_shows(here, &render, 0, SHOWN);
    let frames = here.join(HOSTILE);
    assert_shows(here, &["verify", HOSTILE], 0, SHOWN);
    assert_shows(here, &["audit", HOSTILE], 0, SHOWN);
    assert_shows(here, &["sheet", HOSTILE], 0, SHOWN);
    assert_shows(here, &["sheet", HOSTILE, "-o", HOSTILE], 2, SHOWN);
    // A frame that fails, beside progress.
    fs::remove_file(frames.join("frame_00000.png")).unwrap();
    fs::create_dir(frames.join("frame_00000.png")).unwrap();
    assert_shows(here, &[&render[..], &["--force"]].concat(), 3, SHOWN);
    // A build that somebody wrote into the folder's record.
    let record = fs::read_to_string(frames.join("sequence.ron")).unwrap();
    let start = record.find("build: \"").unwrap() + "build: \"".len();
    let end = start + record[start..].find('"').unwrap();
    let comment = "\n// blake3 of the lines above: ";
    let (rest, _) = record[end..].split_once(comment).unwrap();
    let forged = format!("{}{HOSTILE}{rest}", &record[..start]);
    let forged = format!("{forged}{comment}{}\n", blake3::hash(forged.as_bytes()));
    fs::write(frames.join("sequence.ron"), forged).unwrap();
    assert_shows(here, &["status", HOSTILE], 0, SHOWN);
    assert_shows(here, &["status", HOSTILE, "--get", "build"], 0, SHOWN);
    assert_shows(here, &["status", HOSTILE, "--get", HOSTILE], 2, "forged");
    assert_shows(here, &["missing", HOSTILE], 2, SHOWN);

    fs::remove_file(here.join(&texture)).unwrap();
    assert_shows(here, &["check", &scene, &path], 2, SHOWN);
    fs::remove_file(here.join(&scene)).unwrap();
    assert_shows(here, &["check", &scene, &path], 2, SHOWN);
}

#[test]
fn texts_of_scenes_models_and_cameras() {
    let folder = Folder::new();
    let here = folder.path();
    let path = format!("{HOSTILE}.path");
    let scene = |name: &str, objects: &str| {
        let name = format!("{name}.ron");
        let text =
            format!("Scene(materials: {{\"{HOSTILE}\": (), \"b\": ()}}, objects: [{objects}])");
        folder.write(&name, text.as_bytes());
        name
    };
    let material = scene("material", "sphere(radius: 1, material: \"c\")");
    assert_shows(here, &["check", &material, &path], 2, SHOWN);
    let material = scene(
        "other",
        &format!("sphere(radius: 1, material: \"{HOSTILE}c\")"),
    );
    assert_shows(here, &["check", &material, &path], 2, SHOWN);
    let field = scene("field", &format!("r#{HOSTILE}: 1"));
    assert_shows(here, &["check", &field, &path], 2, "field.ron:");

    // A statement of a model ends with its line.
    let [hostile, shown] = [HOSTILE, SHOWN].map(|text| text.replace('\n', "").replace(r"\n", ""));
    let [hostile, shown] = [hostile.replace('\r', ""), shown.replace(r"\r", "")];
    let model = scene("model", "model(file: \"m.obj\")");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (obj, mtl, status) in [
        (
            format!("{hostile} 1\n{triangle}f 1 2 3\n"),
            String::new(),
            0,
        ),
        (format!("{triangle}f 1 2 {hostile}\n"), String::new(), 2),
        (format!("v 0 0 {hostile}\n"), String::new(), 2),
        (
            format!("mtllib {hostile}\n{triangle}f 1 2 3\n"),
            String::new(),
            2,
        ),
        (
            format!("mtllib m.mtl\n{triangle}usemtl a\nf 1 2 3\n"),
            format!("newmtl a\n{hostile} 1\n"),
            0,
        ),
        (
            format!("mtllib m.mtl\n{triangle}usemtl a\nf 1 2 3\n"),
            format!("newmtl a\nmap_Kd {hostile}\n"),
            2,
        ),
    ] {
        folder.write("m.obj", obj.as_bytes());
        folder.write("m.mtl", mtl.as_bytes());
        assert_shows(here, &["check", &model, &path], status, &shown);
    }

    let gltf = serde_json::json!({
        "asset": {"version": "2.0"},
        "cameras": [{"type": "perspective", "name": HOSTILE, "perspective": {"yfov": 1, "znear": 0.1}}],
        "nodes": [{"camera": 0, "name": HOSTILE}, {"camera": 0, "name": "other"}],
        "scenes": [{"nodes": [0, 1]}],
    });
    folder.write("c.gltf", gltf.to_string().as_bytes());
    for more in [&[][..], &["--camera", "none"], &["--camera", HOSTILE]] {
        let import = ["path", "import", "c.gltf", "-o", &path, "--force"];
        let output = run(here, &[&import, more].concat());
        assert_is_harmless(&(String::from_utf8(output.stdout.clone()).unwrap() + &stderr(&output)));
    }
    let import = [
        "path", "import", "c.gltf", "-o", "x.ron", "--camera", "none",
    ];
    assert_shows(here, &import, 2, SHOWN);
}

/// What clap quotes is what the user gave; a script may have got it from elsewhere.
#[test]
fn arguments() {
    let here = tempfile::tempdir().unwrap();
    let long = format!("--{HOSTILE}");
    for arguments in [
        &[HOSTILE][..],
        &["status", &long],
        &["status", "a", HOSTILE],
        &["render", "s", "p", "-o", "o", "--mode", HOSTILE],
        &["render", "s", "p", "-o", "o", "--frames", HOSTILE],
        &["render", "s", "p", "-o", "o", "--budget", HOSTILE],
        &["render", "s", "p", "-o", "o", "--format", HOSTILE],
    ] {
        assert_shows(here.path(), arguments, 2, SHOWN);
    }
}

#[test]
fn titles_of_pictures() {
    let folder = Folder::new();
    let [scene, path] = ["ron", "path"].map(|end| format!("{HOSTILE}<&\"'.{end}"));
    for (old, new) in [("ron", &scene), ("path", &path)] {
        let old = folder.path().join(format!("{HOSTILE}.{old}"));
        fs::rename(old, folder.path().join(new)).unwrap();
    }
    let plot = ["path", "plot", &scene, &path, "-o", "plot.svg"];
    assert_eq!(run(folder.path(), &plot).status.code(), Some(0));
    let svg = fs::read_to_string(folder.path().join("plot.svg")).unwrap();
    assert!(svg.contains(SHOWN), "{svg}");
    assert_is_harmless(&svg);

    let hostile = || HOSTILE.to_owned();
    let axis = || Axis {
        label: hostile(),
        logarithmic: false,
    };
    let chart = Chart {
        title: hostile(),
        x: axis(),
        y: axis(),
        series: vec![Series {
            name: hostile(),
            points: Vec::new(),
        }],
        guides: Vec::new(),
        size: (960, 600),
    };
    let svg = chart.to_svg().unwrap();
    assert_eq!(svg.matches(SHOWN).count(), 4, "{svg}");
    assert_is_harmless(&svg);
    assert!(chart.to_png().is_ok());
}
