//! Tells an OBJ file from others that are named in its place, so that these are refused, not seen as nothing.

use super::error::InputError;
use std::path::Path;

/// How files of other kinds begin, after white space, in lower case; and what they are.
const SIGNATURES: [(&[u8], &str); 19] = [
    (b"glTF", "a binary glTF file (.glb)"),
    (b"kaydara fbx binary", "a binary FBX file"),
    (b"; fbx", "an FBX file"),
    (b"ply\n", "a PLY file"),
    (b"ply\r", "a PLY file"),
    (b"off\n", "an OFF file"),
    (b"off\r", "an OFF file"),
    (b"#usda", "a USD file"),
    (b"pxr-usdc", "a USD file"),
    (b"blender", "a Blender file"),
    (
        b"pk\x03\x04",
        "a zip archive (3MF, USDZ and others are such)",
    ),
    (b"\x1f\x8b", "compressed by gzip"),
    (b"<!doctype html", "a web page"),
    (b"<html", "a web page"),
    (b"<", "an XML file (COLLADA, X3D and others are such)"),
    (
        b"version https://git-lfs",
        "a pointer of Git LFS, not the file itself",
    ),
    (b"{", "a JSON file (glTF is such)"),
    (b"\x89png", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
];

/// Statements of OBJ files (Wavefront, "Advanced Visualizer Manual", appendix B1), those of old versions among them.
const KEYWORDS: [&str; 47] = [
    "v",
    "vt",
    "vn",
    "vp",
    "p",
    "l",
    "f",
    "fo",
    "curv",
    "curv2",
    "surf",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "g",
    "s",
    "mg",
    "o",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "call",
    "csh",
    "bzp",
    "bsp",
    "cdc",
    "cdp",
    "res",
    "vc",
    "vw",
];

/// Refuses a file whose bytes are no text or those of another format.
pub(super) fn check_bytes(file: &Path, bytes: &[u8]) -> Result<(), InputError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start: Vec<u8> = text.trim_ascii_start().iter().take(32).copied().collect();
    let begins = |with: &[u8]| {
        let start = start.get(..with.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(with))
    };
    let known = SIGNATURES.iter().find(|(signature, _)| begins(signature));
    if let Some((_, kind)) = known {
        return refuse(file, kind);
    }
    if is_binary_stl(bytes) {
        return refuse(file, "a binary STL file");
    }
    if begins(b"solid")
        && text
            .windows(6)
            .any(|word| word.eq_ignore_ascii_case(b"facet "))
    {
        return refuse(file, "an STL file");
    }
    // DOS ends texts with SUB, and ESC selects alphabets.
    let is_control = |byte: &u8| *byte < b' ' && !matches!(byte, 9..=13 | 0x1a | 0x1b);
    let controls = bytes.iter().filter(|&byte| is_control(byte)).count();
    // UTF-16 is refused later, with advice of its own.
    let is_text = controls <= 1 || MAX_CONTROLS * controls <= bytes.len() || is_utf16(bytes);
    if is_text {
        return Ok(());
    }
    refuse(file, "binary data")
}

/// One control character, or one in so many bytes, may be a slip in a comment.
const MAX_CONTROLS: usize = 64;

/// Whether bytes begin with the mark of UTF-16, or every other one is 0, as in Latin text.
fn is_utf16(bytes: &[u8]) -> bool {
    let zeros = |first: usize| {
        let bytes = bytes.iter().skip(first).step_by(2);
        bytes.filter(|&&byte| byte == 0).count()
    };
    let [even, odd] = [zeros(0), zeros(1)];
    let has_mark = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    has_mark || (even.min(odd) == 0 && 8 * even.max(odd) > 3 * bytes.len())
}

/// A header of 80 bytes, the number of triangles, and 50 bytes for each.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.try_into().ok());
    let size = |count: [u8; 4]| 84 + 50 * u64::from(u32::from_le_bytes(count));
    count.is_some_and(|count| size(count) == bytes.len() as u64)
}

fn refuse(file: &Path, kind: &str) -> Result<(), InputError> {
    let seems = format!("it seems to be {kind}; export the model as OBJ");
    Err(InputError::NotObj {
        file: file.to_owned(),
        seems,
    })
}

/// Counts the statements of a file, to tell whether it is an OBJ file.
#[derive(Default)]
pub(super) struct ObjStatements {
    known: usize,
    unknown: usize,
    vertices: usize,
    /// Faces, and lines, points, curves and surfaces, which are not shown but stand for a model.
    elements: usize,
    /// Those of MTL files that begin a material.
    materials: usize,
}

