//! How a command ends, and what it says: exit status, errors, results and warnings.

use crate::render::ErrorEstimate;
use crate::text::visible;
use rustix::io::Errno;
use std::error::Error;
use std::fmt;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::iter::successors;
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
    /// Some frames failed or are not verified, or the system lacked something: trying again may help.
    SomeFailed = 3,
    /// Interrupted: the same command continues. It is EX_TEMPFAIL of sysexits.h.
    Interrupted = 75,
}

/// Any error that ends a command before its work.
pub(super) type Failure = Box<dyn Error>;

/// Whether the reader of the output has closed it, as `head` does.
pub(super) fn is_unread(error: &Failure) -> bool {
    let error = error.downcast_ref::<io::Error>();
    error.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

impl Status {
    /// What an error leads to: trying again may help where the system lacked something for the moment, as room on a
    /// disk or a thread.
    pub(super) fn of(error: &(dyn Error + 'static)) -> Status {
        let mut causes = successors(Some(error), |&error| error.source());
        let system = causes.find_map(|cause| cause.downcast_ref::<io::Error>());
        match system {
            Some(error) if error.raw_os_error().is_some() && !is_lasting(error) => {
                Status::SomeFailed
            }
            _ => Status::BadInput,
        }
    }
}

/// Whether what the system says is about what was asked for, and stays so.
fn is_lasting(error: &io::Error) -> bool {
    let is_loop = error.raw_os_error() == Some(Errno::LOOP.raw_os_error());
    let is_of_kind = matches!(
        error.kind(),
        ErrorKind::NotFound
            | ErrorKind::PermissionDenied
            | ErrorKind::AlreadyExists
            | ErrorKind::NotADirectory
            | ErrorKind::IsADirectory
            | ErrorKind::ReadOnlyFilesystem
            | ErrorKind::FileTooLarge
            | ErrorKind::InvalidInput
            | ErrorKind::InvalidFilename
            | ErrorKind::Unsupported
    );
    is_loop || is_of_kind
}

/// Refuses to write over a file, unless that is allowed.
pub(super) fn keep(file: &Path, replace: bool) -> Result<(), Failure> {
    if fs::symlink_metadata(file).is_ok() && !replace {
        let file = file.display();
        return Err(format!(
            "{file}: is there already: use another name, or --replace to write over it"
        )
        .into());
    }
    Ok(())
}

/// Prints a line of a result. A reader that has gone is no error: the exit status says what matters.
pub(super) fn say(line: fmt::Arguments) {
    let _ = writeln!(io::stdout(), "{}", visible(line));
}

/// Prints a line beside the results. A reader that has gone, or a log on a full disk, ends no rendering.
pub(super) fn tell(line: impl fmt::Display) {
    let _ = writeln!(io::stderr(), "{}", visible(line));
}

/// Prints the error that ends the program.
pub(super) fn complain(error: impl fmt::Display) {
    tell(format_args!("flythrough: {error}"));
}

/// The mean and the worst of the errors of frames; none where there are none. `place` is the relation of an error to its
/// frame, as in "in".
pub(super) fn error_summary(
    errors: impl Iterator<Item = (u32, ErrorEstimate)>,
    place: &str,
) -> Option<String> {
    let errors: Vec<(u32, ErrorEstimate)> = errors.collect();
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

/// Says that another process is waited for, which holds the lock of a file.
pub(super) fn say_waiting(lock: &Path) {
    warn(&[format!(
        "waits for another process, which holds {}",
        lock.display()
    )]);
}

/// Prints a line for each warning.
pub(super) fn warn(warnings: &[String]) {
    for warning in warnings {
        tell(format_args!("warning: {warning}"));
    }
}
