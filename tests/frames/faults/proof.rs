//! What happens to frames while others are still rendered: status 0 says that all of them are there.

use super::batch::*;
use crate::support::project::Project;
use crate::support::*;
use std::fs;
use std::path::Path;

const MORE: [&str; 4] = ["--size", "80x60", "--threads", "1"];

/// Whatever happens to a frame that is finished, while others are rendered.
#[test]
fn frames_that_change_during_the_run_are_noticed() {
    type Change = fn(&Path);
    let batch = Batch::new(40);
    let whole = batch.undisturbed(&MORE);
    let changes: [(&str, Change); 4] = [
        ("missing", |file| fs::remove_file(file).unwrap()),
        ("altered", |file| {
            let mut bytes = fs::read(file).unwrap();
            let last = bytes.len() - 1;
            bytes[last] ^= 1;
            fs::write(file, bytes).unwrap();
        }),
        // A whole frame, but not this one.
        ("altered", |file| {
            fs::copy(file.with_file_name("frame_00001.png"), file)
                .map(|_| ())
                .unwrap()
        }),
        ("altered", |file| fs::write(file, "").unwrap()),
    ];
    for (number, (expected, change)) in changes.into_iter().enumerate() {
        let out = batch.folder.path().join(number.to_string());
        let mut child = batch.start(&out, &MORE);
        wait_for_file(&mut child, &out.join("frame_00003.png"));
        change(&out.join("frame_00000.png"));
        let output = child.wait_with_output().unwrap();
        let printed = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{printed}");
        assert!(
            printed.contains("frame_00000.png: changed since") && printed.contains(expected),
            "{printed}"
        );
        // The same command repairs it; frames that were verified and not rendered are proven, too.
        let mut child = batch.start(&out, &MORE);
        let status = child.wait().unwrap();
        assert_eq!(status.code(), Some(0));
        assert!(frames(&out) == whole);
    }
}

/// Frames of inputs that are no longer there as they were are not those of the request.
#[test]
fn inputs_that_change_during_the_run_are_noticed() {
    let project = Project::new();
    let more = ["--size", "64x48", "--samples", "64", "--threads", "1"];
    for name in ["s.ron", "p.ron", "m.obj", "t.png"] {
        let out = project.folder.path().join(format!("of_{name}"));
        let file = project.folder.path().join(name);
        let [scene, path] = ["s.ron", "p.ron"].map(|name| project.folder.path().join(name));
        let inputs = [
            scene.to_str().unwrap(),
            path.to_str().unwrap(),
            "-o",
            out.to_str().unwrap(),
        ];
        let mut child = start(&[&["render"], &inputs[..], &more].concat());
        wait_for_file(&mut child, &out.join("frame_00000.png"));
        let before = fs::read(&file).unwrap();
        fs::write(&file, [&before[..], b"\n"].concat()).unwrap();
        let output = ends(child);
        let printed = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{name}: {printed}");
        assert!(
            printed.contains(&format!("{name}: has changed since it was loaded")),
            "{printed}"
        );
        fs::write(&file, before).unwrap();
        assert_eq!(
            flythrough(&[&["render"], &inputs[..], &more].concat())
                .status
                .code(),
            Some(0)
        );
    }
}

/// The frame rate decides no pixel, but the video.
#[test]
fn the_frame_rate_is_proven() {
    let batch = Batch::new(5);
    assert_eq!(batch.render(&batch.out(), &MORE).status.code(), Some(0));
    let whole = frames(&batch.out());
    let path = batch.folder.path().join("p.ron");
    let text = fs::read_to_string(&path).unwrap();
    let slower = text
        .replace("fps: 1,", "fps: 0.5,")
        .replace("time: 4", "time: 8");
    assert_ne!(slower, text);
    fs::write(&path, slower).unwrap();
    let verify = || {
        let output = flythrough(&["verify", batch.out().to_str().unwrap()]);
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap(),
        )
    };
    let (status, printed) = verify();
    assert_eq!(status, Some(3));
    assert!(
        printed.contains("sequence.ron: 1 frames per second instead of 0.5"),
        "{printed}"
    );
    assert!(printed.contains("5 of 5 frames are verified"), "{printed}");
    let folder = batch.out();
    let audit = flythrough(&["audit", folder.to_str().unwrap()]);
    assert_eq!(audit.status.code(), Some(2), "{}", stderr(&audit));
    // No frame is rendered again.
    let output = batch.render(&batch.out(), &MORE);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .starts_with("0 frames rendered")
    );
    assert_eq!(verify().0, Some(0));
    assert!(frames(&batch.out()) == whole);
    let record = batch.out().join("sequence.ron");
    let recorded = fs::read_to_string(&record).unwrap();
    fs::write(&record, recorded.replace("fps: 0.5", "fps: 1.0")).unwrap();
    assert_eq!(verify().0, Some(2));
    let folder = batch.out();
    let as_recorded = ["verify", "--as-recorded", folder.to_str().unwrap()];
    assert_eq!(flythrough(&as_recorded).status.code(), Some(2));
}
