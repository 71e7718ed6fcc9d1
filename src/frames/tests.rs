//! Folders of frames.

use super::encoded_pixels::Contents;
use super::format::FrameFormat;
use super::verify::VerifyError;
use super::{FolderError, FrameFolder, SequenceRecord};
use crate::film::Film;
use crate::render::{
    Claim, ErrorEstimate, FrameErrorEstimate, FrameSink, RenderedFrame, SinkError,
};
use crate::storage::fixtures::names;
use glam::Vec3;
use ron::value::RawValue;
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs;
use std::os::unix::fs::symlink;

fn job(scene: &str) -> Box<RawValue> {
    RawValue::from_boxed_ron(format!("Job(scene: {scene:?})").into()).expect("RON")
}

fn sequence(input_hash: &str) -> SequenceRecord {
    SequenceRecord {
        build: "build".to_owned(),
        accepted_builds: Vec::new(),
        job: job("scene.ron"),
        fps: 25.0,
        frames: 3,
        width: 4,
        height: 2,
        format: FrameFormat::Png,
        exposure: 0.0,
        error_maps: false,
        cache_error_maps: false,
        irradiance_cache: false,
        input_hashes: vec![input_hash.to_owned(); 3],
    }
}

fn rendered(light: f32) -> RenderedFrame {
    RenderedFrame {
        film: Film::from_pixels(4, 2, vec![Vec3::splat(light); 8]),
        half_difference: Some(Film::from_pixels(4, 2, vec![Vec3::splat(-0.1); 8])),
        expected_errors: Vec::new(),
        cache_errors: None,
        display_white: 1.0,
        error: FrameErrorEstimate {
            whole: ErrorEstimate {
                rel_mse: 0.001,
                standard_error: 0.0001,
            },
            worst_block: 0.01,
            blurred: 0.0001,
        },
        rays: 0,
        non_finite_samples: 0,
    }
}

fn store(folder: &FrameFolder, frame: u32) -> Result<(), SinkError> {
    let Claim::Granted(lock) = folder.claim(frame, false)? else {
        panic!("nobody else is there");
    };
    let encoded = folder.encode(frame, rendered(0.5)).expect("encodes");
    folder.store(frame, lock, &encoded)
}

#[test]
fn what_is_stored_is_verified_and_nothing_else_is_left() {
    let root = tempfile::tempdir().expect("a folder");
    let path = root.path().join("deep/er");
    let folder = FrameFolder::new(&path, sequence("a"), false);
    folder.prepare().expect("new");
    assert!(matches!(folder.verify(2), Err(VerifyError::Missing)));
    store(&folder, 2).expect("stored");
    let record = folder.verify(2).expect("whole");
    assert_eq!((record.frame, record.input_hash.as_str()), (2, "a"));
    assert_eq!(names(&path), ["frame_00002.png", "sequence.ron"]);
    assert!(matches!(folder.claim(2, false), Ok(Claim::AlreadyStored)));
    let opened = FrameFolder::open(&path).expect("there");
    assert_eq!(opened.verify(2).expect("whole"), record);
}

#[test]
fn a_locked_frame_is_busy_for_others() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = |force| FrameFolder::new(root.path(), sequence("a"), force);
    let lock = folder(false).claim(1, false).expect("free");
    assert!(matches!(folder(false).claim(1, false), Ok(Claim::Busy)));
    assert!(matches!(
        folder(false).claim(1, true),
        Ok(Claim::Granted(_))
    ));
    drop(lock);
    store(&folder(false), 1).expect("free again");
    assert!(matches!(
        folder(false).claim(1, true),
        Ok(Claim::AlreadyStored)
    ));
    assert!(matches!(
        folder(true).claim(1, false),
        Ok(Claim::Granted(_))
    ));
}