impl ObjStatements {
    /// Counts a statement.
    pub(super) fn add(&mut self, keyword: &str) {
        match KEYWORDS.contains(&keyword) {
            true => self.known += 1,
            false => self.unknown += 1,
        }
        match keyword {
            "v" => self.vertices += 1,
            "f" | "fo" | "l" | "p" | "curv" | "curv2" | "surf" | "bzp" | "bsp" | "cdc" | "cdp"
            | "res" => self.elements += 1,
            "newmtl" => self.materials += 1,
            _ => {}
        }
    }

    /// Refuses a file that has no statement of OBJ, or hardly any, or vertices of nothing.
    pub(super) fn check(&self, file: &Path) -> Result<(), InputError> {
        let seems = if self.elements > 0 {
            return Ok(());
        } else if self.known + self.unknown == 0 {
            "it is empty, or holds comments only; export the model again"
        } else if self.materials > 0 {
            "it seems to be a material library (MTL); name the OBJ file that uses it"
        } else if self.unknown > self.known {
            "hardly any of its lines is a statement of OBJ; export the model as OBJ"
        } else if self.vertices > 0 {
            "it has vertices, but no faces: a point cloud, or cut short; export the model with faces"
        } else {
            return Ok(());
        };
        Err(InputError::NotObj {
            file: file.to_owned(),
            seems: seems.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    /// What a file is taken for; none for an OBJ file.
    fn taken_for(bytes: &[u8]) -> Option<String> {
        check_bytes(Path::new("x.obj"), bytes)
            .err()
            .map(|error| error.to_string())
    }

    #[test]
    fn other_formats_are_recognised() {
        let stl = [&[b' '; 80][..], &2_u32.to_le_bytes(), &[0; 100]].concat();
        let noise: Vec<u8> = (0..999_u32)
            .map(|i| (i.wrapping_mul(2_654_435_769) >> 13) as u8 | 1)
            .collect();
        for (bytes, kind) in [
            (&b"solid cube\n facet normal 0 0 1\n"[..], "STL"),
            (&stl, "binary STL"),
            (b"glTF\x02\0\0\0", "glTF"),
            (b"{\"asset\": {}}", "JSON"),
            (b"ply\r\nformat ascii 1.0\r\n", "PLY"),
            (b"Kaydara FBX Binary  \0", "FBX"),
            (b"; FBX 7.3.0 project file\n", "FBX"),
            (b"\xef\xbb\xbf<?xml version=\"1.0\"?>\n<COLLADA>", "XML"),
            (b"\n<!DOCTYPE HTML>\n", "a web page"),
            (b"version https://git-lfs.github.com/spec/v1\n", "Git LFS"),
            (b"\x1f\x8b\x08", "gzip"),
            (b"OFF\n8 6 0\n", "OFF"),
            (&noise, "binary data"),
            (&[7, 0, 0, 0, 9, 9], "binary data"),
        ] {
            let found = taken_for(bytes).unwrap_or_default();
            assert!(found.contains(kind), "{kind}: {found}");
        }
    }

    #[test]
    fn odd_obj_files_are_none_of_them() {
        for before in [
            "",
            "\u{feff}",
            "# <html> {\n",
            "# solid facet \n",
            "o solid\n",
            "# a slip \u{1} in a comment of many, many, many words that says nothing at all\n",
        ] {
            assert_eq!(
                taken_for((before.to_owned() + TRIANGLE).as_bytes()),
                None,
                "{before}"
            );
        }
        assert_eq!(taken_for((TRIANGLE.to_owned() + "\u{1a}").as_bytes()), None);
        // Refused later, as text that is not UTF-8.
        let wide: Vec<u8> = TRIANGLE.bytes().flat_map(|byte| [byte, 0]).collect();
        assert_eq!(taken_for(&wide), None);
    }

    #[test]
    fn files_without_faces_are_told_apart() {
        let refused = |keywords: &str| {
            let mut statements = ObjStatements::default();
            keywords
                .split_whitespace()
                .for_each(|keyword| statements.add(keyword));
            let error = statements.check(Path::new("x.obj")).err();
            error.map_or_else(String::new, |error| error.to_string())
        };
        for (keywords, expected) in [
            ("", "empty"),
            ("v v v vn", "no faces"),
            ("newmtl Kd newmtl", "MTL"),
            ("Dear reader I am g text", "hardly any"),
            ("vertex v", "no faces"),
            ("v f", ""),
            ("v l", ""),
            ("x y z a b f", ""),
            ("mtllib o", ""),
        ] {
            let error = refused(keywords);
            assert!(error.contains(expected), "{keywords}: {error}");
            assert_eq!(error.is_empty(), expected.is_empty(), "{keywords}: {error}");
        }
    }
}
