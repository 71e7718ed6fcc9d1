//! JPEG textures beside libjpeg-turbo's programs: whole files have the pixels of `djpeg`, and no damage that it tells
//! of is silent here.

use crate::support::*;
use flythrough::input::{InputFiles, load_scene};
use flythrough::math::color::linear_to_srgb;
use glam::Vec2;
use std::fs;
use std::process::Command;

/// jpeg-decoder's blocks are within 1 of libjpeg's in each component. In blue, whose factor is the largest, that is
/// 1 + 1.772, and 0.5 for each rounding.
const TOLERANCE: u8 = 3;

/// Sizes that are multiples of no unit, and one that is of most; the largest is decoded on several threads.
const SIZES: [(u32, u32); 5] = [(37, 53), (17, 9), (1, 1), (131, 67), (64, 64)];

/// One component after the other, some interleaved, and progressive ones with every kind of scan.
const SCANS: [&str; 5] = [
    "0; 1; 2;",
    "0; 1 2;",
    "0 1; 2;",
    "0: 0-0, 0, 0; 1: 0-0, 0, 0; 2: 0-0, 0, 0;
     0: 1-63, 0, 1; 1: 1-63, 0, 0; 2: 1-63, 0, 0; 0: 1-63, 1, 0;",
    "0 1 2: 0-0, 0, 2; 0: 1-5, 0, 3; 1: 1-63, 0, 2; 2: 1-63, 0, 2; 0: 6-63, 0, 3;
     0 1 2: 0-0, 2, 1; 0: 1-63, 3, 2; 1: 1-63, 2, 1; 2: 1-63, 2, 1;
     0 1 2: 0-0, 1, 0; 0: 1-63, 2, 1; 0: 1-63, 1, 0; 1: 1-63, 1, 0; 2: 1-63, 1, 0;",
];

/// libjpeg-turbo's programs and a folder for their files. Where they are missing there is none: the test is skipped
/// with a message, or fails in CI.
struct Libjpeg {
    folder: tempfile::TempDir,
}

/// What `djpeg` makes of a file.
struct Verdict {
    /// It refuses the file, or warns of damage.
    alarm: Option<String>,
    /// RGB, row by row; empty if it refuses the file.
    pixels: Vec<u8>,
}

/// What the program makes of a texture: its RGB pixels and the warnings that name it, or why it is refused.
type Loaded = Result<(Vec<u8>, Vec<String>), String>;

impl Libjpeg {
    fn new() -> Option<Libjpeg> {
        let missing =
            ["cjpeg", "djpeg"].map(|program| Command::new(program).arg("-version").output());
        if missing.iter().all(Result::is_ok) {
            let folder = tempfile::tempdir().unwrap();
            return Some(Libjpeg { folder });
        }
        not_tested("JPEG files need cjpeg and djpeg, in Debian's package libjpeg-turbo-progs");
        None
    }

