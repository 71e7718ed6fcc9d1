//! A small project on disk, its folder of frames, and the commands that work on it.

use super::{flythrough, stderr};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

/// A scene with a model and a texture, and a path of nine frames, in a folder of their own.
pub(crate) struct Project {
    pub(crate) folder: tempfile::TempDir,
}

pub(crate) const SCENE: &str = "Scene(
    // A comment.
    ambient: (1, 1, 1),
    materials: {\"photo\": (texture: \"t.png\")},
    objects: [
        sphere(radius: 0.5, material: \"photo\"),
        model(file: \"m.obj\", translation: (0.5, 0, 0)),
    ],
)";

/// A camera path file with keys of a time and an x coordinate.
pub(crate) fn keys(keys: &[(f64, f64)]) -> String {
    let key = |(time, x): &(f64, f64)| {
        format!("(time: {time}, position: ({x}, 0, 3), look_at: ({x}, 0, 0), fov: 45)")
    };
    let keys: Vec<String> = keys.iter().map(key).collect();
    format!(
        "CameraPath(fps: 4, interpolation: linear, keyframes: [{}])",
        keys.join(", ")
    )
}

pub(crate) const KEYS: [(f64, f64); 3] = [(0.0, -0.2), (1.0, 0.0), (2.0, 0.3)];

impl Project {
    pub(crate) fn new() -> Project {
        let project = Project {
            folder: tempfile::tempdir().unwrap(),
        };
        project.write("s.ron", SCENE.as_bytes());
        project.write("p.ron", keys(&KEYS).as_bytes());
        project.write("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        project.write_texture(90);
        project
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.folder.path().join(name), bytes).unwrap();
    }

    /// Writes the texture, all of one colour.
    pub(crate) fn write_texture(&self, red: u8) {
        let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([red, 100, 50]));
        picture.save(self.folder.path().join("t.png")).unwrap();
    }

    pub(crate) fn out(&self) -> std::path::PathBuf {
        self.folder.path().join("out")
    }

    /// Runs a command on the scene, the path and the folder of the frames.
    pub(crate) fn run(&self, command: &str, more: &[&str]) -> Output {
        self.run_with(command, &self.out(), more)
    }

    /// Runs a command on the scene, the path and another file or folder.
    pub(crate) fn run_with(&self, command: &str, out: &Path, more: &[&str]) -> Output {
        let name = |name: &str| self.folder.path().join(name).to_str().unwrap().to_owned();
        let (scene, path, out) = (name("s.ron"), name("p.ron"), out.to_str().unwrap());
        flythrough(&[&[command, &scene, &path, "-o", out], more].concat())
    }

    /// Renders; returns the frames whose files were written.
    pub(crate) fn render(&self, more: &[&str]) -> Vec<u32> {
        let before = frame_inodes(&self.out());
        let size = match more.contains(&"--size") {
            true => &[][..],
            false => &["--size", "16x12"],
        };
        let output = self.run("render", &[size, more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let after = frame_inodes(&self.out());
        let written = after
            .iter()
            .filter(|(frame, at)| before.get(frame) != Some(at));
        written.map(|(frame, _)| *frame).collect()
    }

    /// The exit status and the stdout of `verify`, without the name of the folder.
    pub(crate) fn verify(&self) -> (Option<i32>, String) {
        let output = flythrough(&["verify", self.out().to_str().unwrap()]);
        let printed = String::from_utf8(output.stdout).unwrap();
        let folder = format!("{}/", self.out().display());
        (output.status.code(), printed.replace(&folder, ""))
    }

    /// The stdout of `missing`.
    pub(crate) fn missing(&self, more: &[&str]) -> String {
        let output = flythrough(&[&["missing", self.out().to_str().unwrap()], more].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stdout).unwrap()
    }

    pub(crate) fn file(&self, frame: u32) -> std::path::PathBuf {
        self.out().join(format!("frame_{frame:05}.png"))
    }
}

/// The inodes of the frames' files by frame: a frame that is written again is a new file.
pub(crate) fn frame_inodes(folder: &Path) -> BTreeMap<u32, u64> {
    use std::os::unix::fs::MetadataExt;
    let entries = fs::read_dir(folder).into_iter().flatten();
    let of = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().ok()?;
        let number = name.strip_prefix("frame_")?.strip_suffix(".png")?;
        Some((number.parse().ok()?, entry.metadata().ok()?.ino()))
    };
    entries.filter_map(|entry| of(entry.unwrap())).collect()
}

/// All frames of the path.
pub(crate) const ALL: [u32; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
