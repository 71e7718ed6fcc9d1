//! Videos of frames: right, or refused. Needs ffmpeg.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use support::*;

fn make_video(frames: &Path, video: &Path) -> Output {
    let script = root().join("scripts/make_video.sh");
    Command::new(script).args([frames, video]).output().unwrap()
}

/// Twelve frames of an odd size.
fn rendered() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.ron");
    fs::write(
        &path,
        "CameraPath(fps: 12, keyframes: [
            (time: 0, position: (0, 0, 3), look_at: (0, 0, 0), fov: 45),
            (time: 0.917, position: (0.5, 0, 2.5), look_at: (0, 0, 0), fov: 45),
        ])",
    )
    .unwrap();
    let out = folder.path().join("frames");
    let (path, out) = (path.to_str().unwrap(), out.to_str().unwrap());
    let arguments = [
        "render",
        "scenes/test3.ron",
        path,
        "-o",
        out,
        "--size",
        "61x41",
    ];
    assert_eq!(flythrough(&arguments).status.code(), Some(0));
    folder
}

#[test]
fn a_video_has_every_frame_and_says_its_colours() {
    let folder = rendered();
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
    let said = String::from_utf8(probe.stdout).unwrap();
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
            said.lines().any(|line| line == expected),
            "{expected}: {said}"
        );
    }
}

/// The first frame, decoded as a player would, has the colours of the PNG.
#[test]
fn colours_survive() {
    let folder = rendered();
    let frames = folder.path().join("frames");
    for frame in 0..12 {
        let file = frames.join(format!("frame_{frame:05}.png"));
        let flat = image::RgbImage::from_fn(61, 41, |x, _| match x {
            0..30 => image::Rgb([220, 30, 40]),
            _ => image::Rgb([20, 160, 60]),
        });
        flat.save(file).unwrap();
    }
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
        for (&got, want) in at(x).iter().zip(expected) {
            assert!(got.abs_diff(want) <= 4, "{:?} for {expected:?}", at(x));
        }
    }
}

#[test]
fn gaps_short_sequences_and_damaged_frames_are_refused() {
    type Harm = fn(&Path);
    let damage: [(&str, Harm); 6] = [
        ("frame_00007.png is missing", |f| {
            fs::remove_file(f.join("frame_00007.png")).unwrap()
        }),
        ("frame_00011.png is missing", |f| {
            fs::remove_file(f.join("frame_00011.png")).unwrap()
        }),
        ("frame_00003.png is missing or empty", |f| {
            fs::write(f.join("frame_00003.png"), "").unwrap();
        }),
        ("is damaged", |f| {
            let file = f.join("frame_00005.png");
            let bytes = fs::read(&file).unwrap();
            fs::write(&file, &bytes[..bytes.len() * 2 / 3]).unwrap();
        }),
        ("holds 13 frames", |f| {
            fs::copy(f.join("frame_00000.png"), f.join("frame_00012.png")).unwrap();
        }),
        ("not all 61x41", |f| {
            image::RgbImage::new(60, 41)
                .save(f.join("frame_00002.png"))
                .unwrap();
        }),
    ];
    let whole = rendered();
    for (expected, harm) in damage {
        let folder = tempfile::tempdir().unwrap();
        for entry in fs::read_dir(whole.path().join("frames")).unwrap() {
            let entry = entry.unwrap();
            fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
        }
        harm(folder.path());
        let video = folder.path().join("v.mp4");
        let output = make_video(folder.path(), &video);
        assert_eq!(output.status.code(), Some(2), "{expected}");
        assert!(
            stderr(&output).contains(expected),
            "{expected}: {}",
            stderr(&output)
        );
        assert!(!video.exists());
    }
}
