//! Wrong models, material libraries and images: each is refused with its location, or reported in a warning.

use crate::support::*;
use std::io::Cursor;

const MODEL: &str = "Scene(objects: [model(file: \"m.obj\")])";
const TEXTURED: &str = "Scene(objects: [], materials: {\"m\": (texture: \"t.png\")})";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn models() {
    for (obj, mtl, expected) in [
        (
            "v 0 0 zero\n".to_owned(),
            "",
            "m.obj:1: `v`: zero is not a number",
        ),
        (
            format!("{TRIANGLE}f 1 2 7\n"),
            "",
            "m.obj:4: `f`: 7 names `v` number 7; 3 stand",
        ),
        (
            format!("mtllib none.mtl\n{TRIANGLE}f 1 2 3\n"),
            "",
            "m.obj: mtllib names none.mtl, which cannot be read: No such file",
        ),
        (
            format!("mtllib m.mtl\n{TRIANGLE}usemtl a\nf 1 2 3\n"),
            "newmtl a\nmap_Kd none.png\n",
            "m.mtl: material \"a\": map_Kd names none.png",
        ),
        (
            "mtllib m.mtl\n".to_owned(),
            "newmtl a\nmap_Kd m.mtl\n",
            "m.mtl: cannot be decoded as an image",
        ),
        (
            "mtllib m.mtl\n".to_owned(),
            "newmtl a\nKd 1 2\n",
            "m.mtl:2: `Kd` has 2 numbers",
        ),
        (
            "mtllib m.obj\n".to_owned(),
            "",
            "m.obj:1: `mtllib` stands before the first `newmtl`",
        ),
        (
            "mtllib .\n".to_owned(),
            "",
            "m.obj: mtllib names ., which cannot be read: it is not a regular file",
        ),
    ] {
        let files: [(&str, &[u8]); 2] = [("m.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        let (status, message) = check(MODEL, &path(KEY), &files);
        assert_eq!(status, Some(2), "{obj}: {message}");
        assert!(message.contains(expected), "{obj}: {message}");
    }
    let utf16: Vec<u8> = TRIANGLE.bytes().flat_map(|byte| [byte, 0]).collect();
    let (status, message) = check(MODEL, &path(KEY), &[("m.obj", &utf16)]);
    assert_eq!(status, Some(2), "{message}");
    assert!(
        message.contains("m.obj:1: contains a zero byte"),
        "{message}"
    );
}

/// What a download that went wrong leaves, and models of other programs.
#[test]
fn files_that_are_no_obj_models() {
    for (bytes, expected) in [
        (&b"solid a\nfacet normal 0 0 1\n"[..], "an STL file"),
        (b"<!DOCTYPE html>\n<html>", "a web page"),
        (b"To whom it may concern:\nno model\n", "hardly any"),
        (b"\x02\xfe\x13\x07\x91\x00\x1c\x05", "binary data"),
        (b"", "it is empty"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"),
    ] {
        let (status, message) = check(MODEL, &path(KEY), &[("m.obj", bytes)]);
        assert_eq!(status, Some(2), "{expected}: {message}");
        assert!(message.contains("m.obj: is no OBJ model: "), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn models_that_are_scaled_too_far() {
    let obj = format!("{TRIANGLE}f 1 2 3\n");
    let scene = "Scene(objects: [model(file: \"m.obj\", scale: (1e10, 1, 1),
        translation: (0, 1e15, 0))])";
    let (status, message) = check(scene, &path(KEY), &[("m.obj", obj.as_bytes())]);
    assert_eq!(status, Some(2), "{message}");
    let expected = "objects[0]: its scale and translation take [0, 1, 0] beyond 1e15";
    assert!(message.contains(expected), "{message}");
}

#[test]
fn what_is_ignored_or_dropped_is_a_warning() {
    let obj = "# L\u{f6}wen\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nl 1 2 3\nf 1 2\n";
    let latin1: Vec<u8> = obj.chars().map(|c| c as u8).collect();
    let scene = "Scene(materials: {\"m\": ()}, objects: [
        model(file: \"m.obj\"),
        sphere(radius: 1, material: \"m\", scale: (1, -3, 2)),
        model(file: \"l.obj\"),
    ])";
    let files: [(&str, &[u8]); 2] = [("m.obj", &latin1), ("l.obj", b"v 0 0 0\nv 1 0 0\nl 1 2\n")];
    let (status, message) = check(scene, &path(KEY), &files);
    assert_eq!(status, Some(0), "{message}");
    for expected in [
        "m.obj: not used: 1 `f` of fewer than three vertices, 1 `l`, 1 colours of `v`",
        "m.obj: 2 triangles have no material",
        "objects[1] has a non-uniform scale; it stays a sphere, with its radius scaled by the largest factor, 3",
        "l.obj: has no faces, so it is invisible",
        "1 triangles have no area and are dropped",
        "there are no lights",
    ] {
        assert!(message.contains(expected), "{message}");
    }
}

/// A picture of noise in a format.
fn picture(format: image::ImageFormat) -> Vec<u8> {
    let noise = |x: u32, y: u32| image::Rgb([x * y, x * 7 + y, x ^ y].map(|c| c as u8));
    let mut bytes = Cursor::new(Vec::new());
    image::RgbImage::from_fn(32, 32, noise)
        .write_to(&mut bytes, format)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn images() {
    use image::ImageFormat::{Bmp, Png, Tga};
    for format in [Png, Bmp, Tga] {
        let name = format!("t.{}", format.extensions_str()[0]);
        let scene = TEXTURED.replace("t.png", &name);
        let valid = picture(format);
        let of = |bytes: &[u8]| check(&scene, &path(KEY), &[(&name, bytes)]);
        assert_eq!(of(&valid).0, Some(0), "{name}");
        let trailer = [&valid[..], &[0xff, 0xda, 0, 2, 7]].concat();
        assert_eq!(of(&trailer).0, Some(0), "{name}");
        for percent in [0, 1, 10, 50, 90, 99] {
            let (status, message) = of(&valid[..valid.len() * percent / 100]);
            assert_eq!(status, Some(2), "{name}: {percent} %: {message}");
            assert!(
                message.contains("cannot be decoded as an image"),
                "{message}"
            );
        }
        // A file name of another format. Only TGA files cannot be recognised by their contents.
        if format != Tga {
            let (status, message) = check(TEXTURED, &path(KEY), &[("t.png", &valid)]);
            assert_eq!(status, Some(0), "{message}");
        }
    }
    let text = check(TEXTURED, &path(KEY), &[("t.png", b"not a picture")]);
    assert_eq!(text.0, Some(2), "{}", text.1);
    let floats = image::Rgb32FImage::new(2, 2);
    let mut exr = Cursor::new(Vec::new());
    floats
        .write_to(&mut exr, image::ImageFormat::OpenExr)
        .unwrap();
    let (status, message) = check(TEXTURED, &path(KEY), &[("t.png", exr.get_ref())]);
    assert_eq!(status, Some(2), "{message}");
    assert!(message.contains("OpenExr"), "{message}");
}

#[test]
fn images_that_claim_to_be_huge() {
    // The size in the header of a BMP file is at byte 18, without a checksum.
    let mut bmp = picture(image::ImageFormat::Bmp);
    bmp[18..22].copy_from_slice(&65_535_u32.to_le_bytes());
    bmp[22..26].copy_from_slice(&65_535_u32.to_le_bytes());
    let (status, message) = check(TEXTURED, &path(KEY), &[("t.png", &bmp)]);
    assert_eq!(status, Some(2), "{message}");
    let expected = "t.png: an image of 65535x65535 texels; a texture may have up to 268435456";
    assert!(message.contains(expected), "{message}");
    bmp[18..22].copy_from_slice(&16_384_u32.to_le_bytes());
    bmp[22..26].copy_from_slice(&16_384_u32.to_le_bytes());
    let (status, message) = check(TEXTURED, &path(KEY), &[("t.png", &bmp)]);
    assert_eq!(status, Some(2), "{message}");
    assert!(
        message.contains("t.png: cannot be decoded as an image"),
        "{message}"
    );
}

#[test]
fn references_to_what_is_not_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::create_dir(at("folder")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(at("loop"), at("loop")).unwrap();
    let mut names = vec!["", "folder", "none", "folder/none", "s.ron/none"];
    if cfg!(unix) {
        names.extend(["loop", "/dev/zero", "/dev/tty"]);
    }
    for name in names {
        for (key, text) in [
            ("objects[0].file", "objects: [model(file: NAME)]"),
            (
                "materials[\"m\"].texture",
                "objects: [], materials: {\"m\": (texture: NAME)}",
            ),
        ] {
            let text = format!("Scene({})", text.replace("NAME", &format!("{name:?}")));
            std::fs::write(at("s.ron"), text).unwrap();
            std::fs::write(at("p.ron"), path(KEY)).unwrap();
            let output = flythrough(&["check", &at("s.ron"), &at("p.ron")]);
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{name}: {message}");
            assert!(
                message.contains(&format!("s.ron: {key} names ")),
                "{message}"
            );
            assert!(message.contains("cannot be read: "), "{message}");
        }
    }
    for (scene, camera_path) in [(at("folder"), at("p.ron")), (at("s.ron"), at("folder"))] {
        let output = flythrough(&["check", &scene, &camera_path]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            stderr(&output).contains("it is not a regular file"),
            "{}",
            stderr(&output)
        );
    }
}
