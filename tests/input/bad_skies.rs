//! Wrong skies: each is refused with its location.

use crate::support::*;
use image::{ImageFormat, Rgb, Rgb32FImage};
use std::io::Cursor;

/// An image of 4 x 2 texels of radiance 1, but for one.
fn picture(format: ImageFormat, texel: [f32; 3]) -> Vec<u8> {
    let mut picture = Rgb32FImage::from_pixel(4, 2, Rgb([1.0; 3]));
    picture.put_pixel(2, 1, Rgb(texel));
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn scene(background: &str) -> String {
    format!("Scene(objects: [], background: {background})")
}

#[test]
fn syntax_and_values() {
    for (background, expected) in [
        ("3", "s.ron:1:32: "),
        ("\"sky.exr\"", "s.ron:1:32: "),
        ("(1, 2)", "s.ron:1:37: "),
        ("(1, 2, 3, 4)", "s.ron:1:"),
        (
            "fog(zenith: (1, 1, 1))",
            "Unexpected variant named `fog` in enum `Background`, expected either `gradient` or `map` instead",
        ),
        (
            "gradient(zenith: (1, 1, 1))",
            "missing field named `horizon` in `gradient`",
        ),
        (
            "gradient(zenith: (1, 1, 1), horizon: (0, 0, 0), north: (0, 0, 0))",
            "s.ron:1:80: Unexpected field named `north` in `gradient`",
        ),
        ("map(intensity: 1)", "missing field named `file` in `map`"),
        (
            "map(file: \"sky.exr\", scale: 2)",
            "Unexpected field named `scale` in `map`",
        ),
        (
            "(0, -1, 0)",
            "s.ron: background: (0, -1, 0): every channel must lie between 0 and 1e15",
        ),
        (
            "(0, NaN, 0)",
            "s.ron: background: (0, NaN, 0): every channel",
        ),
        (
            "gradient(zenith: (1e16, 1, 1), horizon: (0, 0, 0))",
            "s.ron: background.zenith: (1",
        ),
        (
            "gradient(zenith: (1, 1, 1), horizon: (0, -1, 0))",
            "s.ron: background.horizon: (0, -1, 0)",
        ),
        (
            "gradient(zenith: (1, 1, 1), horizon: (0, 0, 0), nadir: (0, inf, 0))",
            "s.ron: background.nadir: (0, inf, 0)",
        ),
        (
            "map(file: \"sky.exr\", intensity: -1)",
            "s.ron: background.intensity: -1 is not between 0 and",
        ),
        (
            "map(file: \"sky.exr\", rotation: NaN)",
            "s.ron: background.rotation: NaN is not between",
        ),
        (
            "map(file: \"no.exr\")",
            "s.ron: background.file names no.exr, which cannot be read: No such file",
        ),
    ] {
        let (status, message) = check(&scene(background), &path(KEY), &[]);
        assert_eq!(status, Some(2), "{background}: {message}");
        assert!(message.contains(expected), "{background}: {message}");
    }
    for background in [
        "(1, 2, 3)",
        "( 1.5,2,3, )",
        "gradient(zenith: (1, 1, 1), horizon: (0, 0, 0))",
    ] {
        let (status, message) = check(&scene(background), &path(KEY), &[]);
        assert_eq!(status, Some(0), "{background}: {message}");
    }
}

#[test]
fn images() {
    let exr = |texel| picture(ImageFormat::OpenExr, texel);
    let whole = exr([1.0; 3]);
    let hdr = picture(ImageFormat::Hdr, [1.0; 3]);
    let mut png = Cursor::new(Vec::new());
    let pixels = image::RgbImage::new(4, 2);
    pixels.write_to(&mut png, ImageFormat::Png).unwrap();
    let texel = "sky.exr: texel (2, 1), from the upper left, is ";
    let cases = [
        (
            exr([0.0, f32::NAN, 0.0]),
            "1",
            format!("{texel}(0, NaN, 0): every channel must lie between 0 and 1e15"),
        ),
        (
            exr([0.0, 0.0, f32::INFINITY]),
            "0",
            format!("{texel}(0, 0, inf)"),
        ),
        (exr([-1.0, 0.0, 0.0]), "0", format!("{texel}(-1, 0, 0)")),
        (exr([1e10, 0.0, 0.0]), "1e6", format!("{texel}(1")),
        (
            png.into_inner(),
            "1",
            "sky.exr: its format is Png; an image of the sky is an OpenEXR or a Radiance HDR"
                .to_owned(),
        ),
        (
            b"no image".to_vec(),
            "1",
            "sky.exr: its format is `Unknown`".to_owned(),
        ),
        (
            whole[..whole.len() - 8].to_vec(),
            "1",
            "sky.exr: cannot be decoded as an image".to_owned(),
        ),
        (
            hdr[..hdr.len() - 8].to_vec(),
            "1",
            "sky.exr: cannot be decoded as an image".to_owned(),
        ),
    ];
    for (bytes, intensity, expected) in cases {
        let scene = scene(&format!("map(file: \"sky.exr\", intensity: {intensity})"));
        let (status, message) = check(&scene, &path(KEY), &[("sky.exr", &bytes)]);
        assert_eq!(status, Some(2), "{expected}: {message}");
        assert!(message.contains(&expected), "{expected}: {message}");
    }
    for bytes in [&whole, &hdr] {
        // The content tells the format.
        let scene = scene("map(file: \"sky.exr\")");
        let (status, message) = check(&scene, &path(KEY), &[("sky.exr", bytes)]);
        assert_eq!(status, Some(0), "{message}");
    }
    // A header that claims more texels than may be.
    let large = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65535 +X 65535\n";
    let (status, message) = check(
        &scene("map(file: \"l.hdr\")"),
        &path(KEY),
        &[("l.hdr", large)],
    );
    assert_eq!(status, Some(2), "{message}");
    let expected = "l.hdr: an image of 65535x65535 texels; a texture may have up to 268435456";
    assert!(message.contains(expected), "{message}");
}

/// Linear floats are no textures, which are sRGB.
#[test]
fn images_of_the_sky_are_no_textures() {
    for (name, format) in [("t.exr", ImageFormat::OpenExr), ("t.hdr", ImageFormat::Hdr)] {
        let scene = format!("Scene(objects: [], materials: {{\"m\": (texture: {name:?})}})");
        let bytes = picture(format, [1.0; 3]);
        let (status, message) = check(&scene, &path(KEY), &[(name, &bytes)]);
        assert_eq!(status, Some(2), "{message}");
        assert!(message.contains("is not supported"), "{message}");
    }
}
