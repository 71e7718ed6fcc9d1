//! The READMEs: examples load, links resolve, the first page is short.
//!
//! A fence ```` ```ron ```` holds a whole scene or camera path file. A second word names the part of a file
//! that a fragment belongs to, as in ```` ```ron objects ````: the fragments of one document make one scene,
//! and each ```` ```ron keyframes ```` a camera path of its own.

use flythrough::camera_formats::parse_camera_path;
use flythrough::input::{InputFiles, load_scene};
use std::path::Path;

const DOCUMENTS: [&str; 6] = [
    "README.md",
    "paths/README.md",
    "scenes/README.md",
    "scripts/README.md",
    "tests/README.md",
    "tests/bench/README.md",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(document: &str) -> String {
    std::fs::read_to_string(root().join(document)).unwrap()
}

/// The fenced blocks of a document: the text after the opening fence, and the lines inside.
fn fences(text: &str) -> Vec<(&str, String)> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(info) = line.strip_prefix("```") {
            let body: Vec<&str> = lines.by_ref().take_while(|l| *l != "```").collect();
            blocks.push((info.trim(), body.join("\n")));
        }
    }
    blocks
}

/// Loads a scene as if its file were beside the shipped ones, and accepts no warnings.
fn check_scene(text: &str, document: &str) {
    let folder = tempfile::tempdir().unwrap();
    for name in ["models", "textures"] {
        let shipped = root().join("scenes").join(name);
        std::os::unix::fs::symlink(shipped, folder.path().join(name)).unwrap();
    }
    let file = folder.path().join("scene.ron");
    std::fs::write(&file, text).unwrap();
    match load_scene(&file, &mut InputFiles::default()) {
        Ok(input) => assert!(
            input.warnings.is_empty(),
            "{document}: {:?}",
            input.warnings
        ),
        Err(error) => panic!("{document}: {error}\n{text}"),
    }
}

fn check_path(text: &str, document: &str) {
    if let Err(error) = parse_camera_path(Path::new(document), text.as_bytes()) {
        panic!("{error}\n{text}");
    }
}

#[test]
fn every_ron_example_loads() {
    let mut count = 0;
    for document in DOCUMENTS {
        let text = read(document);
        let blocks = fences(&text);
        let part = |name: &str| -> String {
            let parts = blocks.iter().filter(|(info, _)| *info == name);
            parts.map(|(_, body)| format!("{body}\n")).collect()
        };
        let (materials, lights) = (part("ron materials"), part("ron lights"));
        let objects = part("ron objects");
        if !objects.is_empty() {
            check_scene(
                &format!(
                    "Scene(materials: {{{materials}}}, lights: [{lights}], objects: [{objects}])"
                ),
                document,
            );
        }
        for (info, body) in &blocks {
            let mut words = info.split(' ');
            if words.next() != Some("ron") {
                continue;
            }
            count += 1;
            match words.next() {
                Some("materials" | "lights" | "objects") => {
                    assert!(!objects.is_empty(), "{document}: fragments without objects");
                }
                Some("keyframes") => check_path(
                    &format!("CameraPath(fps: 24, keyframes: [{body}])"),
                    document,
                ),
                Some(other) => panic!("{document}: no file has a part `{other}`"),
                None if body.contains("CameraPath(") => check_path(body, document),
                None => check_scene(body, document),
            }
        }
    }
    assert!(count >= 8, "only {count} examples were found");
}

#[test]
fn the_first_page_is_short() {
    let bytes = read("README.md").len();
    assert!(bytes <= 9_000, "README.md has {bytes} bytes");
}

/// The anchors of a document's headings, as GitHub makes them.
fn anchors(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let kept = |c: char| c.is_alphanumeric() || "-_ ".contains(c);
    headings
        .map(|line| {
            let heading = line.trim_start_matches('#').trim().to_lowercase();
            heading
                .chars()
                .filter(|&c| kept(c))
                .collect::<String>()
                .replace(' ', "-")
        })
        .collect()
}

#[test]
fn links_between_documents_resolve() {
    for document in DOCUMENTS {
        let text = read(document);
        let targets = text.split("](").skip(1);
        for target in targets.filter_map(|rest| rest.split(')').next()) {
            if target.contains("://") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let linked = match file {
                "" => root().join(document),
                _ => root().join(document).parent().unwrap().join(file),
            };
            assert!(linked.exists(), "{document}: {target} does not exist");
            if !anchor.is_empty() {
                let headings = anchors(&std::fs::read_to_string(&linked).unwrap());
                assert!(
                    headings.iter().any(|heading| heading == anchor),
                    "{document}: {target} names no heading; there are {headings:?}"
                );
            }
        }
    }
}

#[test]
fn every_picture_is_shown() {
    let texts = DOCUMENTS.map(read).concat();
    for entry in std::fs::read_dir(root().join("scenes/pictures")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            texts.contains(&format!("pictures/{name})")),
            "no document shows {name}"
        );
    }
}
