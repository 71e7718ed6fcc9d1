//! The lines of an OBJ or MTL file, as tobj needs them.

use std::io::{BufRead, Read};

/// Gives a parser one line at a time and counts them, for its error messages.
///
/// tobj cannot keep corners with and without normals, or texture coordinates, apart in one group
/// of faces, so a group ends where the faces' form changes.
pub(super) struct Lines<'a> {
    text: &'a [u8],
    line: usize,
    form: Option<FaceForm>,
}

/// Whether the corners of a face have texture coordinates, and normals.
type FaceForm = (bool, bool);

/// Starts a new group of faces of the same material.
const NEW_GROUP: &[u8] = b"g\n";

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Lines<'a> {
        Lines {
            text,
            line: 0,
            form: None,
        }
    }

    /// The last line that was taken, from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    fn next_line(&self) -> &'a [u8] {
        let end = self.text.iter().position(|&byte| byte == b'\n');
        &self.text[..end.map_or(self.text.len(), |end| end + 1)]
    }

    /// Whether the next line's faces cannot go into the group of those before.
    fn form_changes(&self) -> bool {
        let next = face_form(self.next_line());
        next.is_some() && self.form.is_some() && next != self.form
    }
}

/// The form of a face by its first corner; none for other lines.
fn face_form(line: &[u8]) -> Option<FaceForm> {
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    if words.next()? != b"f" {
        return None;
    }
    let mut indices = words.next()?.split(|&byte| byte == b'/').skip(1);
    let mut given = || indices.next().is_some_and(|index| !index.is_empty());
    Some((given(), given()))
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let mut available = self.fill_buf()?;
        let amount = available.read(buffer)?;
        self.consume(amount);
        Ok(amount)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        Ok(if self.form_changes() {
            NEW_GROUP
        } else {
            self.next_line()
        })
    }

    fn consume(&mut self, amount: usize) {
        if amount > 0 && self.form_changes() {
            self.form = None;
        } else if amount > 0 {
            self.form = face_form(self.next_line()).or(self.form);
            self.line += 1;
            self.text = &self.text[amount..];
        }
    }
}
