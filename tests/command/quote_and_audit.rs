//! `quote` estimates what a sequence takes; `audit` compares frames with what this machine renders.

use crate::job::replace_frames;
use crate::support::project::Project;
use crate::support::*;
use std::process::{Command, Stdio};

/// A frame that is intact and has a correct record, but other pixels than this machine renders.
#[test]
fn an_audit_finds_frames_of_another_machine() {
    let project = Project::new();
    project.render(&["--samples", "2"]);
    let audit = |sample: &str, seed: &str| {
        let out = project.out();
        let more = ["--sample", sample, "--seed", seed];
        let output = flythrough(&[&["audit", out.to_str().unwrap()][..], &more].concat());
        let printed = String::from_utf8(output.stdout.clone()).unwrap();
        (output.status.code(), printed + &stderr(&output))
    };
    let (status, printed) = audit("100%", "0");
    assert_eq!(status, Some(0), "{printed}");
    assert!(
        printed.contains("9 of 9 frames rendered again are the same"),
        "{printed}"
    );
    replace_frames(&project.out(), &[4], flythrough::job::BUILD);
    assert_eq!(project.verify().0, Some(0));
    let (status, printed) = audit("9", "0");
    assert_eq!(status, Some(3), "{printed}");
    assert!(
        printed.contains("frame_00004.png is not what this machine renders"),
        "{printed}"
    );
    assert!(printed.contains("8 of 9"), "{printed}");
    // The seed decides which frames are sampled.
    let found = |seed: u32| audit("3", &seed.to_string()).0 == Some(3);
    let found: Vec<bool> = (0..12).map(found).collect();
    assert!(found.contains(&true) && found.contains(&false), "{found:?}");
    project.write_texture(7);
    let (status, printed) = audit("1%", "0");
    assert_eq!(status, Some(2));
    assert!(printed.contains("have changed since"), "{printed}");
}

/// Estimates are compared with what the sequence took. Time depends on the load of the machine; bytes do not, and have
/// to be within their interval.
#[test]
fn estimates_are_compared_with_the_render() {
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
        let comparisons: Vec<&str> = rendered
            .lines()
            .filter(|l| l.starts_with("estimated"))
            .collect();
        assert_eq!(comparisons.len(), 3, "{rendered}");
        assert!(
            comparisons[1].contains(" MB") && !comparisons[1].contains("OUTSIDE"),
            "{rendered}"
        );
    }
    // An estimate for other settings is not compared.
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
            .args(["--size", "64x48", "--budget", "1s"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    });
    for mut process in both {
        assert_eq!(process.wait().unwrap().code(), Some(0));
    }
    let first = of("render", &["--budget", "1s", "--frames", "0-3"]);
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    let printed = String::from_utf8(first.stdout).unwrap();
    let samples: u32 = printed.split(' ').next().unwrap().parse().unwrap();
    assert!(
        printed.contains("samples of each pixel fit into 0:00:01") && samples > 1,
        "{printed}"
    );
    // Later runs keep the choice, whatever else is quoted.
    assert_eq!(of("quote", &["--samples", "2"]).status.code(), Some(0));
    let second = of("render", &["--budget", "1s"]);
    let printed = String::from_utf8(second.stdout).unwrap();
    assert!(printed.starts_with("5 frames rendered"), "{printed}");
    let same = of("render", &["--samples", &samples.to_string()]);
    let printed = String::from_utf8(same.stdout).unwrap();
    assert!(printed.starts_with("0 frames rendered"), "{printed}");
    let audited = flythrough(&["audit", project.out().to_str().unwrap(), "--sample", "2"]);
    assert_eq!(audited.status.code(), Some(0), "{}", stderr(&audited));
    for (more, expected) in [
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
        assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
    }
}
