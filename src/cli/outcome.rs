//! How a command ends, and what it says: exit status, errors, results and warnings.

use crate::render::ErrorEstimate;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;

/// The exit status of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// Success.
    Done = 0,
    /// The self-test failed: this machine or this build computes wrong values.
    SelfTestFailed = 1,
    /// Wrong input or usage: trying again cannot help.
    BadInput = 2,
    /// Some frames failed or are not verified: rendering again may help.
    SomeFailed = 3,
    /// Interrupted: the same command continues. It is EX_TEMPFAIL of sysexits.h.
    Interrupted = 75,
}

/// Any error that ends a command before its work.
pub(super) type Failure = Box<dyn std::error::Error>;

/// Whether the reader of the output has closed it, as `head` does.
pub(super) fn is_unread(error: &Failure) -> bool {
    let error = error.downcast_ref::<io::Error>();
    error.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

/// Refuses to write over a file, unless that is forced.
pub(super) fn keep(file: &Path, force: bool) -> Result<(), Failure> {
    if file.exists() && !force {
        let file = file.display();
        return Err(format!("{file}: is there already; use another name, or --force").into());
    }
    Ok(())
}

/// Names the file of a write that failed.
pub(super) fn written(file: &Path, result: io::Result<()>) -> Result<(), Failure> {
    result.map_err(|error| format!("{}: cannot be written: {error}", file.display()).into())
}

/// Prints a line of a result. A reader that has gone is no error: the exit status says what matters.
pub(super) fn say(line: fmt::Arguments) {
    let _ = writeln!(io::stdout(), "{line}");
}

/// The mean and the worst of the errors of frames; none where there are none. `place` is the relation of an error to its
/// frame, as in "in".
pub(super) fn error_summary(errors: &[(u32, ErrorEstimate)], place: &str) -> Option<String> {
    let error = |(_, error): &(u32, ErrorEstimate)| error.rel_mse;
    let worst = errors.iter().max_by(|a, b| error(a).total_cmp(&error(b)))?;
    let mean = errors.iter().map(error).sum::<f64>() / errors.len() as f64;
    let [low, high] = worst.1.interval();
    Some(format!(
        "{mean:.2e} on average, at worst {:.2e} ({low:.2e} to {high:.2e}) {place} frame {}",
        error(worst),
        worst.0,
    ))
}

pub(super) fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}
