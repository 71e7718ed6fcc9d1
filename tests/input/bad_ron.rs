//! Scene and camera path files with broken syntax, and with numbers of every kind.

use crate::support::*;

/// Text of broken syntax, in place of a scene and of a path.
#[test]
fn broken_text() {
    let deep = |opening: &str| opening.repeat(100_000);
    let cases: [(Vec<u8>, &str); 15] = [
        ("".into(), ":1:1: Expected opening"),
        ("// nothing".into(), "Expected opening"),
        ("/* nothing".into(), "Unclosed block comment"),
        ("\0".into(), ":1:1: "),
        ("FILE\0".into(), "Non-whitespace trailing"),
        ("FILE FILE".into(), "Non-whitespace trailing"),
        ("FILE)".into(), "Non-whitespace trailing"),
        ("NAME(".into(), ""),
        ("NAME(\n  \"".into(), "Expected identifier"),
        (
            "Picture()".into(),
            ":1:1: Expected struct `NAME` but found `Picture`",
        ),
        (deep("(").into(), ""),
        (deep("NAME(").into(), ""),
        (deep("/*").into(), "Unclosed block comment"),
        (
            b"NAME(\n \xe4)".to_vec(),
            ":2:2: not valid UTF-8; save the file as UTF-8",
        ),
        (
            "NAME()".encode_utf16().flat_map(u16::to_le_bytes).collect(),
            "",
        ),
    ];
    let empty = "Scene(objects: [])";
    for (bytes, expected) in cases {
        for (name, valid) in [("Scene", empty), ("CameraPath", &path(KEY))] {
            // Bytes that are not UTF-8 are refused whatever they name.
            let bytes = match String::from_utf8(bytes.clone()) {
                Ok(text) => text
                    .replace("FILE", valid)
                    .replace("NAME", name)
                    .into_bytes(),
                Err(_) => bytes.clone(),
            };
            let path = path(KEY);
            let files = [
                ("b.ron", &bytes[..]),
                ("s.ron", empty.as_bytes()),
                ("p.ron", path.as_bytes()),
            ];
            let (scene, path) = match name {
                "Scene" => ("b.ron", "p.ron"),
                _ => ("s.ron", "b.ron"),
            };
            let (status, message) = check_files(scene, path, &files);
            let expected = expected.replace("NAME", name);
            assert_eq!(status, Some(2), "{expected}: {message}");
            assert!(message.starts_with("flythrough: b.ron:"), "{message}");
            assert!(message.contains(&expected), "{expected}: {message}");
        }
    }
    let marked = format!("\u{feff}{empty}");
    assert_eq!(check(&marked, &path(KEY), &[]).0, Some(0));
}

