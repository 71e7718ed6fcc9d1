//! Videos of frames: complete and of the right colours, or refused. Needs ffmpeg.

use crate::support::*;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn make_video(frames: &Path, video: &Path) -> Output {
    let script = root().join("scripts/make_video.sh");
    Command::new(script)
        .env("FLYTHROUGH", env!("CARGO_BIN_EXE_flythrough"))
        .args([frames, video])
        .output()
        .unwrap()
}

/// Twelve frames with an odd width and height.
fn rendered(scene: &str) -> tempfile::TempDir {
    rendered_with(scene, &["--size", "61x41"])
}

fn rendered_with(scene: &str, more: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.ron");
    fs::write(
        &path,
        "CameraPath(fps: 12, keyframes: [
            (time: 0, position: (0, 0, 3), look_at: (0, 0, 0), fov: 45),
            (time: 0.917, position: (0, 0, 2.5), look_at: (0, 0, 0), fov: 45),
        ])",
    )
    .unwrap();
    let out = folder.path().join("frames");
    let (path, out) = (path.to_str().unwrap(), out.to_str().unwrap());
    let arguments = [&["render", scene, path, "-o", out], more].concat();
    assert_eq!(flythrough(&arguments).status.code(), Some(0));
    folder
}

const ROOM: &str = "scenes/test3.ron";

#[test]
fn a_video_has_every_frame_and_its_colour_space() {
    let folder = rendered(ROOM);
    let video = folder.path().join("v.mp4");
    let output = make_video(&folder.path().join("frames"), &video);
    assert!(output.status.success(), "{}", stderr(&output));
    let entries = "stream=width,height,nb_read_frames,r_frame_rate,pix_fmt,color_space,\
                   color_primaries,color_transfer,color_range";
    let probe = Command::new("ffprobe")
        .args([
            "-v",
            "error",
            "-count_frames",
            "-show_entries",
            entries,
            "-of",
            "default=nw=1",
        ])
        .arg(&video)
        .output()
        .unwrap();
    let printed = String::from_utf8(probe.stdout).unwrap();
    for expected in [
        "width=62",
        "height=42",
        "nb_read_frames=12",
        "r_frame_rate=12/1",
        "pix_fmt=yuv420p",
        "color_space=bt709",
        "color_primaries=bt709",
        "color_transfer=bt709",
        "color_range=tv",
    ] {
        assert!(
            printed.lines().any(|line| line == expected),
            "{expected}: {printed}"
        );
    }
}

#[test]
fn a_preview_makes_a_video() {
    let folder = rendered_with(ROOM, &["--preview"]);
    let video = folder.path().join("v.mp4");
    let output = make_video(&folder.path().join("frames/preview"), &video);
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(
        printed.contains("12 frames at 12.0 per second"),
        "{printed}"
    );
}

/// The first frame, decoded as by a player, has the colours of the PNG file.
#[test]
fn colours_are_those_of_the_frames() {
    let scene = tempfile::tempdir().unwrap();
    let file = scene.path().join("s.ron");
    let linear = |codes: [u8; 3]| {
        let channel = |code: u8| flythrough::math::color::srgb_to_linear(f32::from(code) / 255.0);
        let [r, g, b] = codes.map(channel);
        format!("({r}, {g}, {b})")
    };
    // Ambient light times 0.3 times the diffuse colour.
    let text = format!(
        "Scene(
            background: {},
            ambient: (3.333333, 3.333333, 3.333333),
            materials: {{\"right\": (diffuse: {})}},
            objects: [triangle(vertices: [(0, -99, 0), (99, 0, 0), (0, 99, 0)], material: \"right\")],
        )",
        linear([220, 30, 40]),
        linear([20, 160, 60])
    );
    fs::write(&file, text).unwrap();
    let folder = rendered(file.to_str().unwrap());
    let frames = folder.path().join("frames");
    let video = folder.path().join("v.mp4");
    assert!(make_video(&frames, &video).status.success());
    let decoded = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(&video)
        .args([
            "-frames:v",
            "1",
            "-vf",
            "scale=in_color_matrix=bt709:in_range=tv,format=rgb24",
        ])
        .args(["-f", "rawvideo", "-"])
        .output()
        .unwrap();
    let at = |x: usize| &decoded.stdout[3 * (20 * 62 + x)..][..3];
    for (x, expected) in [(10, [220_u8, 30, 40]), (50, [20, 160, 60])] {
        for (&code, expected_code) in at(x).iter().zip(expected) {
            assert!(
                code.abs_diff(expected_code) <= 4,
                "{:?} for {expected:?}",
                at(x)
            );
        }
    }
}

#[test]
fn gaps_short_sequences_and_damaged_frames_are_refused() {
    type Damage = fn(&Path);
    let cases: [(&str, Damage); 6] = [
        ("frame_00007.png: missing", |f| {
            fs::remove_file(f.join("frame_00007.png")).unwrap()
        }),
        ("frame_00011.png: missing", |f| {
            fs::remove_file(f.join("frame_00011.png")).unwrap()
        }),
        ("frame_00003.png: empty", |f| {
            fs::write(f.join("frame_00003.png"), "").unwrap();
        }),
        ("frame_00005.png: cut short or damaged", |f| {
            let file = f.join("frame_00005.png");
            let bytes = fs::read(&file).unwrap();
            fs::write(&file, &bytes[..bytes.len() * 2 / 3]).unwrap();
        }),
        ("frame_00012.png: no frame of the sequence", |f| {
            fs::copy(f.join("frame_00000.png"), f.join("frame_00012.png")).unwrap();
        }),
        ("frame_00002.png: no valid flythrough metadata", |f| {
            image::RgbImage::new(60, 41)
                .save(f.join("frame_00002.png"))
                .unwrap();
        }),
    ];
    let whole = rendered(ROOM);
    for (expected, damage) in cases {
        let folder = tempfile::tempdir_in(whole.path()).unwrap();
        for entry in fs::read_dir(whole.path().join("frames")).unwrap() {
            let entry = entry.unwrap();
            fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
        }
        damage(folder.path());
        let video = folder.path().join("v.mp4");
        let output = make_video(folder.path(), &video);
        assert_eq!(output.status.code(), Some(3), "{expected}");
        assert!(
            stderr(&output).contains(expected),
            "{expected}: {}",
            stderr(&output)
        );
        assert!(!video.exists());
    }
    let output = make_video(&whole.path().join("nothing"), &whole.path().join("v.mp4"));
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("sequence.ron"),
        "{}",
        stderr(&output)
    );
}