#[test]
fn every_fault_is_told_from_the_others() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    store(&folder, 0).expect("stored");
    let file = folder.file_of(0);
    let whole = fs::read(&file).expect("there");
    let fault = |bytes: &[u8]| {
        fs::write(&file, bytes).expect("written");
        folder.verify(0).expect_err("changed").to_string()
    };
    assert_eq!(fault(b""), "empty");
    assert!(fault(&whole[..40]).starts_with("cut short or damaged"));
    assert!(fault(b"text").starts_with("cut short or damaged"));
    assert!(fault(&[&whole[..], b"more"].concat()).starts_with("altered"));
    let format = FrameFormat::Png;
    let Ok(Contents { metadata, pixels }) = format.decode(&whole, (4, 2)) else {
        panic!("whole");
    };
    let (metadata, mut pixels) = (metadata.expect("there"), pixels.expect("whole"));
    assert!(
        fault(&format.encode(&pixels, "other").expect("encodes"))
            .starts_with("no valid flythrough metadata")
    );
    pixels.samples[5] += 1;
    assert!(fault(&format.encode(&pixels, &metadata).expect("encodes")).starts_with("altered"));
    store(&folder, 1).expect("stored");
    let other = fs::read(folder.file_of(1)).expect("there");
    assert_eq!(fault(&other), "is frame 1 under another name");
    fs::write(&file, &whole).expect("written");
    let of_another = FrameFolder::new(root.path(), sequence("b"), false);
    let stale = of_another.verify(0).expect_err("other").to_string();
    assert!(stale.starts_with("stale"), "{stale}");
    for other in [
        SequenceRecord {
            width: 5,
            ..sequence("b")
        },
        SequenceRecord {
            format: FrameFormat::Png16,
            ..sequence("b")
        },
    ] {
        let stale = FrameFolder::new(root.path(), other, false).verify(0);
        assert!(matches!(stale, Err(VerifyError::Stale)));
    }
    folder.verify(0).expect("as it was");
}

/// Of each file every bit is flipped, one after the other.
#[test]
fn no_flipped_bit_goes_unseen() {
    let root = tempfile::tempdir().expect("a folder");
    for format in [FrameFormat::Png, FrameFormat::Png16, FrameFormat::Exr] {
        let of_format = SequenceRecord {
            format,
            ..sequence("a")
        };
        let folder = FrameFolder::new(root.path(), of_format, false);
        store(&folder, 0).expect("stored");
        let file = folder.file_of(0);
        let whole = fs::read(&file).expect("there");
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            fs::write(&file, &bytes).expect("written");
            assert!(folder.verify(0).is_err(), "{format:?}: bit {bit}");
        }
    }
}

#[test]
fn an_error_map_belongs_to_its_frame() {
    let root = tempfile::tempdir().expect("a folder");
    let with_maps = SequenceRecord {
        error_maps: true,
        ..sequence("a")
    };
    let folder = FrameFolder::new(root.path(), with_maps, false);
    store(&folder, 0).expect("stored");
    folder.verify(0).expect("whole");
    fs::write(folder.maps_of(0).next().expect("one"), "half").expect("written");
    assert!(matches!(folder.verify(0), Err(VerifyError::ErrorMap(_))));
    store(&folder, 0).expect("made again");
    folder.verify(0).expect("whole");
    let without = FrameFolder::new(root.path(), sequence("a"), true);
    store(&without, 0).expect("stored");
    assert_eq!(
        without.clean().expect("can be removed"),
        ["error_00000.exr"]
    );
}

#[test]
fn sequences_are_compared_but_for_the_job() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    folder.prepare().expect("new");
    let mut same = sequence("a");
    same.job = job("moved/scene.ron");
    assert!(FrameFolder::new(root.path(), same, false).has_its_sequence());
    let other = FrameFolder::new(root.path(), sequence("b"), false);
    assert!(!other.has_its_sequence());
    other.prepare().expect("written over");
    assert!(other.has_its_sequence() && !other.has_another_sequence());
    assert!(!folder.has_its_sequence() && folder.has_another_sequence());
    fs::write(root.path().join("sequence.ron"), "Sequence(").expect("written");
    assert!(matches!(
        FrameFolder::open(root.path()),
        Err(FolderError::NoSequence { .. })
    ));
}

