//! The command line: what the user types, turned into work, progress and an exit status.

mod args;
mod audit;
mod bake;
mod check;
mod error_chart;
mod frames;
mod interrupt;
mod job_args;
mod missing;
mod outcome;
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

use crate::text::visible;
use args::{Arguments, Command};
use clap::Parser;
use interrupt::Interrupt;
use outcome::{Status, complain, is_unread};
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the program on the process's arguments.
pub fn run() -> ExitCode {
    let interrupt = match Interrupt::install() {
        Ok(interrupt) => interrupt,
        Err(error) => {
            complain(format_args!("signals cannot be caught: {error}"));
            return ExitCode::from(Status::SomeFailed as u8);
        }
    };
    let result = match parsed(std::env::args_os().collect()).command {
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
        complain(&error);
        Status::of(&*error)
    });
    ExitCode::from(status as u8)
}

/// The arguments as clap parses them; ends the program if they are wrong, or ask for help.
fn parsed(given: Vec<OsString>) -> Arguments {
    Arguments::try_parse_from(&given).unwrap_or_else(|error| {
        // clap quotes arguments as they are, so it is asked again with those that may be shown.
        let shown = given
            .iter()
            .map(|argument| visible(argument.to_string_lossy()));
        Arguments::try_parse_from(shown)
            .err()
            .unwrap_or(error)
            .exit()
    })
}