    /// A coloured picture with edges as a JPEG file.
    fn encode(
        &self,
        (width, height): (u32, u32),
        scans: Option<&str>,
        options: &[&str],
    ) -> Vec<u8> {
        let mut picture = format!("P6\n{width} {height}\n255\n").into_bytes();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let (u, v) = (f64::from(x), f64::from(y));
            let wave = |phase: f64| (127.0 + 120.0 * phase.sin()) as u8;
            let edges = if (x / 9 + y / 7) % 2 == 0 {
                40
            } else {
                (x * 7 + y * 3) as u8
            };
            picture.extend([wave(0.31 * u + 0.07 * v), wave(0.23 * v - 0.05 * u), edges]);
        }
        let file = |name: &str| self.folder.path().join(name);
        fs::write(file("p.ppm"), picture).unwrap();
        let mut cjpeg = Command::new("cjpeg");
        cjpeg.args(["-quality", "85"]).args(options);
        if let Some(scans) = scans {
            fs::write(file("scans"), scans).unwrap();
            cjpeg.arg("-scans").arg(file("scans"));
        }
        let output = cjpeg.arg(file("p.ppm")).output().unwrap();
        assert!(output.status.success(), "{options:?}: {}", stderr(&output));
        output.stdout
    }

    fn verdict(&self, jpeg: &[u8]) -> Verdict {
        let file = self.folder.path().join("d.jpg");
        fs::write(&file, jpeg).unwrap();
        let output = Command::new("djpeg")
            .arg("-ppm")
            .arg(file)
            .output()
            .unwrap();
        let alarm = stderr(&output).trim().to_owned();
        assert_eq!(output.status.success(), alarm.is_empty(), "{alarm}");
        // The header is three lines, and P5 means grey.
        let mut parts = output.stdout.splitn(4, |&byte| byte == b'\n');
        let kind = parts.next().unwrap_or_default();
        let pixels = parts.nth(2).unwrap_or_default();
        Verdict {
            alarm: (!alarm.is_empty()).then_some(alarm),
            pixels: match kind {
                b"P5" => pixels.iter().flat_map(|&grey| [grey; 3]).collect(),
                _ => pixels.to_vec(),
            },
        }
    }

    fn load(&self, jpeg: &[u8]) -> Loaded {
        let scene = "Scene(objects: [], materials: {\"m\": (texture: \"t.jpg\")})";
        let file = |name: &str| self.folder.path().join(name);
        fs::write(file("s.ron"), scene).unwrap();
        fs::write(file("t.jpg"), jpeg).unwrap();
        let input =
            load_scene(&file("s.ron"), &mut InputFiles::default()).map_err(|e| e.to_string())?;
        let texture = &input.scene.textures()[0];
        let (width, height) = texture.size();
        let centre = |index: usize, count: usize| (index as f32 + 0.5) / count as f32;
        let mut pixels = Vec::new();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let color = texture.sample(Vec2::new(centre(x, width), 1.0 - centre(y, height)));
            let code = |linear| (255.0 * linear_to_srgb(linear)).round() as u8;
            pixels.extend(color.to_array().map(code));
        }
        let mut warnings = input.warnings;
        warnings.retain(|warning| warning.contains("t.jpg: "));
        Ok((pixels, warnings))
    }

    /// The file loads without a warning and with the pixels of `djpeg`.
    fn assert_whole(&self, jpeg: &[u8], tolerance: u8, what: &str) {
        let verdict = self.verdict(jpeg);
        assert_eq!(verdict.alarm, None, "{what}");
        let (pixels, warnings) = self.load(jpeg).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(warnings, [""; 0], "{what}");
        let difference = difference(&pixels, &verdict.pixels);
        assert!(difference <= tolerance, "{what}: off by {difference}");
    }
}