/// Two builds may render other pixels: frames of another one count only if it is accepted.
#[test]
fn frames_of_other_builds_are_accepted_knowingly() {
    let root = tempfile::tempdir().expect("a folder");
    let older = SequenceRecord {
        build: "older".to_owned(),
        ..sequence("a")
    };
    store(&FrameFolder::new(root.path(), older, false), 0).expect("stored");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    let error = folder.verify(0).expect_err("another build").to_string();
    assert!(error.contains("--accept-build older"), "{error}");
    assert!(folder.current_record(0).is_none());
    assert!(matches!(folder.claim(0, false), Ok(Claim::Granted(_))));
    let refused = folder.check_unoccupied().expect_err("they are finished");
    let refused = refused.to_string();
    assert!(
        refused.contains("--accept-build older to keep them"),
        "{refused}"
    );
    folder.prepare().expect("allowed");
    let accepting = SequenceRecord {
        accepted_builds: vec!["oldest".to_owned(), "older".to_owned()],
        ..sequence("a")
    };
    let folder = FrameFolder::new(root.path(), accepting.clone(), false);
    assert!(!folder.has_its_sequence() && !folder.has_another_sequence());
    folder.prepare().expect("written");
    folder.verify(0).expect("accepted");
    let opened = FrameFolder::open(root.path()).expect("there");
    assert_eq!(opened.sequence(), &accepting);
    assert!(opened.current_record(0).is_some() && opened.verify(0).is_ok());
}

/// Frames of another format or beyond the last one, error maps of frames that have none; and what only looks like them.
#[test]
fn strays_are_named_and_only_own_ones_removed() {
    let root = tempfile::tempdir().expect("a folder");
    let longer = SequenceRecord {
        frames: 4,
        format: FrameFormat::Exr,
        error_maps: true,
        input_hashes: vec!["a".to_owned(); 4],
        ..sequence("a")
    };
    store(&FrameFolder::new(root.path(), longer, false), 3).expect("stored");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    store(&folder, 0).expect("stored");
    for name in ["frame_00003.png", "frame_1.png", "notes.txt"] {
        fs::write(root.path().join(name), "x").expect("written");
    }
    let strays = |folder: &FrameFolder| -> Vec<(String, bool)> {
        let strays = folder.strays().expect("can be read").into_iter();
        strays.map(|stray| (stray.name, stray.is_own)).collect()
    };
    let stray = |name: &str, is_own| (name.to_owned(), is_own);
    let own = [
        stray("error_00003.exr", true),
        stray("frame_00003.exr", true),
    ];
    let foreign = [stray("frame_00003.png", false), stray("frame_1.png", false)];
    assert_eq!(strays(&folder), [own.clone(), foreign.clone()].concat());
    let removed = folder.clean().expect("can be removed");
    assert_eq!(removed, own.map(|(name, _)| name));
    assert_eq!(strays(&folder), foreign);
}

/// What is there of others is refused, unless the user allows to write over it; the own is repaired.
#[test]
fn nothing_of_others_is_taken_over_unasked() {
    let root = tempfile::tempdir().expect("a folder");
    let prepare = |hash: &str, replace| {
        let folder = FrameFolder::new(root.path(), sequence(hash), false);
        let checked = if replace {
            Ok(())
        } else {
            folder.check_unoccupied()
        };
        let prepared = checked.and_then(|()| folder.prepare());
        prepared.map_err(|error| error.to_string())
    };
    let write = |name: &str| fs::write(root.path().join(name), "precious").expect("written");
    for name in [
        "frame_00001.png",
        "errors.csv",
        "cameras.jsonl",
        "sheet.png",
    ] {
        write(name);
        let refused = prepare("a", false).expect_err(name);
        assert!(
            refused.contains(name) && refused.contains("--replace"),
            "{refused}"
        );
        assert_eq!(names(root.path()), [name]);
        prepare("a", true).expect("allowed");
        for name in names(root.path()) {
            fs::remove_file(root.path().join(name)).expect("there");
        }
    }
    // Estimates and caches are made before frames.
    fs::write(root.path().join("estimate.ron"), "Estimate(").expect("written");
    prepare("a", false).expect("free");
    let of = |hash: &str| FrameFolder::new(root.path(), sequence(hash), false);
    store(&of("a"), 0).expect("stored");
    write("frame_00001.png");
    prepare("a", false).expect("its own, damaged");
    let refused = prepare("b", false).expect_err("another sequence");
    assert!(
        refused.contains("finished frames of another scene or path are there, 1 in number"),
        "{refused}"
    );
    // A lost or damaged record of the sequence is made again where there are frames of it.
    for damage in ["", "Sequence("] {
        fs::write(root.path().join("sequence.ron"), damage).expect("written");
        prepare("b", false).expect_err("another sequence");
        prepare("a", false).expect("its own");
    }
    prepare("b", true).expect("allowed");
    prepare("b", false).expect("was allowed");
    of("a").verify(0).expect("still there");
}

