//! Videos of frames: complete and of the right colours, or refused. Needs ffmpeg.

use crate::support::*;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// The script, to be run in a folder.
fn script(folder: &Path) -> Command {
    let mut script = Command::new(root().join("scripts/make_video.sh"));
    script
        .env("FLYTHROUGH", env!("CARGO_BIN_EXE_flythrough"))
        .current_dir(folder);
    script
}

fn make_video(frames: &Path, video: &Path) -> Output {
    script(root()).args([frames, video]).output().unwrap()
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

/// The frames are the same at another frame rate, but the video is not.
#[test]
fn the_frame_rate_is_that_of_the_path() {
    let folder = rendered(ROOM);
    let path = folder.path().join("p.ron");
    let faster = fs::read_to_string(&path)
        .unwrap()
        .replace("fps: 12", "fps: 24");
    fs::write(&path, faster.replace("0.917", "0.4585")).unwrap();
    let [frames, video] = ["frames", "v.mp4"].map(|name| folder.path().join(name));
    let output = make_video(&frames, &video);
    assert_eq!(output.status.code(), Some(3));
    let message = stderr(&output);
    assert!(
        message.contains("12 frames per second instead of 24"),
        "{message}"
    );
    assert!(!video.exists());
    let (path, out) = (path.to_str().unwrap(), frames.to_str().unwrap());
    let render = ["render", ROOM, path, "-o", out, "--size", "61x41"];
    assert_eq!(flythrough(&render).status.code(), Some(0));
    let output = make_video(&frames, &video);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(
        printed.contains("12 frames at 24.0 per second"),
        "{printed}"
    );
}

/// Names are neither patterns nor protocols of ffmpeg, nor options, nor text of a shell.
#[test]
fn names_are_data() {
    let folder = rendered(ROOM);
    let here = folder.path();
    let names: [(&[u8], &[u8]); 4] = [
        (b"-%d %05d%%", b"-v.mp4"),
        (
            b"it's \"$(touch RUN)\" *[a]{b}\\",
            b"http:$(touch RUN)'.MP4",
        ),
        (b"a\x1b[31m\r\n", b"file:\n\r%d.mov"),
        (b"concat:a|\xff", b"pipe:\xff.mkv"),
    ];
    let mut now = here.join("frames");
    for (frames, video) in names
        .map(|(frames, video)| [frames, video].map(OsStr::from_bytes))
        .map(|[f, v]| (f, v))
    {
        let next = here.join(frames);
        fs::rename(now, &next).unwrap();
        now = next;
        // The second time over its own video.
        for _ in 0..2 {
            let output = script(here).args([frames, video]).output().unwrap();
            assert!(output.status.success(), "{video:?}: {}", stderr(&output));
            let shown = [output.stdout, output.stderr].concat();
            assert!(
                !shown.contains(&0x1b) && !shown.contains(&b'\r'),
                "{video:?}"
            );
        }
        assert!(fs::metadata(here.join(video)).unwrap().len() > 1000);
    }
    // Frames, inputs and videos, and nothing beside them.
    assert_eq!(fs::read_dir(here).unwrap().count(), 2 + names.len());
}

/// What is refused leaves everything as it was.
#[test]
fn only_videos_of_the_script_are_overwritten() {
    let folder = rendered(ROOM);
    let here = folder.path();
    fs::write(here.join("notes.mp4"), "notes").unwrap();
    fs::create_dir(here.join("folder.mp4")).unwrap();
    std::os::unix::fs::symlink("notes.mp4", here.join("link.mp4")).unwrap();
    let make = |video: &str, more: &[&str]| {
        let output = script(here)
            .args(more)
            .args(["frames", video])
            .output()
            .unwrap();
        (output.status.code(), stderr(&output))
    };
    for (video, expected) in [
        ("notes.mp4", "is there already"),
        ("link.mp4", "not a regular file"),
        ("folder.mp4", "not a regular file"),
        ("video", "name it .mp4"),
        ("video.gif", "name it .mp4"),
        (".mp4", "name it .mp4"),
        ("", "usage"),
    ] {
        let (status, message) = make(video, &[]);
        assert_eq!(status, Some(2), "{video}: {message}");
        assert!(message.contains(expected), "{video}: {message}");
    }
    assert_eq!(make("link.mp4", &["--replace"]).0, Some(2));
    assert_eq!(fs::read(here.join("notes.mp4")).unwrap(), b"notes");
    assert_eq!(make("notes.mp4", &["--replace"]), (Some(0), String::new()));
    assert_eq!(make("notes.mp4", &[]), (Some(0), String::new()));
    assert_eq!(fs::read_dir(here).unwrap().count(), 5);
}

/// With a stand-in for ffmpeg that never ends.
#[test]
fn a_signal_ends_it_and_leaves_nothing() {
    let folder = rendered(ROOM);
    let here = folder.path();
    let programs = tempfile::tempdir().unwrap();
    let program = programs.path().join("ffmpeg");
    let started = programs.path().join("started");
    fs::write(
        &program,
        "#!/bin/sh\necho $$ > \"$STARTED.new\"\nmv \"$STARTED.new\" \"$STARTED\"\nexec sleep 99\n",
    )
    .unwrap();
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    fs::set_permissions(&program, mode).unwrap();
    let path = format!(
        "{}:{}",
        programs.path().display(),
        std::env::var("PATH").unwrap()
    );
    for signal in ["INT", "TERM", "HUP"] {
        let mut running = script(here)
            .env("PATH", &path)
            .env("STARTED", &started)
            .args(["frames", "v.mp4"])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let encoder = loop {
            match fs::read_to_string(&started) {
                Ok(id) => break id,
                Err(_) => {
                    assert_eq!(running.try_wait().unwrap(), None, "ended by itself");
                    sleep(Duration::from_millis(5));
                }
            }
        };
        assert_eq!(
            fs::read_dir(here).unwrap().count(),
            3,
            "an unfinished video"
        );
        let id = running.id().to_string();
        assert!(
            Command::new("kill")
                .args(["-s", signal, &id])
                .status()
                .unwrap()
                .success()
        );
        assert_eq!(running.wait().unwrap().code(), Some(75), "{signal}");
        assert_eq!(fs::read_dir(here).unwrap().count(), 2, "{signal}");
        // The system needs a moment to end it.
        let encoder = Path::new("/proc").join(encoder.trim());
        while fs::read_to_string(encoder.join("cmdline")).is_ok_and(|line| line.contains("sleep")) {
            sleep(Duration::from_millis(5));
        }
        fs::remove_file(&started).unwrap();
    }
}
