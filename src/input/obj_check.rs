//! Checks OBJ statements before tobj parses them.

use super::check::MAX_MAGNITUDE;
use super::statements::{numbers, words, write_statement};
use super::unused::Unused;
use std::fmt::Write;

/// Checks the statements of an OBJ file and counts what of it is not used.
///
/// tobj takes lines for polygons and an index that is out of range for one that is not given, and it
/// cannot keep vertices with and without normals, or texture coordinates, apart in one group of faces:
/// so a group ends where the faces' form changes.
#[derive(Default)]
pub(super) struct ObjCheck {
    /// How many `v`, `vt` and `vn` there are so far.
    counts: [usize; 3],
    form: Option<FaceForm>,
    pub(super) unused: Unused,
}

/// Whether the vertices of a face have texture coordinates, and normals.
type FaceForm = [bool; 2];

/// The indices of a vertex as they stand in the file.
type FaceVertex = [Option<i64>; 3];

/// What a vertex's indices count.
const LISTS: [&str; 3] = ["v", "vt", "vn"];

impl ObjCheck {
    /// Writes a statement as tobj needs it.
    pub(super) fn prepare(
        &mut self,
        keyword: &str,
        rest: &str,
        out: &mut String,
    ) -> Result<(), String> {
        if let Some(list) = LISTS.iter().position(|&name| name == keyword) {
            return self.vertex(list, &words(rest), out);
        }
        match keyword {
            "f" => self.face(&words(rest), out),
            "usemtl" | "mtllib" if rest.is_empty() => {
                Err(format!("`{keyword}` has no name after it"))
            }
            "usemtl" | "mtllib" | "o" | "g" => {
                write_statement(out, keyword, &[rest]);
                Ok(())
            }
            // Groups of smoothing say what the normals say.
            "s" => Ok(()),
            _ => {
                self.unused.add(&format!("`{keyword}`"));
                Ok(())
            }
        }
    }

    fn vertex(&mut self, list: usize, words: &[&str], out: &mut String) -> Result<(), String> {
        let keyword = LISTS[list];
        let words = match (keyword, words.len()) {
            ("v", 6) => {
                self.unused.add("colours of `v`");
                &words[..3]
            }
            ("vt", 3) => &words[..2],
            _ => words,
        };
        let numbers = numbers(keyword, words)?;
        match (keyword, &numbers[..]) {
            ("v", [x, y, z, w]) if ![x, y, z].iter().all(|&x| (x / w).abs() <= MAX_MAGNITUDE) => {
                return Err(format!(
                    "`v`: its weight {w} takes it beyond {MAX_MAGNITUDE:e}"
                ));
            }
            ("v", [_, _, _] | [_, _, _, _]) | ("vt", [_, _]) | ("vn", [_, _, _]) => {
                write_statement(out, keyword, words);
            }
            ("vt", [_]) => write_statement(out, keyword, &[words[0], "0"]),
            _ => {
                let wanted = [
                    "three, and maybe a weight or a colour",
                    "one to three",
                    "three",
                ][list];
                let given = words.len();
                return Err(format!(
                    "`{keyword}` has {given} numbers; it takes {wanted}"
                ));
            }
        }
        self.counts[list] += 1;
        Ok(())
    }

    fn face(&mut self, words: &[&str], out: &mut String) -> Result<(), String> {
        let vertices: Vec<FaceVertex> = words
            .iter()
            .map(|word| self.face_vertex(word))
            .collect::<Result<_, _>>()?;
        if vertices.len() < 3 {
            self.unused.add("`f` of fewer than three vertices");
            return Ok(());
        }
        let has = |vertex: &FaceVertex| [vertex[1].is_some(), vertex[2].is_some()];
        let all = |i: usize| vertices.iter().all(|vertex| has(vertex)[i]);
        let form = [all(0), all(1)];
        if vertices.iter().any(|vertex| has(vertex) != form) {
            self.unused
                .add("`f` with texture coordinates or normals at some vertices only: these");
        }
        if self.form.is_some_and(|last| last != form) {
            out.push_str("g\n");
        }
        self.form = Some(form);
        out.push('f');
        for [v, vt, vn] in vertices {
            for (separator, index) in [
                (" ", v),
                ("/", vt.filter(|_| form[0])),
                ("/", vn.filter(|_| form[1])),
            ] {
                out.push_str(separator);
                if let Some(index) = index {
                    write!(out, "{index}").expect("a string takes all");
                }
            }
        }
        out.push('\n');
        Ok(())
    }

    /// The indices of a vertex: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face_vertex(&self, word: &str) -> Result<FaceVertex, String> {
        let mut vertex = FaceVertex::default();
        for (i, index) in word.split('/').enumerate() {
            if i >= vertex.len() || (i == 0 && index.is_empty()) {
                return Err(format!("`f`: {word} is not v, v/vt, v//vn or v/vt/vn"));
            }
            if index.is_empty() {
                continue;
            }
            let count = self.counts[i];
            vertex[i] = match index.parse::<i64>() {
                Ok(index) if index != 0 && index.unsigned_abs() <= count as u64 => Some(index),
                _ => {
                    let list = LISTS[i];
                    return Err(format!(
                        "`f`: {word} names `{list}` number {index}; {count} stand before it, \
                         numbered from 1, or from -1 backwards"
                    ));
                }
            };
        }
        Ok(vertex)
    }
}
