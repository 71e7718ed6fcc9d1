//! What a sequence will take, and whether what is there is what this machine renders.

use crate::support::project::Project;
use crate::support::*;
use std::process::{Command, Stdio};

/// Frames that are whole and say what they should, but are not what this machine renders.
#[test]
fn an_audit_finds_frames_of_another_machine() {
    let project = Project::new();
    project.render(&["--samples", "2"]);
    let audit = |sample: &str, seed: &str| {
        let out = project.out();
        let more = ["--sample", sample, "--seed", seed];
        let output = flythrough(&[&["audit", out.to_str().unwrap()][..], &more].concat());
        let said = String::from_utf8(output.stdout.clone()).unwrap();
        (output.status.code(), said + &stderr(&output))
    };
    let (status, said) = audit("100%", "0");
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains("9 of 9 frames rendered again are the same"),
        "{said}"
    );
    // A frame of another machine: this program's, of other pixels.
    odd_frame(&project, 4);
    assert_eq!(project.verify().0, Some(0));
    let (status, said) = audit("9", "0");
    assert_eq!(status, Some(3), "{said}");
    assert!(
        said.contains("frame_00004.png is not what this machine renders"),
        "{said}"
    );
    assert!(said.contains("8 of 9"), "{said}");
    // Which frames are chosen, the seed says.
    let found = |seed: u32| audit("3", &seed.to_string()).0 == Some(3);
    let found: Vec<bool> = (0..12).map(found).collect();
    assert!(found.contains(&true) && found.contains(&false), "{found:?}");
    project.picture(7);
    let (status, said) = audit("1%", "0");
    assert_eq!(status, Some(2));
    assert!(said.contains("have changed since"), "{said}");
}

/// Puts another picture in a frame's place, with a record that is right of it.
fn odd_frame(project: &Project, frame: u32) {
    use flythrough::frames::{FrameFolder, SequenceRecord};
    use flythrough::render::{Claim, FrameSink, RenderedFrame};
    let sequence: SequenceRecord = FrameFolder::open(&project.out())
        .unwrap()
        .sequence()
        .clone();
    let (width, height) = (sequence.width, sequence.height);
    let folder = FrameFolder::new(&project.out(), sequence, true);
    let Claim::Granted(place) = folder.claim(frame, false).unwrap() else {
        panic!("nobody else is there");
    };
    let rendered = RenderedFrame {
        film: flythrough::film::Film::new(width, height),
        deviation: None,
        error: None,
        rays: 0,
        non_finite_samples: 0,
    };
    let encoded = folder.encode(frame, rendered).unwrap();
    folder.keep(frame, place, &encoded).unwrap();
}

/// What is quoted for a sequence is held against what it took; of the bytes, which do not depend on the hour, it
/// has to hold.
#[test]
fn a_quote_is_scored() {
    let project = Project::new();
    let of = |command: &str, more: &[&str]| {
        let output = project.run(command, &[&["--size", "160x120"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    for more in [
        &["--samples", "3"][..],
        &["--mode", "montecarlo", "--gi", "path-traced"],
    ] {
        let quoted = of("quote", more);
        for line in ["time ", "disk ", "memory "] {
            assert!(quoted.lines().any(|l| l.starts_with(line)), "{quoted}");
        }
        let rendered = of("render", more);
        let scores: Vec<&str> = rendered
            .lines()
            .filter(|l| l.starts_with("estimated"))
            .collect();
        assert_eq!(scores.len(), 3, "{rendered}");
        assert!(
            scores[1].contains(" MB") && !scores[1].contains("OUTSIDE"),
            "{rendered}"
        );
    }
    // What is quoted for something else is no measure.
    assert!(!of("render", &["--samples", "2"]).contains("estimated"));
}

#[test]
fn a_budget_is_spent_on_samples_once() {
    let project = Project::new();
    let of =
        |command: &str, more: &[&str]| project.run(command, &[&["--size", "64x48"], more].concat());
    let both = [(); 2].map(|()| {
        let name = |name: &str| project.folder.path().join(name);
        Command::new(env!("CARGO_BIN_EXE_flythrough"))
            .arg("render")
            .args([name("s.ron"), name("p.ron")])
            .arg("-o")
            .arg(name("both"))
            .args(["--size", "64x48", "--budget", "3s"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    });
    for mut process in both {
        assert_eq!(process.wait().unwrap().code(), Some(0));
    }
    let first = of("render", &["--budget", "3s", "--frames", "0-3"]);
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    let said = String::from_utf8(first.stdout).unwrap();
    let samples: u32 = said.split(' ').next().unwrap().parse().unwrap();
    assert!(
        said.contains("samples of each pixel fit into 0:00:03") && samples > 1,
        "{said}"
    );
    // The choice stands, whoever comes after and whatever else is quoted.
    assert_eq!(of("quote", &["--samples", "2"]).status.code(), Some(0));
    let second = of("render", &["--budget", "3s"]);
    let said = String::from_utf8(second.stdout).unwrap();
    assert!(said.starts_with("5 frames rendered"), "{said}");
    let same = of("render", &["--samples", &samples.to_string()]);
    let said = String::from_utf8(same.stdout).unwrap();
    assert!(said.starts_with("0 frames rendered"), "{said}");
    let audited = flythrough(&["audit", project.out().to_str().unwrap(), "--sample", "2"]);
    assert_eq!(audited.status.code(), Some(0), "{}", stderr(&audited));
    for (more, wrong) in [
        (
            &["--budget", "1ns"][..],
            "one sample of each pixel takes longer",
        ),
        (&["--budget", "soon"], "--budget"),
        (&["--budget", "1h", "--samples", "3"], "cannot be used with"),
        (
            &["--budget", "1h", "--target-error", "0.1"],
            "cannot be used with",
        ),
    ] {
        let refused = of("quote", more);
        assert_eq!(refused.status.code(), Some(2));
        assert!(stderr(&refused).contains(wrong), "{}", stderr(&refused));
    }
}