fn difference(a: &[u8], b: &[u8]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

/// Where the content of the first segment with this marker begins.
fn content(jpeg: &[u8], marker: u8) -> usize {
    let mut at = 2;
    while jpeg[at + 1] != marker {
        at += 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
    }
    at + 4
}

/// Where the entropy-coded data of the first scan begins.
fn data(jpeg: &[u8]) -> usize {
    let header = content(jpeg, 0xda);
    header + usize::from(jpeg[header - 1]) - 2
}

#[test]
fn whole_files_have_the_pixels_of_djpeg() {
    let Some(libjpeg) = Libjpeg::new() else {
        return;
    };
    let samplings = [
        "1x1",
        "2x1",
        "1x2",
        "2x2",
        "4x1",
        "1x4",
        "4x2",
        "2x4",
        "3x1",
        "1x1,2x2,1x1",
        "2x2,2x1,1x1",
        "2x2,1x2,2x1",
    ];
    for &size in &SIZES[..scaled(2, 5, 5)] {
        for sampling in samplings {
            for restart in ["0", "1", "3B"] {
                let scripts = SCANS.map(|scans| (Some(scans), &[][..]));
                let mut all = vec![(None, &[][..]), (None, &["-optimize", "-progressive"])];
                all.extend(scripts);
                for (scans, more) in all {
                    let options = [&["-sample", sampling, "-restart", restart], more].concat();
                    let jpeg = libjpeg.encode(size, scans, &options);
                    let what = format!("{size:?} {options:?} {scans:?}");
                    libjpeg.assert_whole(&jpeg, TOLERANCE, &what);
                }
            }
        }
    }
}

/// A file of `count` components, none of which is interleaved, each with the data of its own grey file.
fn assembled(libjpeg: &Libjpeg, count: u8, segment: &[u8]) -> Vec<u8> {
    let size = (37, 53);
    let mut file = vec![0xff, 0xd8];
    file.extend(segment);
    let grey = |size| libjpeg.encode(size, None, &["-grayscale"]);
    let first = grey(size);
    // From the quantization table to the Huffman tables.
    let (quantization, frame) = (content(&first, 0xdb) - 4, content(&first, 0xc0));
    file.extend(&first[quantization..frame - 2]);
    file.extend([0, 8 + 3 * count]);
    file.extend(&first[frame..frame + 5]);
    file.push(count);
    file.extend((1..=count).flat_map(|id| [id, 0x11, 0]));
    file.extend(&first[content(&first, 0xc4) - 4..content(&first, 0xda) - 4]);
    for id in 1..=count {
        // Every other one is of other pixels, in as many blocks.
        let one = grey(if id % 2 == 0 { (53, 37) } else { size });
        file.extend([0xff, 0xda, 0, 8, 1, id, 0, 0, 63, 0]);
        file.extend(&one[data(&one)..one.len() - 2]);
    }
    file.extend([0xff, 0xd9]);
    file
}

/// The segment by which Adobe's programs say what the components are.
fn adobe(transform: u8) -> Vec<u8> {
    [
        &[0xff, 0xee, 0, 14][..],
        b"Adobe",
        &[0, 100, 0, 0, 0, 0, transform],
    ]
    .concat()
}

#[test]
fn every_kind_of_colour() {
    let Some(libjpeg) = Libjpeg::new() else {
        return;
    };
    let size = (37, 53);
    for options in [
        &["-grayscale"][..],
        &["-grayscale", "-sample", "2x2"],
        &["-grayscale", "-progressive", "-restart", "2"],
    ] {
        libjpeg.assert_whole(
            &libjpeg.encode(size, None, options),
            1,
            &format!("{options:?}"),
        );
    }
    libjpeg.assert_whole(
        &libjpeg.encode(size, None, &["-rgb"]),
        1,
        "RGB by its components' names",
    );
    let jfif = content(&libjpeg.encode((1, 1), None, &[]), 0xe0);
    let coloured = libjpeg.encode(size, None, &[]);
    let without_jfif = [&coloured[..2], &coloured[jfif + 14..]].concat();
    libjpeg.assert_whole(&without_jfif, TOLERANCE, "no JFIF segment");
    for transform in [0, 1] {
        let adobe = [&coloured[..2], &adobe(transform), &without_jfif[2..]].concat();
        libjpeg.assert_whole(&adobe, TOLERANCE, &format!("Adobe, {transform}"));
    }
    // Black, which may be off by 1 too, is multiplied by.
    for (segment, what) in [
        (&[][..], "CMYK"),
        (&adobe(0), "CMYK, Adobe"),
        (&adobe(2), "YCCK, Adobe"),
    ] {
        libjpeg.assert_whole(&assembled(&libjpeg, 4, segment), TOLERANCE + 1, what);
    }
}

#[test]
fn what_loses_nothing_is_a_warning() {
    let Some(libjpeg) = Libjpeg::new() else {
        return;
    };
    for options in [&[][..], &["-progressive"], &["-restart", "1"]] {
        let whole = libjpeg.encode((37, 53), None, options);
        let pixels = libjpeg.load(&whole).unwrap().0;
        let (end, scan) = (whole.len() - 2, content(&whole, 0xda) - 4);
        let with = |at: usize, more: &[u8]| [&whole[..at], more, &whole[at..]].concat();
        for (file, expected) in [
            (whole[..end].to_vec(), "its end marker is missing"),
            (whole[..end + 1].to_vec(), "its end marker is missing"),
            (with(end, &[0; 20]), "20 bytes of it belong to nothing"),
            (with(scan, &[7; 9]), "9 bytes of it belong to nothing"),
        ] {
            assert!(libjpeg.verdict(&file).alarm.is_some(), "{expected}");
            let (other, warnings) = libjpeg.load(&file).unwrap();
            assert!(other == pixels, "{expected}");
            assert_eq!(warnings.len(), 1, "{warnings:?}");
            assert!(
                warnings[0].contains("t.jpg: ") && warnings[0].contains(expected),
                "{warnings:?}"
            );
        }
        // A video behind the picture, as some cameras append it, and fill bytes, which any marker may have.
        for file in [
            with(whole.len(), &[0xff, 0xda, 0, 2, 7]),
            with(end, &[0xff; 3]),
        ] {
            assert_eq!(libjpeg.load(&file), Ok((pixels.clone(), Vec::new())));
        }
    }
}

#[test]
fn a_file_that_is_cut_short_is_refused() {
    let Some(libjpeg) = Libjpeg::new() else {
        return;
    };
    for (scans, options) in [
        (None, &[][..]),
        (None, &["-sample", "1x1", "-restart", "1"]),
        (None, &["-progressive"]),
        (Some(SCANS[0]), &[]),
        (Some(SCANS[4]), &["-restart", "3B"]),
    ] {
        let whole = libjpeg.encode((37, 53), scans, options);
        for length in (0..whole.len() - 2).step_by(scaled(7, 1, 1)) {
            let cut = &whole[..length];
            let what = format!("{options:?} {scans:?}: {length} of {} bytes", whole.len());
            let error = libjpeg.load(cut).expect_err(&what);
            assert!(
                error.contains("t.jpg: cannot be decoded as an image"),
                "{error}"
            );
        }
    }
}

/// What `djpeg` says of damage that costs no pixels, or of what a file may have.
const HARMLESS: [&str; 5] = [
    "extraneous bytes before marker",
    "Premature end of JPEG file",
    "Invalid SOS parameters for sequential JPEG",
    "Unknown Adobe color transform code",
    "unknown JFIF revision number",
];

#[test]
fn no_damage_that_djpeg_sees_is_silent() {
    let Some(libjpeg) = Libjpeg::new() else {
        return;
    };
    let mut random = 1_u64;
    let mut below = move |limit: usize| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 33) as usize % limit
    };
    let (mut alarms, mut refused) = (0, 0);
    for sampling in ["1x1", "2x1", "2x2"] {
        for restart in ["0", "3B"] {
            for scans in [None, Some(SCANS[0]), Some(SCANS[3]), Some(SCANS[4])] {
                let options = ["-sample", sampling, "-restart", restart];
                let whole = libjpeg.encode((37, 53), scans, &options);
                for number in 0..scaled(10, 60, 500) {
                    let data = data(&whole);
                    let at = data + below(whole.len() - 2 - data);
                    let end = (at + 1 + below(60)).min(whole.len() - 2);
                    let mut damaged = whole.clone();
                    match number % 5 {
                        0 => damaged[at] ^= 1 << below(8),
                        1 => damaged[at..end].fill(0),
                        2 => drop(damaged.drain(at..end)),
                        3 => damaged[below(data)] ^= 1 << below(8),
                        _ => {
                            damaged.truncate(at);
                            damaged.extend([0xff, 0xd9]);
                        }
                    }
                    let Some(alarm) = libjpeg.verdict(&damaged).alarm else {
                        // It may have become another picture: all that is asked is an answer.
                        let _ = libjpeg.load(&damaged);
                        continue;
                    };
                    alarms += 1;
                    let what =
                        format!("{options:?} {scans:?}, number {number}: djpeg says {alarm}");
                    match libjpeg.load(&damaged) {
                        Err(_) => refused += 1,
                        Ok((_, warnings)) => {
                            assert!(!warnings.is_empty(), "{what}");
                            let is_harmless =
                                |line: &str| HARMLESS.iter().any(|text| line.contains(text));
                            assert!(alarm.lines().all(is_harmless), "{what}");
                        }
                    }
                }
            }
        }
    }
    // Most damage is of a kind that djpeg sees, and most of that loses pixels.
    assert!(alarms >= scaled(100, 600, 5000), "{alarms}");
    assert!(refused * 10 >= alarms * 8, "{refused} of {alarms}");
}