/// Numbers of every kind, in fields of every kind.
#[test]
fn numbers() {
    let sphere = "objects: [sphere(radius: R, material: \"m\")], materials: {\"m\": ()}";
    let placed = sphere.replace("R,", "1, translation: (R, 0, 0),");
    let scaled = sphere.replace("R,", "1, scale: (R, 1, 1),");
    let lit = "objects: [], lights: [(position: (0, 0, 0), intensity: (R, 0, 0))]";
    let settings = |text: &str| format!("objects: [], settings: ({text})");
    let scenes: [(&str, &[&str], &[&str]); 10] = [
        (
            sphere,
            &[
                "NaN", "inf", "-inf", "-1", "-0.0", "0", "1e16", "1e308", "1e999", "1e-16",
                "1e-320", "\"1\"", "()", "1.5.5", "0x", "--1",
            ],
            &["1e-15", "1e15", "1", "1_000.5", "+2.5e-3", ".5"],
        ),
        (
            &placed,
            &["NaN", "inf", "-1.1e15", "1e308", "1e999"],
            &["-0.0", "1e-45", "1e-320", "-1e15"],
        ),
        (
            &scaled,
            &["NaN", "inf", "0", "-0.0", "1e-320", "1e-16", "1e16"],
            &["-1", "1e-15"],
        ),
        (
            lit,
            &["NaN", "-1e-300", "1.1e15", "inf"],
            &["0", "-0.0", "1e-320", "1e15"],
        ),
        (
            &settings("size: (R, 9)"),
            &[
                "0",
                "-1",
                "1.5",
                "NaN",
                "32769",
                "4294967295",
                "4294967296",
                "1e3",
                "(9)",
            ],
            &["1", "32768"],
        ),
        (
            &settings("samples: R"),
            &["0", "-1", "1048577", "4294967295", "18446744073709551616"],
            &["1", "1048576"],
        ),
        (
            &settings("splits: R"),
            &[
                "[0]",
                "[1, 0]",
                "[-1]",
                "[1048577]",
                "[1.5]",
                "3",
                "[[1]]",
                "[4096, 4096, 2]",
                "[1048576, 1048576, 1048576, 1048576]",
            ],
            &["[]", "[1048576]", "[4096, 4096]", "[32, 32, 32, 32]"],
        ),
        (
            &settings("bounces: R"),
            &["-1", "65", "4294967296"],
            &["0", "64"],
        ),
        (
            &settings("exposure: R"),
            &["NaN", "inf", "65", "1e39"],
            &["-64", "1e-320"],
        ),
        (
            &settings("seed: R"),
            &["-1", "4294967296", "0.5"],
            &["4294967295"],
        ),
    ];
    // Checks which numbers are refused in a scene and a path made `with` each, and that the message names the file.
    let check_numbers =
        |[wrong, right]: [&[&str]; 2], file: &str, with: &dyn Fn(&str) -> [String; 2]| {
            for (numbers, expected) in [(wrong, 2), (right, 0)] {
                for number in numbers {
                    let [scene, path] = with(number);
                    let (status, message) = check(&scene, &path, &[]);
                    assert_eq!(status, Some(expected), "{scene} {path}: {message}");
                    assert!(expected == 0 || message.contains(file), "{message}");
                }
            }
        };
    for (text, wrong, right) in scenes {
        check_numbers([wrong, right], "s.ron:", &|number| {
            let scene = format!("Scene({})", text.replace('R', number));
            [scene, path(KEY)]
        });
    }
    let key = "CameraPath(fps: 24, keyframes: [(time: 0, position: (0, 0, 0), \
               rotation: (0, 0, 0), fov: 50)])";
    let paths: [(&str, &[&str], &[&str]); 4] = [
        (
            "fps: 24",
            &["NaN", "inf", "-1", "-0.0", "1e16", "1e-320"],
            &["23.976", "1e15"],
        ),
        (
            "time: 0",
            &["NaN", "-inf", "1.1e9", "1e999"],
            &["-1e9", "-0.0", "1e-320"],
        ),
        (
            "fov: 50",
            &["0", "-50", "180", "NaN", "inf", "1e308"],
            &["1e-320", "179.999"],
        ),
        (
            "rotation: (0",
            &["NaN", "inf", "1e16"],
            &["1e15", "-1e-320"],
        ),
    ];
    for (text, wrong, right) in paths {
        check_numbers([wrong, right], "p.ron:", &|number| {
            let start = text.trim_end_matches(|c: char| c.is_ascii_digit());
            let path = key.replace(text, &format!("{start}{number}"));
            ["Scene(objects: [])".to_owned(), path]
        });
    }
    let long = "CameraPath(fps: 1e15, keyframes: [
        (time: 0, position: (0, 0, 0), rotation: (0, 0, 0), fov: 50),
        (time: 1, position: (0, 0, 1), rotation: (0, 0, 0), fov: 50)])";
    let (status, message) = check("Scene(objects: [])", long, &[]);
    assert_eq!(status, Some(2), "{message}");
    assert!(
        message.contains("p.ron: fps: gives more than 10000000 frames"),
        "{message}"
    );
}
