//! The command line: what the user types, turned into work, progress and an exit status.
#![expect(clippy::print_stderr, reason = "talking to the user is its job")]

mod args;
mod audit;
mod bake;
mod check;
mod error_chart;
mod frames;
mod interrupt;
mod job_args;
mod missing;
mod path;
mod path_args;
mod path_export;
mod path_import;
mod path_plot;
mod progress;
mod quote;
mod render;
mod report;
mod selftest;
mod sheet;
mod status;
mod values;
mod verify;

use args::{Arguments, Command};
use clap::Parser;
use interrupt::Interrupt;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// The exit status of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Status {
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

/// Runs the program on the process's arguments.
pub fn run() -> ExitCode {
    let interrupt = match Interrupt::install() {
        Ok(interrupt) => interrupt,
        Err(error) => {
            eprintln!("flythrough: signals cannot be caught: {error}");
            return ExitCode::from(Status::SomeFailed as u8);
        }
    };
    let result = match Arguments::parse().command {
        Command::Render(render) => render::run(&render, interrupt),
        Command::Quote(quote) => quote::run(&quote),
        Command::Audit(audit) => audit::run(&audit, interrupt),
        Command::Verify(verify) => verify::run(&verify),
        Command::Missing(missing) => missing::run(&missing),
        Command::Sheet(sheet) => sheet::run(&sheet),
        Command::Status(status) => status::run(&status),
        Command::Bake(bake) => bake::run(&bake),
        Command::Check(check) => check::run(&check),
        Command::Report(report) => report::run(&report),
        Command::Path(path) => path::run(&path),
        Command::Selftest => selftest::run(),
    };
    let status = result.unwrap_or_else(|error| {
        if is_unread(&error) {
            return Status::Done;
        }
        eprintln!("flythrough: {error}");
        Status::BadInput
    });
    ExitCode::from(status as u8)
}

/// Any error that ends a command before its work.
type Failure = Box<dyn std::error::Error>;

/// Whether the reader of the output has closed it, as `head` does.
fn is_unread(error: &Failure) -> bool {
    let error = error.downcast_ref::<io::Error>();
    error.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

/// Refuses to write over a file, unless that is forced.
fn keep(file: &Path, force: bool) -> Result<(), Failure> {
    if file.exists() && !force {
        let file = file.display();
        return Err(format!("{file}: is there already; use another name, or --force").into());
    }
    Ok(())
}

/// Names the file of a write that failed.
fn written(file: &Path, result: io::Result<()>) -> Result<(), Failure> {
    result.map_err(|error| format!("{}: cannot be written: {error}", file.display()).into())
}

/// Prints a line of a result. Where the exit status says what matters, nobody has to read it: that nobody does is no
/// error.
fn say(line: fmt::Arguments) {
    let _ = writeln!(io::stdout(), "{line}");
}

fn warn(warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}