/// What changes or removes files after they were stored or verified is found.
#[test]
fn proofs_see_what_happened_since() {
    let root = tempfile::tempdir().expect("a folder");
    let path = root.path().join("frames");
    let with_maps = SequenceRecord {
        error_maps: true,
        cache_error_maps: true,
        ..sequence("a")
    };
    let folder = FrameFolder::new(&path, with_maps.clone(), false);
    folder.prepare().expect("new");
    store(&folder, 0).expect("stored");
    store(&folder, 1).expect("stored");
    let another = FrameFolder::new(&path, with_maps, false);
    another.verify(1).expect("whole");
    for folder in [&folder, &another] {
        folder.prove(0).expect("whole");
        folder.prove(1).expect("whole");
        assert!(matches!(folder.prove(2), Err(VerifyError::Missing)));
        let files =
            |frame: u32| std::iter::once(folder.file_of(frame)).chain(folder.maps_of(frame));
        assert_eq!(files(1).count(), 3);
        for (file, other) in files(1).zip(files(0)) {
            let whole = fs::read(&file).expect("there");
            // Whole, but another file than the one that was written.
            fs::copy(other, &file).expect("written");
            let altered = folder.prove(1).expect_err("altered").to_string();
            assert!(
                altered.ends_with("altered after it was written"),
                "{altered}"
            );
            fs::remove_file(&file).expect("there");
            let missing = folder.prove(1).expect_err("missing").to_string();
            assert!(missing.ends_with("missing"), "{missing}");
            fs::write(&file, whole).expect("written");
        }
        folder.prove(1).expect("as it was");
    }
    fs::rename(&path, root.path().join("moved")).expect("moved");
    assert!(folder.prove(0).is_err() && another.prove(1).is_err());
}

#[test]
fn edits_of_the_record_are_seen() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    folder.prepare().expect("new");
    let file = root.path().join("sequence.ron");
    let text = fs::read_to_string(&file).expect("there");
    let slower = text.replace("fps: 25.0", "fps: 12.5");
    assert_ne!(text, slower);
    for edited in [
        &slower,
        &text[..text.len() - 9],
        &text.replace("blake3", "hash"),
    ] {
        fs::write(&file, edited).expect("written");
        assert!(FrameFolder::open(root.path()).is_err(), "{edited}");
    }
    let other = SequenceRecord {
        fps: 12.5,
        format: FrameFormat::Exr,
        ..sequence("b")
    };
    let contradictions = sequence("a").contradictions(&other);
    let expected = [
        "12.5 frames per second instead of 25 frames per second",
        "exr files instead of png files",
    ];
    assert_eq!(contradictions, expected);
}

/// Links, pipes and devices under the names of frames are read neither for ever nor elsewhere, and nothing is written
/// through them.
#[test]
fn planted_files_are_replaced_and_not_followed() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    folder.prepare().expect("new");
    let precious = root.path().join("precious");
    fs::write(&precious, "data").expect("written");
    for target in ["precious", "/dev/zero", "nowhere"] {
        symlink(target, folder.file_of(0)).expect("linked");
        assert!(folder.verify(0).is_err() && folder.record(0).is_none());
        store(&folder, 0).expect("stored");
        folder.verify(0).expect("whole");
        fs::remove_file(folder.file_of(0)).expect("there");
    }
    assert_eq!(fs::read(&precious).expect("there"), b"data");
    mknodat(CWD, folder.file_of(0), FileType::Fifo, Mode::RUSR, 0).expect("made");
    assert!(folder.verify(0).is_err() && folder.record(0).is_none());
    store(&folder, 0).expect("stored");
    folder.verify(0).expect("whole");
    fs::write(folder.file_of(1), vec![0; 1 << 20]).expect("written");
    let long = folder.verify(1).expect_err("too long").to_string();
    assert!(long.contains("more than the"), "{long}");
}

#[test]
fn a_frame_that_cannot_be_written_names_its_file() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = FrameFolder::new(root.path(), sequence("a"), false);
    fs::create_dir(folder.file_of(1)).expect("made");
    let error = store(&folder, 1).expect_err("in the way").to_string();
    assert!(error.contains("frame_00001.png"), "{error}");
    assert_eq!(names(root.path()), ["frame_00001.png"]);
    fs::remove_dir_all(root.path()).expect("removed");
    let error = store(&folder, 2).expect_err("nowhere").to_string();
    assert!(error.contains("frame_00002.png"), "{error}");
}
