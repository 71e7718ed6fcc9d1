//! The statements of an OBJ or MTL file, given to tobj one by one.

use super::check::MAX_MAGNITUDE;
use super::error::InputError;
use std::borrow::Cow;
use std::io::{self, BufRead, Read};
use std::path::Path;

/// The text of a file: UTF-8 or else Latin-1, which older programs write.
pub(super) fn text<'a>(file: &Path, bytes: &'a [u8]) -> Result<Cow<'a, str>, InputError> {
    if let Some(end) = bytes.iter().position(|&byte| byte == 0) {
        return Err(InputError::Model {
            file: file.to_owned(),
            line: 1 + bytes[..end].iter().filter(|&&byte| byte == b'\n').count(),
            message: "contains a zero byte, so it is not text; save it as UTF-8".to_owned(),
        });
    }
    Ok(match str::from_utf8(bytes) {
        Ok(text) => text.trim_start_matches('\u{feff}').into(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    })
}

/// Gives a parser one statement at a time, which `prepare` has checked and rewritten for the parser, and keeps its line
/// for errors.
pub(super) struct Statements<'a, F> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The line on which the last statement began, from 1.
    line: usize,
    ready: String,
    taken: usize,
    fault: Option<String>,
    prepare: F,
}

impl<'a, F> Statements<'a, F>
where
    F: FnMut(&str, &str, &mut String) -> Result<(), String>,
{
    /// `prepare` is given a keyword, the rest of the statement, and the string to write to.
    pub(super) fn new(text: &'a str, prepare: F) -> Statements<'a, F> {
        Statements {
            lines: text.lines().enumerate(),
            line: 1,
            ready: String::new(),
            taken: 0,
            fault: None,
            prepare,
        }
    }

    /// The error of `file` after the parser stopped with `error`.
    pub(super) fn fault(self, file: &Path, error: tobj::LoadError) -> InputError {
        InputError::Model {
            file: file.to_owned(),
            line: self.line,
            message: self.fault.unwrap_or_else(|| error.to_string()),
        }
    }

    /// The next line and, if it ends in a backslash, those that continue it. Comments end at their
    /// line's end, whatever they end in.
    fn next_statement(&mut self) -> Option<Cow<'a, str>> {
        let (number, first) = self.lines.next()?;
        self.line = number + 1;
        let mut statement = Cow::from(first);
        let has_comment = |line: &str| line.split_whitespace().any(|word| word.starts_with('#'));
        while statement.trim_end().ends_with('\\') && !has_comment(&statement) {
            let (_, more) = self.lines.next().unwrap_or_default();
            let whole = statement.to_mut();
            whole.truncate(whole.trim_end().len() - 1);
            whole.push(' ');
            whole.push_str(more);
        }
        Some(statement)
    }
}

impl<F> BufRead for Statements<'_, F>
where
    F: FnMut(&str, &str, &mut String) -> Result<(), String>,
{
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.taken == self.ready.len() {
            let Some(statement) = self.next_statement() else {
                break;
            };
            self.ready.clear();
            self.taken = 0;
            let statement = statement.trim();
            let keyword = statement.split_whitespace().next().unwrap_or_default();
            if keyword.is_empty() || keyword.starts_with('#') {
                continue;
            }
            let rest = statement[keyword.len()..].trim();
            if let Err(fault) = (self.prepare)(keyword, rest, &mut self.ready) {
                self.fault = Some(fault);
                return Err(io::ErrorKind::InvalidData.into());
            }
        }
        Ok(&self.ready.as_bytes()[self.taken..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken += amount;
    }
}

impl<F> Read for Statements<'_, F>
where
    F: FnMut(&str, &str, &mut String) -> Result<(), String>,
{
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut available = self.fill_buf()?;
        let amount = available.read(buffer)?;
        self.consume(amount);
        Ok(amount)
    }
}

/// The words after a keyword, up to a comment.
pub(super) fn words(rest: &str) -> Vec<&str> {
    rest.split_whitespace()
        .take_while(|word| !word.starts_with('#'))
        .collect()
}

/// The words after a keyword as numbers of at most [`MAX_MAGNITUDE`].
pub(super) fn numbers(keyword: &str, words: &[&str]) -> Result<Vec<f64>, String> {
    let number = |word: &&str| match word.parse::<f64>() {
        Ok(number) if number.abs() <= MAX_MAGNITUDE => Ok(number),
        _ => Err(format!(
            "`{keyword}`: {word} is not a number between -{MAX_MAGNITUDE:e} and {MAX_MAGNITUDE:e}"
        )),
    };
    words.iter().map(number).collect()
}

/// Appends a line with a statement.
pub(super) fn write_statement(out: &mut String, keyword: &str, words: &[&str]) {
    out.push_str(keyword);
    for word in words {
        out.push(' ');
        out.push_str(word);
    }
    out.push('\n');
}