#[test]
fn what_is_not_supported_is_said() {
    let Some(libjpeg) = Libjpeg::new() else {
        return;
    };
    let whole = libjpeg.encode((37, 53), None, &["-sample", "2x2,2x1,1x1"]);
    let frame = content(&whole, 0xc0);
    let with = |at: usize, bytes: &[u8]| {
        let mut file = whole.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    for (file, expected) in [
        (
            libjpeg.encode((37, 53), None, &["-arithmetic"]),
            "arithmetic coding is not supported",
        ),
        (
            with(frame - 3, &[0xc3]),
            "lossless or hierarchical coding is not supported",
        ),
        (
            with(frame, &[12]),
            "a JPEG file of 12-bit samples is not supported",
        ),
        (
            with(frame + 1, &[0, 0]),
            "whose header does not say its size is not supported",
        ),
        (
            with(frame + 7, &[0x31]),
            "a JPEG file of fractional sampling factors is not supported",
        ),
        (
            with(frame + 1, &[0x41, 0, 0x41, 0]),
            "t.jpg: an image of 16640x16640 texels; a texture may",
        ),
        (
            with(frame + 1, &[0xff, 0xff]),
            "more than 65500 texels a side is not supported",
        ),
        (
            with(frame + 1, &[0x40, 0, 0x40, 0]),
            "its pixels end 0 % of the way down",
        ),
        (
            assembled(&libjpeg, 2, &[]),
            "a JPEG file of 2 components is not supported",
        ),
        (
            libjpeg.encode((37, 53), Some("0;1;2;"), &["-sample", "4x1,2x1,1x1"]),
            "whose components are not interleaved is not supported",
        ),
    ] {
        let error = libjpeg.load(&file).expect_err(expected);
        assert!(
            error.contains("t.jpg: ") && error.contains(expected),
            "{error}"
        );
    }
}
